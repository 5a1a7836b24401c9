"""Starts tried on the frames of a motion, each as if nothing had been seen before."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.suites.uncooperative_suns.cases import SUNS, MotionTask, draw_motion
from bench.suites.uncooperative_suns.frames import known_of, render_motion
from bench.suites.uncooperative_suns.told import onboard_of
from bench.suites.units import Outcome, WorkUnit, done_outcome
from models.onboard import needed
from pipelines.acquisition.under_sun import make_views
from pipelines.acquisition.under_sun_options import UnderSunOptions
from pipelines.registry import registered_pipeline
from pipelines.uncooperative.knowledge import image_frame

PIPELINE = "uncooperative"
RENDER_S, START_S = 12.0, 8.0  # until one was timed


@dataclass(frozen=True)
class StartsTask:
    """The starts of one motion by one variant.

    Attributes
    ----------
    motion : MotionTask
    frames : str
        Hash of all that shapes the frames.
    variant : str
    settings : str
        Hash of all of its settings.
    sun_sigma_deg : float, deg
        Per axis, of the Sun's direction on board.
    """

    motion: MotionTask
    frames: str
    variant: str
    settings: str
    sun_sigma_deg: float


def frames_unit(task: MotionTask, name: str) -> WorkUnit:
    """Return the unit that renders a motion."""
    return WorkUnit(f"{name}/{task.number:04d}", render_motion, task, f"frames, {name}", RENDER_S)


def starts_unit(
    frames: WorkUnit, file: str, variant: str, sun_sigma_deg: float, name: str
) -> WorkUnit:
    """Return the unit that tries the starts of a motion.

    Parameters
    ----------
    frames : WorkUnit
        That renders it.
    file : str
        Where its frames lie, without suffix.
    variant : str
    sun_sigma_deg : float, deg
    name : str
        Of the target.
    """
    pipeline = registered_pipeline(PIPELINE)
    task: MotionTask = frames.task
    return WorkUnit(
        name=f"{name}/{variant}/{task.number:04d}",
        work=try_starts,
        task=StartsTask(task, frames.key, variant, pipeline.settings_hash(variant), sun_sigma_deg),
        kind=f"starts, {name}, {variant}",
        expected_s=SUNS * START_S,
        modules=(pipeline.make.__module__,),
        reads=file,
    )


def try_starts(task: StartsTask, frames: str) -> Outcome:
    """Try every start of a motion.

    Parameters
    ----------
    task : StartsTask
    frames : str
        The frames' file, without suffix.

    Returns
    -------
    Outcome
        By start: ``image``, the one that gave a pose or -1; ``cam_from_target`` (k, 3, 4);
        ``covariance`` (k, 6, 6); ``wrong_probability``, NaN where none was told; ``reason``, what
        the last image without a pose was said to lack. Seconds of one core, by start.
    """
    motion = task.motion
    place = Path(frames)
    unit = frames_unit(motion, place.parent.name)
    shown = done_outcome(place.parents[1], unit).values
    camera, _, wireframe = known_of(motion)
    drawn = draw_motion(motion, camera, wireframe.radius_m)
    count = SUNS
    found = np.full(count, -1, dtype=np.int64)
    poses, covariances = np.full((count, 3, 4), np.nan), np.full((count, 6, 6), np.nan)
    doubts, seconds, reasons = np.full(count, np.nan), np.zeros(count), []
    for number in range(count):
        onboard = onboard_of(motion, drawn, number, task.sun_sigma_deg)
        if task.variant != "paper":
            # Before flight: no time of a start.
            make_views(needed(onboard.wireframe, "wireframe.json", PIPELINE), UnderSunOptions())
        pipeline = registered_pipeline(PIPELINE).make(onboard, task.variant)
        reason = ""
        for image in range(motion.images):
            taken_ms = float(shown["exposure_ms"][number, image])
            further = zip(shown["bracket"][number, image], motion.bracket, strict=True)
            frame = image_frame(
                image,
                float(drawn.times_s[image]),
                shown["images"][number, image],
                taken_ms,
                drawn.chaser(image),
                [(own, factor * taken_ms) for own, factor in further],
            )
            began = time.process_time()
            said = pipeline.process(frame)
            seconds[number] += time.process_time() - began
            if said.pose is not None:
                found[number] = image
                poses[number] = said.pose.cam_from_target.matrix()[:3]
                if said.pose.covariance is not None:
                    covariances[number] = said.pose.covariance
                if said.pose.wrong_probability is not None:
                    doubts[number] = said.pose.wrong_probability
                break
            reason = said.reason or ""
        reasons.append(reason)
    return Outcome(
        {
            "image": found,
            "cam_from_target": poses,
            "covariance": covariances,
            "wrong_probability": doubts,
            "reason": np.array(reasons, dtype=np.str_),
        },
        seconds,
    )
