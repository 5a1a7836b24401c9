"""Tables 6 to 8's experiment: a tumble followed from a start that is wrong, frame after frame."""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import dataclass, fields

import numpy as np

from bench.scoring.tumble.navigation_errors import NavigationError, navigation_error
from bench.suites.pesce2019.acquisition_trial import knowledge_of
from bench.suites.pesce2019.cases import Case, tumble_of
from bench.suites.pesce2019.navigators import navigator
from bench.suites.pesce2019.start_errors import StartErrors, drawn_start
from bench.suites.pesce2019.synthetic_points import PointNoise, point_frame
from bench.suites.units import Outcome
from models.motion.tumble import CAM_FROM_LVLH

MODES = ("searching", "acquired", "tracked", "predicted")
ERRORS = tuple(field.name for field in fields(NavigationError))


@dataclass(frozen=True)
class TrackingTask:
    """One run of one case by one variant.

    Attributes
    ----------
    case : Case
    camera : str
        A preset.
    navigator, variant, options : str
        Module of the pipeline, its variant, and all settings as text.
    noise : PointNoise
    start : StartErrors
    seed, run : int
    frames : int
    rate_hz : float
    """

    case: Case
    camera: str
    navigator: str
    variant: str
    options: str
    noise: PointNoise
    start: StartErrors
    seed: int
    run: int
    frames: int
    rate_hz: float


def track(task: TrackingTask) -> Outcome:
    """Follow the target through all frames of a run.

    Returns
    -------
    Outcome
        The fields of ``NavigationError`` by frame, float32; ``mode``, a place in ``MODES``;
        ``reasons`` and ``reason_counts``, why there was no pose and how often. Seconds of one core,
        by frame.
    """
    tumble = tumble_of(task.case, max(1.0, (task.frames - 1) / task.rate_hz))
    knowledge = knowledge_of(task.case, task.camera, task.noise.sigma_px)
    start = drawn_start(tumble.state(0.0), task.start, task.seed, task.run)
    pipeline = navigator(task.navigator, task.variant, knowledge, start)
    rows, modes, seconds, reasons = [], [], [], Counter[str]()
    for frame in range(task.frames):
        now_s = frame / task.rate_hz
        key = (task.seed, task.run, frame)
        points = point_frame(tumble, knowledge.target, knowledge.camera, task.noise, now_s, key)
        began = time.process_time()
        estimate = pipeline.process(points)
        seconds.append(time.process_time() - began)
        rows.append(navigation_error(estimate, tumble.state(now_s), CAM_FROM_LVLH).row())
        modes.append(MODES.index(estimate.mode))
        if estimate.reason is not None:
            reasons[estimate.reason] += 1
    table = np.array(rows, dtype=np.float32)
    told = sorted(reasons)
    values = {name: table[:, place] for place, name in enumerate(ERRORS)}
    values["mode"] = np.array(modes, dtype=np.int8)
    values["reasons"] = np.array(told, dtype=np.str_)
    values["reason_counts"] = np.array([reasons[each] for each in told], dtype=np.int32)
    return Outcome(values, np.array(seconds))
