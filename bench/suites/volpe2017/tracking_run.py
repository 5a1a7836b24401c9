"""One run: a target followed from a first guess, frame after frame."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np

from bench.suites.units import Outcome
from bench.suites.volpe2017.cases import Case, motion_of
from bench.suites.volpe2017.motion_errors import COLUMNS, motion_errors
from bench.suites.volpe2017.point_frames import camera_of, frames_of, start_of
from pipelines.unknown_target.options import UnknownTargetOptions, options_for
from pipelines.unknown_target.pipeline import UnknownTarget


@dataclass(frozen=True)
class TrackingTask:
    """One run of one case by one variant.

    Attributes
    ----------
    case : Case
    variant, options : str
        And all its settings as text.
    seed, run : int
    """

    case: Case
    variant: str
    options: str
    seed: int
    run: int


def case_options(case: Case, variant: str) -> UnknownTargetOptions:
    """Return a variant's settings for a case: it is told what the range is to.

    Parameters
    ----------
    case : Case
    variant : str
    """
    own = options_for(variant)
    if case.range_to == "surface":
        return own
    return replace(own, batch=replace(own.batch, range_to="centre"))


def track(task: TrackingTask) -> Outcome:
    """Follow the target through all frames of a run.

    Returns
    -------
    Outcome
        ``errors``, (frames, columns of ``motion_errors.COLUMNS``) float32; ``points``, (n, 3)
        float32, those estimated at the end, NaN for one that is none. Seconds of one core, by
        frame.
    """
    case = task.case
    motion = motion_of(case)
    own = UnknownTarget(
        camera_of(),
        case.orbit_rate,
        start_of(motion, task.seed, task.run),
        case_options(case, task.variant),
    )
    true_points = case.points_in_target
    rows, seconds = [], []
    points = np.full(true_points.shape, np.nan, dtype=np.float32)
    for frame, state in frames_of(case, task.seed, task.run):
        began = time.process_time()
        known = own.take(frame)
        seconds.append(time.process_time() - began)
        rows.append(motion_errors(known, state, true_points))
        if len(rows) == case.frames:
            points[list(known.names)] = known.points_in_target
    table = np.array(rows, dtype=np.float32).reshape(-1, len(COLUMNS))
    return Outcome({"errors": table, "points": points}, np.array(seconds))
