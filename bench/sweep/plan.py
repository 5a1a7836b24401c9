"""What a sweep is asked to do, and what that comes to: poses, Suns, exposures, lamp powers."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Literal

import numpy as np
from scipy.optimize import brentq

from bench.chains.catalogue import chain_named
from bench.estimating.contenders import Contender, contenders
from bench.estimating.runs import PREFERRED
from models.errors import ScenarioError
from models.lights.sun_grid import NamedSun, chosen_suns, sun_grid
from models.reading.options import check_option
from renders.batches.sweep_batches import suns_in_a_batch
from renders.scenario.motion_choice import takes_stills
from renders.scenario.scenario import RenderRequest, Scenario, check_scenario, resolve
from renders.store.budget import budget_bytes
from renders.world.build import world_of
from renders.world.world import World

DEFAULT_STEP_DEG = 15.0
DEFAULT_WIDTH_PX = 1024  # a survey of hundreds of Suns; a case with fewer columns keeps its own
DEFAULT_MEMORY_GB = 4.0
DEFAULT_DRAWS, MOST_DRAWS = 5, 1000
RANGE_STEP_S = 10.0  # the range falls by 0.15 m meanwhile; within less it never rises and falls
EXPOSURE_MS, LAMP_W_SR = (1e-4, 1e5), (1e-6, 1e6)  # as a scenario's
MOST_MARKER_SAMPLES, MOST_MEMORY_GB = 65_536, 1e5
SAME_INSTANT_S = 1e-6
TIME_DIGITS = 3  # a moment is told to the millisecond: 15 um of range


@dataclass(frozen=True)
class SweepRequest:
    """A case and the options typed with it.

    Attributes
    ----------
    case : str
        Name of a case, or path of a scenario file.
    out : Path
        Folder of the sweep.
    range_m, time_s : tuple of float, m and s
        Poses: when the camera is so far from the ring, or at these moments.
    sun_step_deg : float, optional, deg
        A grid of Suns; see ``models.lights.sun_grid``.
    suns : tuple of str
        Or a list of them.
    exposure_ms, lamp_w_sr : tuple of float, ms and W/sr
        Exposure times and lamp powers to try with every pose and Sun; the case's own if empty.
    pipeline : str
        Label or name of a pipeline; ``both`` variants of the house's.
    draws : int
        Times that each frame is exposed anew, as so many runs, by the pipeline that the maps show.
    width, spp, marker_samples : int, optional
    variant : str
        How Mitsuba computes: auto, llvm, cuda or scalar.
    store : Path, optional
    store_budget_gb : float, optional
        What the store may take of the disk; see ``renders.store.budget``.
    threads : int, optional
    memory_gb : float, GiB
        Bound on the memory of the rendering process.
    """

    case: str
    out: Path
    range_m: tuple[float, ...] = ()
    time_s: tuple[float, ...] = ()
    sun_step_deg: float | None = None
    suns: tuple[str, ...] = ()
    exposure_ms: tuple[float, ...] = ()
    lamp_w_sr: tuple[float, ...] = ()
    pipeline: str = "both"
    draws: int = DEFAULT_DRAWS
    width: int | None = None
    spp: int | None = None
    marker_samples: int | None = None
    variant: Literal["auto", "llvm", "cuda", "scalar"] = "auto"
    store: Path | None = None
    store_budget_gb: float | None = None
    threads: int | None = None
    memory_gb: float = DEFAULT_MEMORY_GB


@dataclass(frozen=True)
class SweepPose:
    """One moment of the motion.

    Attributes
    ----------
    time_s : float, s
        Of the frame.
    range_m : float, m
        From the camera to the target frame's origin then.
    """

    time_s: float
    range_m: float


@dataclass(frozen=True)
class SweepPlan:
    """A request resolved.

    Attributes
    ----------
    request : SweepRequest
    scenario : Scenario
        Of the case with the options given; its motion and Sun are set for each frame.
    poses : tuple of SweepPose
    suns : tuple of NamedSun
    pipelines : tuple of Contender
    workers : int
        Processes that expose and estimate.
    suns_in_a_pass : int
    store_bytes : float
        The store's budget.
    """

    request: SweepRequest
    scenario: Scenario
    poses: tuple[SweepPose, ...]
    suns: tuple[NamedSun, ...]
    pipelines: tuple[Contender, ...]
    workers: int
    suns_in_a_pass: int
    store_bytes: float

    @property
    def map_pipeline(self) -> Contender:
        """The pipeline whose results the maps show."""
        by_label = {each.label: each for each in self.pipelines}
        return by_label.get(PREFERRED, self.pipelines[0])


def plan_sweep(request: SweepRequest) -> SweepPlan:
    """Resolve a request, and refuse what cannot be done before anything is.

    Raises
    ------
    ScenarioError
        The message says what is possible.
    """
    asked = RenderRequest(
        request.case,
        request.out,
        width=request.width,
        spp=request.spp,
        threads=request.threads,
    )
    scenario = resolve(asked)
    if request.width is None and scenario.simulated_camera.width > DEFAULT_WIDTH_PX:
        scenario = resolve(replace(asked, width=DEFAULT_WIDTH_PX))
    check_option("--marker-samples", request.marker_samples, 1, MOST_MARKER_SAMPLES, whole=True)
    check_option("--draws", request.draws, 1, MOST_DRAWS, whole=True)
    check_option("--memory-gb", request.memory_gb, 0.0, MOST_MEMORY_GB)
    for exposure_ms in request.exposure_ms:
        check_option("--exposure-ms", exposure_ms, *EXPOSURE_MS)
    if request.exposure_ms and scenario.shutter is not None and scenario.shutter.blur:
        raise ScenarioError(
            f"{request.case}: expected no --exposure-ms with shutter.blur, where light is traced "
            f"for one exposure time, got {request.exposure_ms[0]:g}; type exposure.exposure_ms"
        )
    for lamp_w_sr in request.lamp_w_sr:
        check_option("--lamp-w-sr", lamp_w_sr, *LAMP_W_SR)
    if request.marker_samples is not None:
        render = scenario.render.model_copy(update={"marker_samples": request.marker_samples})
        scenario = scenario.model_copy(update={"render": render})
        check_scenario(scenario, f"{request.case} with the options given")
    cores = os.cpu_count() or 1
    suns, store_bytes = _suns(request), budget_bytes(request.store_budget_gb)
    world = world_of(scenario)
    if request.lamp_w_sr and not has_lamps(world):
        raise ScenarioError(
            f"expected --lamp-w-sr only with lamps of the camera's own, which {scenario.name} has "
            "not; leave it out"
        )
    return SweepPlan(
        request=request,
        scenario=scenario,
        poses=_poses(request, world),
        suns=tuple(suns),
        pipelines=tuple(_contenders(request, world)),
        workers=min(request.threads or cores, cores),
        suns_in_a_pass=suns_in_a_batch(
            world.camera, len(world.bands), request.memory_gb, store_bytes
        ),
        store_bytes=store_bytes,
    )


def has_lamps(world: World) -> bool:
    """Tell whether the camera has lamps of its own, whose power a sweep can try."""
    return any(stream.own_lamps is not None for stream in world.sensor.streams)


def _contenders(request: SweepRequest, world: World) -> list[Contender]:
    streams = [stream.name for stream in world.sensor.streams]
    streams += [sensor.name for sensor in world.tables]
    chain = chain_named(world.chain)
    if chain.judge_alone is None:
        raise ScenarioError(
            f"expected a case whose frames can be judged one by one, got {world.scenario.name}, "
            f"whose chain {chain.name} cannot; `rvbench run` renders and scores it"
        )
    own = chain.pipelines
    if request.pipeline == "both":
        found, _ = contenders(streams, own, foreign=False)
    else:
        found, _ = contenders(streams, own, (request.pipeline,))
    if not found:
        raise ScenarioError(
            f"expected a pipeline for {world.scenario.name}, the house has none; give one that is "
            "installed with --pipeline NAME"
        )
    return found


def _suns(request: SweepRequest) -> list[NamedSun]:
    if request.suns and request.sun_step_deg is not None:
        raise ScenarioError(
            "expected either a grid of Suns, --sun-step-deg, or a list of them, --suns; got both"
        )
    if request.suns:
        return chosen_suns(request.suns)
    step_deg = DEFAULT_STEP_DEG if request.sun_step_deg is None else request.sun_step_deg
    return sun_grid(step_deg)


def _poses(request: SweepRequest, world: World) -> tuple[SweepPose, ...]:
    if not request.range_m and not request.time_s:
        near_m, far_m = ranges_covered_m(world)
        raise ScenarioError(
            f"expected a pose of {world.scenario.name}: --range-m from {near_m:.2f} to "
            f"{far_m:.2f}, or --time-s from {world.scenario.motion.start_s:g} to "
            f"{world.scenario.motion.end_s:g}; got neither"
        )
    times_s = [moment_at_range(world, range_m) for range_m in request.range_m]
    motion = world.scenario.motion
    for time_s in request.time_s:
        if not motion.start_s <= time_s <= motion.end_s:
            raise ScenarioError(
                f"expected --time-s from {motion.start_s:g} to {motion.end_s:g}, the moments of "
                f"{world.scenario.name}, got {time_s:g}"
            )
        times_s.append(_still_at(world, time_s) if takes_stills(world.scenario) else time_s)
    return tuple(SweepPose(time_s, range_at(world, time_s)) for time_s in dict.fromkeys(times_s))


def range_at(world: World, time_s: float) -> float:
    """Return how far the camera is from the target frame's origin, m."""
    return float(np.linalg.norm(world.trajectory.cam_from_target(time_s).translation))


def ranges_covered_m(world: World) -> tuple[float, float]:
    """Return the least and the greatest range of a case, m, each rounded inwards to a cm."""
    ranges_m = [range_at(world, time_s) for time_s in _clock_s(world)]
    near_m, far_m = np.ceil(100.0 * min(ranges_m)) / 100.0, np.floor(100.0 * max(ranges_m)) / 100.0
    return float(near_m), float(far_m)


def moment_at_range(world: World, range_m: float) -> float:
    """Return when the camera first is so far from the target frame's origin, s, to the millisecond.

    Of stills, the one that comes nearest to it.

    Raises
    ------
    ScenarioError
        If it never is; the message says what ranges there are.
    """
    clock_s = _clock_s(world)
    near_m, far_m = ranges_covered_m(world)
    if takes_stills(world.scenario) and near_m <= range_m <= far_m:
        return min(clock_s, key=lambda time_s: abs(range_at(world, time_s) - range_m))
    excess_m = [range_at(world, time_s) - range_m for time_s in clock_s]
    for number, (before, after) in enumerate(pairwise(excess_m)):
        if before == 0.0 or before * after < 0.0:
            crossing_s = brentq(
                lambda time_s: range_at(world, time_s) - range_m,
                clock_s[number],
                clock_s[number + 1],
            )
            return round(float(crossing_s), TIME_DIGITS)
    motion = world.scenario.motion
    raise ScenarioError(
        f"expected --range-m from {near_m:.2f} to {far_m:.2f}, the ranges of {world.scenario.name} "
        f"from {motion.start_s:g} to {motion.end_s:g} s, got {range_m:g}"
    )


def _still_at(world: World, time_s: float) -> float:
    nearest_s = min(world.scenario.times_s, key=lambda row_s: abs(row_s - time_s))
    if abs(nearest_s - time_s) > SAME_INSTANT_S:
        raise ScenarioError(
            f"expected --time-s of a row of {world.scenario.name}'s table of poses, which is taken "
            f"as stills, such as {nearest_s:.10g}; got {time_s:g}"
        )
    return nearest_s


def _clock_s(world: World) -> list[float]:
    motion = world.scenario.motion
    if takes_stills(world.scenario):
        return list(world.scenario.times_s)
    count = max(2, int(np.ceil((motion.end_s - motion.start_s) / RANGE_STEP_S)) + 1)
    return [float(time_s) for time_s in np.linspace(motion.start_s, motion.end_s, count)]
