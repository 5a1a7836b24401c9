"""The paper's relative case with a chaser that navigates for itself, and with one that knows.

The target is XMM, as in Pesce et al. 2019, whose camera and noise these are; what VINAG 2018 prints
is the orbit, the place, the spin and 1 Hz. Both runs of a pair see the same corners.
"""

from __future__ import annotations

import time
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.scoring.tumble.navigation_errors import NavigationError, navigation_error
from bench.suites.pesce2019.start_errors import StartErrors, drawn_start
from bench.suites.pesce2019.synthetic_points import PointNoise, points_of
from bench.suites.units import Outcome
from models.frame import POINTS, Frame, Reading, TableReading
from models.motion.tumble import CAM_FROM_LVLH
from models.onboard import OnboardKnowledge, needed
from pipelines.absolute.pipeline import ORBIT
from pipelines.absolute.registered import make as make_absolute
from pipelines.integrated.options import relative_options_for
from pipelines.integrated.pipeline import IntegratedNavigation
from pipelines.pipeline import Pipeline
from pipelines.uncooperative.knowledge import UncooperativeKnowledge
from pipelines.uncooperative.pipeline import Uncooperative
from renders.scenario.scenario import Scenario
from renders.world.build import world_of
from renders.world.world import World

CASE = Path(__file__).parents[2] / "cases" / "xmm-vinag.toml"
NAVIGATED, TRUE = "navigated", "true"
CHASERS = (NAVIGATED, TRUE)
REGIME = "leo"


@dataclass(frozen=True)
class ChainTask:
    """One run.

    Attributes
    ----------
    scenario : str
        The case, as TOML.
    chaser : str
        Whose state the relative filters get: ``navigated`` or ``true``.
    variant, options : str
        And all settings as text.
    noise : PointNoise
    start : StartErrors
    seed, run : int
    span_s, rate_hz : float, s and Hz
    """

    scenario: str
    chaser: str
    variant: str
    options: str
    noise: PointNoise
    start: StartErrors
    seed: int
    run: int
    span_s: float
    rate_hz: float = 1.0


def follow(task: ChainTask) -> Outcome:
    """Follow the target through a run.

    Returns
    -------
    Outcome
        By frame (n,): ``time_s``; the position error of the state and of the image alone in m,
        ``position_m`` and ``raw_position_m``; ``attitude_deg`` and ``raw_attitude_deg``;
        ``nees_translation`` and ``nees_rotation``; ``chaser_m``, how far off the chaser's own
        position is. Seconds of one core, by frame.
    """
    world = _world(task)
    motion = world.absolute
    if motion is None:
        raise TypeError("expected a case with a chaser on an orbit, got one without")
    onboard = world.onboard(task.run)
    first_s = world.scenario.times_s[0]
    start = drawn_start(motion.state(first_s), task.start, task.seed, task.run)
    pipeline = _pipeline(task, onboard, Uncooperative(
        UncooperativeKnowledge.of(onboard), relative_options_for(task.variant, REGIME), start
    ))  # fmt: skip
    rows, seconds = [], []
    for frame in corner_frames(world, task.noise, task.seed, task.run):
        now_s = frame.time_s
        began = time.process_time()
        said = pipeline.process(frame)
        seconds.append(time.process_time() - began)
        error = navigation_error(said, motion.state(now_s), CAM_FROM_LVLH)
        off_m = 0.0
        if ORBIT in said.states and task.chaser == NAVIGATED:
            at = said.states[ORBIT].values["position_in_inertial_m"]
            off_m = float(np.linalg.norm(at - motion.chaser_state(now_s).position_in_inertial))
        rows.append([now_s, *_kept(error), off_m])
    names = ("time_s", *KEPT, "chaser_m")
    table = np.array(rows)
    return Outcome({name: table[:, k] for k, name in enumerate(names)}, np.array(seconds))


def corner_frames(world: World, noise: PointNoise, seed: int, run: int) -> Iterator[Frame]:
    """Yield a world's frames: corners instead of images, beside what its sensors gave.

    Parameters
    ----------
    world : World
        Of a free target.
    noise : PointNoise
    seed, run : int
    """
    onboard, motion = world.onboard(run), world.absolute
    if motion is None:
        raise TypeError("expected a case with a chaser on an orbit, got one without")
    wireframe = needed(onboard.wireframe, "wireframe.json", "the chain")
    camera = needed(onboard.camera, "camera.toml", "the chain")
    since_s = float("-inf")
    for index, now_s in enumerate(world.scenario.times_s):
        readings: dict[str, Reading] = {
            each.name: each.reading(index, now_s, since_s, run) for each in world.tables
        }
        key = (seed, run, index)
        pixels = points_of(wireframe, camera, motion.cam_from_target(now_s), noise, key)
        readings[POINTS] = TableReading(("u_px", "v_px"), np.full(len(pixels), now_s), pixels)
        yield Frame(index, now_s, readings)
        since_s = now_s


KEPT = (
    "position_m", "raw_position_m", "attitude_deg", "raw_attitude_deg", "nees_translation",
    "nees_rotation",
)  # fmt: skip


def _kept(error: NavigationError) -> list[float]:
    return [float(getattr(error, name)) for name in KEPT]


def _world(task: ChainTask) -> World:
    table = tomllib.loads(task.scenario)
    start_s = table["motion"]["start_s"]
    table["motion"] |= {"end_s": start_s + task.span_s, "rate_hz": task.rate_hz}
    table["render"]["seed"] = task.seed
    table["tumble"]["onboard"] = {"sigma_px": task.noise.sigma_px}
    if task.chaser == TRUE:
        table["navigation"]["by"] = "stated"
        table["tumble"]["onboard"] |= {"chaser_sigma_m": 0.0, "chaser_sigma_m_s": 0.0}
    return world_of(Scenario.model_validate(table))


def _pipeline(task: ChainTask, onboard: OnboardKnowledge, relative: Uncooperative) -> Pipeline:
    if task.chaser == TRUE:
        return relative
    mount = UncooperativeKnowledge.of(onboard).cam_from_lvlh
    return IntegratedNavigation(make_absolute(onboard, task.variant), relative, mount)
