"""Table 5's experiment: a pose from images alone, at a moment of the tumble drawn at random.

Images come at 1 Hz until one gives a pose; the error is that of this pose, the time that of all
images looked at.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from bench.scoring.tumble.navigation_errors import pose_error_sizes, symmetric_attitude_deg
from bench.suites.pesce2019.cases import Case, tumble_of
from bench.suites.pesce2019.navigators import navigator
from bench.suites.pesce2019.synthetic_points import PointNoise, point_frame
from bench.suites.units import Outcome
from models.arrays import AnyArray
from models.camera import camera_preset
from models.motion.chaser_navigation import SIGMA_M, SIGMA_M_S
from models.motion.tumble import CAM_FROM_LVLH
from models.spacecraft.wireframes import wireframe_by_name
from pipelines.uncooperative.knowledge import UncooperativeKnowledge

EPOCH_DRAW = 0xE90C
WRONG_M, WRONG_DEG = 1.0, 10.0


@dataclass(frozen=True)
class AcquisitionTask:
    """Some acquisitions of one case by one variant.

    Attributes
    ----------
    case : Case
    camera : str
        A preset.
    navigator, variant, options : str
        Module of the pipeline, its variant, and all settings as text.
    noise : PointNoise
    seed : int
    runs : tuple of int
        Numbers of the acquisitions.
    span_s : float, s
        First images are drawn uniformly from this much of the tumble.
    most_images : int
        After so many without a pose the trial ends.
    rate_hz : float
    """

    case: Case
    camera: str
    navigator: str
    variant: str
    options: str
    noise: PointNoise
    seed: int
    runs: tuple[int, ...]
    span_s: float
    most_images: int
    rate_hz: float


def knowledge_of(case: Case, camera: str, sigma_px: float) -> UncooperativeKnowledge:
    """Return what is on board in a suite on points: everything exactly, no range.

    Parameters
    ----------
    case : Case
    camera : str
        Name of a preset.
    sigma_px : float, px
        1 sigma of a corner on each axis.
    """
    return UncooperativeKnowledge(
        camera=camera_preset(camera),
        target=wireframe_by_name(case.target),
        cam_from_lvlh=CAM_FROM_LVLH,
        sigma_px=sigma_px,
        chaser_sigma_m=SIGMA_M,
        chaser_sigma_m_s=SIGMA_M_S,
    )


def acquire(task: AcquisitionTask) -> Outcome:
    """Do some acquisitions.

    Returns
    -------
    Outcome
        By run: ``epoch_s``; ``images`` looked at, 0 where none gave a pose; ``position_m`` and
        ``attitude_deg``, NaN then; ``attitude_symmetric_deg``, the error from the nearest of the
        poses that the target's symmetries make alike. Seconds of one core, by run.
    """
    rows, seconds = [], []
    for run in task.runs:
        row, spent_s = _acquisition(task, run)
        rows.append(row)
        seconds.append(spent_s)
    table = np.array(rows, dtype=np.float64).reshape(len(task.runs), 5)
    values: dict[str, AnyArray] = {
        "run": np.array(task.runs, dtype=np.int32),
        "epoch_s": table[:, 0].astype(np.float32),
        "images": table[:, 1].astype(np.int16),
        "position_m": table[:, 2].astype(np.float32),
        "attitude_deg": table[:, 3].astype(np.float32),
        "attitude_symmetric_deg": table[:, 4].astype(np.float32),
    }
    return Outcome(values, np.array(seconds))


def _acquisition(task: AcquisitionTask, run: int) -> tuple[list[float], float]:
    tumble = tumble_of(task.case, task.span_s + task.most_images / task.rate_hz)
    knowledge = knowledge_of(task.case, task.camera, task.noise.sigma_px)
    draw = np.random.default_rng([task.seed, run, EPOCH_DRAW])
    epoch_s = float(draw.uniform(0.0, task.span_s))
    pipeline = navigator(task.navigator, task.variant, knowledge)
    spent_s = 0.0
    for frame in range(task.most_images):
        now_s = epoch_s + frame / task.rate_hz
        key = (task.seed, run, frame)
        points = point_frame(tumble, knowledge.target, knowledge.camera, task.noise, now_s, key)
        began = time.process_time()
        estimate = pipeline.process(points)
        spent_s += time.process_time() - began
        if estimate.pose is not None:
            found, truth = estimate.pose.cam_from_target, tumble.cam_from_target(now_s)
            moved_m, turned_deg = pose_error_sizes(found, truth)
            alike_deg = symmetric_attitude_deg(found, truth, knowledge.target.symmetries)
            return [epoch_s, frame + 1.0, moved_m, turned_deg, alike_deg], spent_s
    return [epoch_s, 0.0, np.nan, np.nan, np.nan], spent_s
