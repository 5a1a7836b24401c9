"""One instant's estimate of orbit and attitude held against the truth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bench.estimating.runs import Run
from bench.scoring.judgement import ALLOWED_CONFIDENCE, Judgement
from models.arrays import Floats
from models.dataset.dataset import Dataset
from models.errors import DatasetError
from models.estimate import Estimate
from models.motion.perturbed_orbit import lvlh_axes
from models.quantiles import chi_square_quantile
from models.quaternions import conjugate, multiplied, to_rotation_vector
from models.reading.bounds import FRAME, ORBIT_M, SPEED_M_S, TIME_S
from models.reading.csv_table import read_csv

ORBIT, ATTITUDE, INTEGRITY = "chaser_orbit", "chaser_attitude", "integrity"
POSITION, VELOCITY = "position_in_inertial_m", "velocity_in_inertial_m_s"
QUATERNION, PROTECTION = "q_inertial_from_body_wxyz", "protection_m"
TRUTH = "truth/flight.csv"
PLACE, SPEED = ("x_m", "y_m", "z_m"), ("x_m_s", "y_m_s", "z_m_s")
TURN = ("qw", "qx", "qy", "qz")
WRONG_M, WRONG_DEG = 100.0, 0.1  # below these an error is no harm, whatever is stated
NO_STATE = "no orbit and attitude among its states"


@dataclass(frozen=True, eq=False)
class TrueInstant:
    """What was so at a frame.

    Attributes
    ----------
    time_s : float, s
    position_m, velocity_m_s : (3,) array
        Inertial.
    q_inertial_from_body_wxyz : (4,) array
    """

    time_s: float
    position_m: Floats
    velocity_m_s: Floats
    q_inertial_from_body_wxyz: Floats
    cam_from_target: None = None


@dataclass(frozen=True, eq=False)
class JudgedInstant(Judgement):
    """One instant by one pipeline.

    Attributes
    ----------
    along_m : list of 3 float or None
        Position error along radial, track and normal.
    speed_m_s : float or None
    orbit_nees, attitude_nees : float or None
        Of position and velocity (6), and of the attitude (3); None without a covariance.
    protection_m : list of 3 float or None
        What the position error is said to stay below, along the same axes.
    """

    along_m: list[float] | None
    speed_m_s: float | None
    orbit_nees: float | None
    attitude_nees: float | None
    protection_m: list[float] | None

    @property
    def lost(self) -> bool:
        """Whether there is no orbit and attitude."""
        return self.along_m is None


def true_instants(dataset: Dataset) -> dict[int, TrueInstant]:
    """Return the truth of each frame; empty where there is no truth half.

    Raises
    ------
    DatasetError
        If a row cannot be.
    """
    path = dataset.folder / TRUTH
    if not path.is_file():
        return {}
    found = {}
    for row in read_csv(path, ("index", "time_s", *PLACE, *SPEED, *TURN)):
        found[row.whole("index", *FRAME)] = TrueInstant(
            row.number("time_s", *TIME_S),
            np.array([row.number(name, -ORBIT_M[1], ORBIT_M[1]) for name in PLACE]),
            np.array([row.number(name, -SPEED_M_S[1], SPEED_M_S[1]) for name in SPEED]),
            np.array([row.number(name, -1.0, 1.0) for name in TURN]),
        )
    return found


def read_true_instants(dataset: Dataset) -> dict[int, TrueInstant]:
    """Return the truth of each frame.

    Raises
    ------
    DatasetError
        If the truth half is missing or lacks a frame.
    """
    found = true_instants(dataset)
    missing = [index for index in dataset.indices if index not in found]
    if missing:
        raise DatasetError(
            f"{dataset.folder / TRUTH}: expected frame {missing[0]}, found none; "
            "make the dataset again"
        )
    return found


def judge_run(run: Run, truth: Mapping[int, TrueInstant]) -> list[JudgedInstant]:
    """Hold one run's estimates against the truth.

    Parameters
    ----------
    run : Run
    truth : mapping of int to TrueInstant
    """
    return [judged_instant(run.number, run.estimates[index], truth[index]) for index in truth]


def judged_instant(number: int, said: Estimate, was: TrueInstant) -> JudgedInstant:
    """Hold one estimate against the truth.

    Parameters
    ----------
    number : int
        Of the run.
    said : Estimate
    was : TrueInstant
    """
    states = said.states
    if ORBIT not in states or ATTITUDE not in states:
        reason = (
            said if said.reason is not None else Estimate(said.frame, said.time_s, reason=NO_STATE)
        )
        return JudgedInstant(number, reason, None, None, None, True, False, *5 * [None])
    orbit, turn = states[ORBIT], states[ATTITUDE]
    error = np.concatenate(
        [orbit.values[POSITION] - was.position_m, orbit.values[VELOCITY] - was.velocity_m_s]
    )
    off = to_rotation_vector(
        multiplied(conjugate(turn.values[QUATERNION]), was.q_inertial_from_body_wxyz)
    )
    along = lvlh_axes(was.position_m, was.velocity_m_s).T @ error[:3]
    position_m, attitude_deg = float(np.linalg.norm(along)), float(np.rad2deg(np.linalg.norm(off)))
    orbit_nees = _nees(error, orbit.covariance)
    attitude_nees = _nees(off, None if turn.covariance is None else turn.covariance[:3, :3])
    levels = states[INTEGRITY].values.get(PROTECTION) if INTEGRITY in states else None
    return JudgedInstant(
        run=number,
        estimate=said,
        range_m=None,
        position_m=position_m,
        attitude_deg=attitude_deg,
        missed=False,
        wrong=(position_m > WRONG_M and _beyond(orbit_nees, 6))
        or (attitude_deg > WRONG_DEG and _beyond(attitude_nees, 3)),
        along_m=along.tolist(),
        speed_m_s=float(np.linalg.norm(error[3:])),
        orbit_nees=orbit_nees,
        attitude_nees=attitude_nees,
        protection_m=None if levels is None else np.ravel(levels).tolist(),
    )


def _nees(error: Floats, covariance: Floats | None) -> float | None:
    if covariance is None or covariance.shape != (len(error), len(error)):
        return None
    return float(error @ np.linalg.solve(covariance, error))


def _beyond(square: float | None, freedom: int) -> bool:
    return square is None or square > chi_square_quantile(ALLOWED_CONFIDENCE, freedom)
