"""A tumble rendered, and followed by one variant of the pipeline from its first image on."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench.scoring.tumble.navigation_errors import navigation_error, symmetric_attitude_deg
from bench.suites.uncooperative_suns.cases import MotionTask
from bench.suites.uncooperative_suns.frames import lit_share, metered_image, studio_of
from bench.suites.uncooperative_tumbles.cases import drawn_scenario
from bench.suites.units import Outcome, WorkUnit, done_outcome
from models.arrays import Image
from models.frame import CHASER_ORBIT, IMAGE, Frame, ImageReading
from models.motion.relative_state import relative_state
from models.motion.tumble import CAM_FROM_LVLH
from models.onboard import needed
from pipelines.acquisition.under_sun import make_views
from pipelines.acquisition.under_sun_options import UnderSunOptions
from pipelines.registry import registered_pipeline
from renders.world.build import world_of
from renders.world.world import World

PIPELINE = "uncooperative"
RENDER_S, FOLLOW_S = 0.6, 1.5  # an image, until one was timed
ERRORS = (
    "raw_position_m", "raw_attitude_deg", "position_m", "attitude_deg",
    "nees_translation", "nees_rotation",
)  # fmt: skip


@dataclass(frozen=True)
class FollowingTask:
    """One tumble by one variant.

    Attributes
    ----------
    tumble : MotionTask
    frames : str
        Hash of all that shapes the frames.
    variant : str
    settings : str
        Hash of all of its settings.
    """

    tumble: MotionTask
    frames: str
    variant: str
    settings: str


def frames_unit(task: MotionTask, name: str) -> WorkUnit:
    """Return the unit that renders a tumble."""
    expected_s = RENDER_S * task.images
    return WorkUnit(f"{name}/{task.number:04d}", render_tumble, task, f"frames, {name}", expected_s)


def following_unit(frames: WorkUnit, file: str, variant: str, name: str) -> WorkUnit:
    """Return the unit that follows a tumble.

    Parameters
    ----------
    frames : WorkUnit
        That renders it.
    file : str
        Where its frames lie, without suffix.
    variant : str
    name : str
        Of the target.
    """
    pipeline = registered_pipeline(PIPELINE)
    task: MotionTask = frames.task
    return WorkUnit(
        name=f"{name}/{variant}/{task.number:04d}",
        work=follow,
        task=FollowingTask(task, frames.key, variant, pipeline.settings_hash(variant)),
        kind=f"tumbles, {name}, {variant}",
        expected_s=FOLLOW_S * task.images,
        modules=(pipeline.make.__module__,),
        reads=file,
    )


def render_tumble(task: MotionTask) -> Outcome:
    """Render a tumble, each image metered from the one before.

    Parameters
    ----------
    task : MotionTask

    Returns
    -------
    Outcome
        ``images`` (n, height, width) uint16; ``exposure_ms``, ``lit`` (n,): the share of the
        silhouette that is above three sigmas.
    """
    world = _world(task)
    studio = studio_of(world)
    images, exposures, lit = list[Image](), list[float](), list[float]()
    for exposure in world.exposures:
        pose = world.trajectory.cam_from_target(exposure.time_s)
        light = studio.light(exposure, pose)
        before = (exposures[-1], images[-1]) if images else (0.0, None)
        image, taken_ms = metered_image(world, light, exposure, *before)
        mask = studio.pixel_truth(exposure, pose).depth_m > 0.0
        images.append(image)
        exposures.append(taken_ms)
        lit.append(lit_share(image, mask, world.scenario.simulated_detector))
    values: dict[str, Any] = {"images": np.array(images), "exposure_ms": np.array(exposures)}
    return Outcome({**values, "lit": np.array(lit)}, np.zeros(0))


def follow(task: FollowingTask, frames: str) -> Outcome:
    """Follow a tumble from its first image, with nothing known of where the target is.

    Parameters
    ----------
    task : FollowingTask
    frames : str
        The frames' file, without suffix.

    Returns
    -------
    Outcome
        By image: the errors ``ERRORS`` and ``alike_deg``, the state's attitude error up to the
        target's symmetries, NaN where there is nothing to judge; ``range_m``; ``mode``; ``reason``,
        why there was no pose. Seconds of one core, by image.
    """
    tumble, place = task.tumble, Path(frames)
    shown = done_outcome(place.parents[1], frames_unit(tumble, place.parent.name)).values
    world = _world(tumble)
    onboard = world.onboard(tumble.number)
    wireframe = needed(onboard.wireframe, "wireframe.json", PIPELINE)
    motion = world.absolute
    if motion is None:
        raise TypeError("expected a world in which the target turns freely")
    if task.variant != "paper":
        make_views(wireframe, UnderSunOptions())  # before flight: no time of a start
    pipeline = registered_pipeline(PIPELINE).make(onboard, task.variant)
    (navigation,) = (each for each in world.tables if each.name == CHASER_ORBIT)
    rows = dict[str, list[Any]]()
    seconds = []
    for number, exposure in enumerate(world.exposures):
        time_s, taken_ms = exposure.time_s, float(shown["exposure_ms"][number])
        orbit = navigation.reading(number, time_s, time_s, tumble.number)
        image = ImageReading(shown["images"][number], time_s, taken_ms)
        began = time.process_time()
        said = pipeline.process(Frame(number, time_s, {IMAGE: image, CHASER_ORBIT: orbit}))
        seconds.append(time.process_time() - began)
        truth, pose = motion.state(time_s), motion.cam_from_target(time_s)
        error = navigation_error(said, truth, CAM_FROM_LVLH, pose)
        state, alike_deg = relative_state(said), np.nan
        if state is not None:
            found = state.cam_from_target(CAM_FROM_LVLH)
            alike_deg = symmetric_attitude_deg(found, pose, wireframe.symmetries)
        row: dict[str, Any] = {name: getattr(error, name) for name in ERRORS}
        row |= {"alike_deg": alike_deg, "range_m": float(np.linalg.norm(pose.translation))}
        row |= {"mode": said.mode or "", "reason": said.reason or ""}
        for name, value in row.items():
            rows.setdefault(name, []).append(value)
    return Outcome({name: np.array(value) for name, value in rows.items()}, np.array(seconds))


def _world(task: MotionTask) -> World:
    return world_of(drawn_scenario(task)[1])
