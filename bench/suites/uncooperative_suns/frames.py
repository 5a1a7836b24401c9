"""The frames of one motion: light of its Suns traced together, then each start metered and exposed.

What the pipelines see of a start are its images, their times and exposures; the poses and what is
lit stand beside, for judging alone.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from bench.suites.uncooperative_suns.cases import SUNS, DrawnMotion, MotionTask, draw_motion
from bench.suites.units import Outcome
from models.arrays import Image
from models.camera import Camera
from models.motion.pose_table import EARTH, SUN, pose_columns
from models.onboard import needed
from models.sensors.auto_exposure import AutoExposure
from models.sensors.camera_chip import Detector
from models.wireframe.wireframe import Wireframe
from renders.batches.studio import Studio, start_renderer
from renders.detector.compose import compose
from renders.scenario.own_target import wireframe_of, with_own_target_read
from renders.scenario.scenario import Scenario, check_scenario
from renders.store.kept_light import LightKeeping
from renders.store.light_keys import LightKeys
from renders.store.radiance_store import RadianceStore, default_store
from renders.variant.choice import choose_variant
from renders.world.build import world_of
from renders.world.exposure import Exposure
from renders.world.world import World

APART_S = 0.2  # rows of one pose, one for each Sun, follow each other so soon
METER = AutoExposure(percentile=99.99, fill=0.6, max_step=8.0, min_ms=0.01, max_ms=200.0)
FIRST_MS = 6.0
METERED = 4  # times before the first image: a camera that has looked there for a while
LIT_SIGMAS = 3.0  # of the detector's noise without light
F_NUMBER = 8.0


def scenario_of(task: MotionTask) -> Scenario:
    """Return the scenario of a motion's target and camera, with one pose in view.

    Raises
    ------
    ScenarioError
        If the target cannot be rendered.
    """
    return _scenario(task, ["0.0,0.0,0.0,1000.0,1.0,0.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0"])


def known_of(task: MotionTask) -> tuple[Camera, Detector, Wireframe]:
    """Return what is known before flight of a task's camera and target."""
    scenario = scenario_of(task)
    onboard = world_of(scenario).onboard(0)
    camera = needed(onboard.camera, "camera.toml", "the suite")
    detector = needed(onboard.detector, "detector.toml", "the suite")
    return camera, detector, wireframe_of(scenario)


def drawn(task: MotionTask) -> DrawnMotion:
    """Return a task's motion."""
    camera, _, wireframe = known_of(task)
    return draw_motion(task, camera, wireframe.radius_m)


def studio_of(world: World) -> Studio:
    """Return where a world's frames are made, by one thread; their light is not kept."""
    start_renderer(choose_variant("auto"), 1)
    store = RadianceStore(default_store(), None)
    return Studio(world, store, LightKeys(world, "jit"), None, kept=LightKeeping("none"))


def render_motion(task: MotionTask) -> Outcome:
    """Render a motion under all of its Suns.

    Parameters
    ----------
    task : MotionTask

    Returns
    -------
    Outcome
        ``images`` (k, n, height, width) uint16; ``exposure_ms`` (k, n); ``lit`` (k, n), the share
        of the silhouette that is above three sigmas; ``covered`` (n,), pixels of the silhouette;
        ``bracket`` (k, n, b, height, width) uint16, further exposures of the same light.
    """
    motion = drawn(task)
    world = world_of(_scenario(task, _rows(motion)))
    studio = studio_of(world)
    count, size = len(motion.times_s), (world.camera.height, world.camera.width)
    images = np.zeros((SUNS, count, *size), dtype=np.uint16)
    exposure_ms, lit = np.zeros((SUNS, count)), np.zeros((SUNS, count))
    covered = np.zeros(count, dtype=np.int64)
    bracket = np.zeros((SUNS, count, len(task.bracket), *size), dtype=np.uint16)
    for place in range(count):
        own = world.exposures[SUNS * place : SUNS * (place + 1)]
        pose = motion.poses[place]
        mask = studio.pixel_truth(own[0], pose).depth_m > 0.0
        covered[place] = mask.sum()
        for number, exposure in enumerate(own):
            light = studio.light(exposure, pose, own[number + 1 :])
            before = images[number, place - 1] if place else None
            image, taken_ms = metered_image(
                world, light, exposure, exposure_ms[number, place - 1], before
            )
            images[number, place], exposure_ms[number, place] = image, taken_ms
            for draw, factor in enumerate(task.bracket, start=1):
                further = compose(world, light, exposure, factor * taken_ms, draw)
                bracket[number, place, draw - 1] = further
            lit[number, place] = lit_share(image, mask, world.scenario.simulated_detector)
    values: dict[str, Any] = {"images": images, "exposure_ms": exposure_ms, "lit": lit}
    return Outcome({**values, "covered": covered, "bracket": bracket}, np.zeros(0))


def metered_image(
    world: World, light: Any, exposure: Exposure, before_ms: float, before: Image | None
) -> tuple[Image, float]:
    """Meter from the image before, the first from some of its own, and expose.

    Parameters
    ----------
    world : World
    light : light of the exposure's groups
    exposure : Exposure
    before_ms : float, ms
        Exposure of the image before.
    before : (height, width) uint16 array or None, DN
        That image; None at the first.

    Returns
    -------
    (height, width) uint16 array, DN
        The image,
    float, ms
        and its exposure.
    """
    detector = world.scenario.simulated_detector
    if before is not None:
        taken_ms = METER.next_ms(before_ms, before, detector)
        return compose(world, light, exposure, taken_ms, 0), taken_ms
    taken_ms = FIRST_MS
    for _ in range(METERED):
        taken_ms = METER.next_ms(taken_ms, compose(world, light, exposure, taken_ms, 0), detector)
    return compose(world, light, exposure, taken_ms, 0), taken_ms


def lit_share(image: Image, mask: Any, detector: Detector) -> float:
    """Return the share of a silhouette that is above three sigmas of the detector's noise.

    Parameters
    ----------
    image : (height, width) uint16 array, DN
    mask : (height, width) array of bool
        The silhouette.
    detector : Detector
    """
    noise = float(detector.noise_dn(np.array([detector.bias_dn]))[0])
    above = image[mask] > detector.bias_dn + LIT_SIGMAS * noise
    return float(above.mean()) if above.size else 0.0


def _rows(motion: DrawnMotion) -> list[str]:
    """Return a row of the table of poses for each image under each Sun."""
    rows = []
    for image, (time_s, pose) in enumerate(zip(motion.times_s, motion.poses, strict=True)):
        target_from_inertial = pose.rotation.T @ motion.cam_from_inertial(image)
        earth = target_from_inertial @ motion.earth_in_inertial
        for number, sun in enumerate(motion.suns_in_inertial):
            wxyz = Rotation.from_matrix(pose.rotation).as_quat(scalar_first=True)
            seen = earth if motion.earth_shines[number] else np.zeros(3)
            head = [[time_s + APART_S * number], pose.translation, wxyz]
            cells = np.concatenate([*head, target_from_inertial @ sun, seen])
            rows.append(",".join(repr(float(x)) for x in cells))
    return rows


def _scenario(task: MotionTask, rows: list[str]) -> Scenario:
    table: dict[str, Any] = {
        "name": "uncooperative-suns",
        "target": task.target,
        "frame": {"kind": "single"},
        "camera": {"width": task.width},
        "optics": {"f_number": F_NUMBER},
        "render": {"samples": task.samples, "seed": int(task.rng(0).integers(2**31))},
        "earth": {"shines": True},
        "sun": {"default": "table"},
        "motion": {
            "kind": "poses",
            "table": [",".join((*pose_columns("cam_from_target"), *SUN, *EARTH)), *rows],
            "start_s": 0.0,
            "end_s": float(rows[-1].split(",", 1)[0]),
        },
        "exposure": {"mode": "fixed", "exposure_ms": FIRST_MS},
    }
    with_own_target_read(table, Path.cwd() / "suite")
    return check_scenario(Scenario(**table), f"the suite's target {task.target}")
