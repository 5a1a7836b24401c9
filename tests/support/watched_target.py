"""A watched tumble with its tracks, short: what tests of the unknown target look at."""

from dataclasses import replace

import numpy as np

from bench.suites.volpe2017.cases import TUMBLE, Case, motion_of
from bench.suites.volpe2017.point_frames import camera_of, frames_of, start_of
from pipelines.unknown_target.batch_estimator import BatchEstimator
from pipelines.unknown_target.options import BatchOptions

SHORT = Case("short", "short", TUMBLE, duration_s=120.0, step_s=2.0)


def case(**changes) -> Case:
    return replace(SHORT, **changes)


def motion_start(own: Case, run: int = 0):
    return start_of(motion_of(own), 0, run)


def followed(own: Case, options: BatchOptions | None = None, run: int = 0) -> BatchEstimator:
    """Return the estimator after all frames of a case."""
    if options is None:
        options = BatchOptions(range_to="surface" if own.range_to == "surface" else "centre")
    estimator = BatchEstimator(camera_of(), own.orbit_rate, motion_start(own, run), options)
    for frame, _ in frames_of(own, 0, run):
        estimator.add(frame)
    return estimator


def shape_error_m(solution, own: Case) -> float:
    """Return the rms distance of the live points from the true ones."""
    live = np.flatnonzero(solution.live)
    names = [solution.names[place] for place in live]
    away = solution.unknowns.points[live] - own.points_in_target[names]
    return float(np.sqrt(np.mean(np.sum(away**2, axis=1))))
