"""The bound that no estimator of an unknown target can beat, on average.

**Idea.** Nothing disturbs the motion, so that the state at any time is a function of fixed
unknowns: first place, rates, five ratios of the inertia, and the points. What all images and ranges
so far tell of them, with what was known before, is the posterior Cramer-Rao bound (Tichavsky,
Muravchik and Nehorai 1998, without process noise); it is carried to the time by the motion's
derivatives.

**Gauge.** The body's axes are the first camera's: no attitude is unknown at the start. The inertia
has trace 1. Without a range the geometric scale is known as well as before, no better.

The bound is of points that are told apart, of no false ones, and of a range whose reading is as
good as its sigma: outliers carry no information.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from bench.suites.units import Outcome
from bench.suites.volpe2017.cases import Case, motion_of, states_of
from bench.suites.volpe2017.point_frames import camera_of, frame_of, start_of
from models.arrays import Floats
from models.motion.clohessy_wiltshire import state_transition
from models.motion.gravity_gradient_rotation import lvlh_from_first
from models.spacecraft.simple_target import inertia_kg_m2
from pipelines.unknown_target import inertia_chart
from pipelines.unknown_target.arrow_equations import ArrowEquations
from pipelines.unknown_target.free_tumble import FreeTumble
from pipelines.unknown_target.observation_rows import (
    Epochs,
    Placed,
    Rows,
    centre_rows,
    placed,
    sighting_rows,
    surface_rows,
)
from pipelines.unknown_target.options import BatchOptions
from pipelines.unknown_target.unknowns import CHART, OMEGA, PLACE, SHARED, TURN, Prior, Unknowns

COLUMNS = (
    "position_m", "velocity_m_s", "attitude_deg", "rate_deg_s", "shape_m", "inertia_percent",
    "scale",
)  # fmt: skip


@dataclass(frozen=True)
class BoundTask:
    """What shapes a bound.

    Attributes
    ----------
    case : Case
    seed : int
        Of what is drawn of which points and ranges there are.
    """

    case: Case
    seed: int


def bound(task: BoundTask) -> Outcome:
    """Return the bound frame by frame.

    Returns
    -------
    Outcome
        ``bound``, (frames, columns of ``COLUMNS``) float32: roots of traces; of the shape the root
        mean square over the points, of the inertia over its entries in percent of the trace, of the
        scale relative.
    """
    began = time.perf_counter()
    case = task.case
    at, prior, where = true_unknowns(case), _prior(case, task.seed), true_places(case)
    equations = prior.equations(at)
    by_chart = inertia_chart.derivatives(at.shared[CHART]).reshape(-1, 9)
    table = []
    for index in range(case.frames):
        for rows in _rows_of(case, where, at, index, task.seed):
            equations.add_rows(rows.by_shared, rows.by_point, rows.error, rows.who)
        table.append(_sizes(equations, where, index, by_chart, at))
    spent_s = np.array([time.perf_counter() - began])
    return Outcome({"bound": np.array(table, dtype=np.float32)}, spent_s)


def true_unknowns(case: Case) -> Unknowns:
    """Return the true values of all that is unknown in a case."""
    motion = motion_of(case)
    chart = inertia_chart.chart_of(inertia_kg_m2())
    shared = np.concatenate([motion.start, motion.omega0_in_target, chart])
    return Unknowns(shared, case.points_in_target)


def true_places(case: Case) -> Placed:
    """Return where the target is in all frames, and how that depends on the unknowns."""
    states, n = states_of(case), case.orbit_rate
    attitude = np.array([each.R_cam_from_lvlh for each in states])
    epochs = Epochs(
        case.times_s,
        attitude,
        attitude @ np.array([lvlh_from_first(n * time_s) for time_s in case.times_s]),
        np.array([state_transition(n, time_s) for time_s in case.times_s]),
    )
    at = true_unknowns(case)
    first = epochs.R_cam_from_start[0].T
    until_s = float(case.times_s[-1]) + 1.0
    return placed(at, FreeTumble(at.shared[OMEGA], at.shared[CHART], first, n, until_s), epochs)


def _prior(case: Case, seed: int) -> Prior:
    motion = motion_of(case)
    return Prior(start_of(motion, seed, 0), BatchOptions().inertia_sigma)


def _rows_of(case: Case, where: Placed, at: Unknowns, index: int, seed: int) -> list[Rows]:
    """Return what one frame tells, as rows at the truth; their errors are of no interest."""
    frame, camera = frame_of(case, states_of(case)[index], index, seed, 0), camera_of()
    now = np.full(len(frame.tracks), index)
    seen = camera.normalise(frame.points_px)
    told = sighting_rows(where, at.points, now, frame.tracks, seen, frame.sigma_px / camera.fx)
    right = 1.0 - case.false_share  # false ones tell nothing, and are as many everywhere
    rows = [told.weighted(np.full(len(now), right))]
    if frame.range_m is not None and frame.range_sigma_m is not None:
        one, sigma = np.array([index]), np.array([frame.range_sigma_m])
        distance = np.array([frame.range_m])
        good = np.array([1.0 - case.range_finder.outlier_share])
        if case.range_to == "centre":
            rows.append(centre_rows(where, one, distance, sigma).weighted(good))
        else:
            used = np.ones(len(at.points), dtype=bool)
            met = surface_rows(where, at.points, used, one, distance, sigma)
            rows.append(met.weighted(np.where(np.isfinite(met.sizes), good, 0.0)))
    return rows


def _sizes(
    equations: ArrowEquations, where: Placed, index: int, by_chart: Floats, at: Unknowns
) -> list[float]:
    solved = equations.solve()
    by_shared = np.zeros((12, SHARED))
    by_shared[:6, PLACE] = where.state_by_place[index]
    by_shared[6:9, TURN] = where.turn_by_rest[index]
    by_shared[9:, TURN] = where.omega_by_rest[index]
    motion = by_shared @ solved.covariance @ by_shared.T
    sizes = np.sqrt(np.maximum(np.diag(motion), 0.0).reshape(4, 3).sum(axis=1))
    spread = np.trace(solved.point_covariances(), axis1=1, axis2=2)
    inertia = np.diag(by_chart.T @ solved.covariance[CHART, CHART] @ by_chart)
    rho = at.shared[:3]
    scale = np.sqrt(rho @ solved.covariance[:3, :3] @ rho) / (rho @ rho)
    return [
        float(sizes[0]),
        float(sizes[1]),
        float(np.rad2deg(sizes[2])),
        float(np.rad2deg(sizes[3])),
        float(np.sqrt(spread.mean())),
        float(100.0 * np.sqrt(inertia.mean())),
        float(scale),
    ]
