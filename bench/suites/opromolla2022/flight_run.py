"""Some runs over one set of frames: each with its own noise, prior, calibration and survey."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench.scoring.judgement import is_wrong, without_numbers
from bench.scoring.limits import Limits
from bench.scoring.metrics.pose_errors import POSE_DOF, frame_nees
from bench.scoring.pairs.detections import judge, visible_markers
from bench.suites.opromolla2022.cases import FLIGHTS
from bench.suites.opromolla2022.exact_centroids import errors_of_exact_centroids
from bench.suites.opromolla2022.frame_file import OnceExposed, frame_path, read_frame
from bench.suites.opromolla2022.frame_making import FlightSizes, scenario_of, under
from bench.suites.units import Outcome
from models.arrays import AnyArray, Floats, Image
from models.estimate import Estimate, PoseEstimate
from models.frame import Frame, ImageReading
from models.onboard import OnboardKnowledge
from models.pose import RigidTransform, pose_error
from pipelines.pipeline import Pipeline
from pipelines.registry import registered_pipeline
from renders.detector.marker_windows import expose_windows
from renders.scenario.error_sets import ERROR_SETS, with_error_set
from renders.scenario.scenario import Scenario
from renders.world.build import world_of
from renders.world.exposure import Exposure
from renders.world.told import EXACT_CLOCK, ToldClock
from renders.world.told_draws import drawn
from renders.world.world import World

SEED_STRIDE = 1_000_000  # runs of one seed, and no run of another
MOST_REASON = 90
EXACT_PEER = "exact"


@dataclass(frozen=True)
class FlightTask:
    """Runs over the frames of one flight under one Sun.

    Attributes
    ----------
    flight, sun : str
    frames : str
        Hash of all that shapes the frames.
    sizes : FlightSizes
    errors : tuple of str
        Names of the sets of errors under which each run is flown; they share its noise.
    levels : str
        What those sets are, as text.
    options : str
        All settings of the pipeline's variants, as text.
    variants : tuple of str
    first_run, runs : int
    seed : int
    """

    flight: str
    sun: str
    frames: str
    sizes: FlightSizes
    errors: tuple[str, ...]
    levels: str
    options: str
    variants: tuple[str, ...]
    first_run: int
    runs: int
    seed: int


@dataclass(frozen=True, eq=False)
class _Mission:
    """One run under one set of errors."""

    scenario: Scenario
    onboard: OnboardKnowledge
    clock: ToldClock
    mount: tuple[Floats, Floats]
    mount_variance: Floats
    pipelines: dict[str, Pipeline]


def fly(task: FlightTask, frames: str) -> Outcome:
    """Fly some runs over all frames.

    Parameters
    ----------
    task : FlightTask
    frames : str
        Folder of the flight's frames.

    Returns
    -------
    Outcome
        ``time_s``, ``range_m`` (frames,), ``whole``, ``shown`` (frames, markers), the latter the
        share of each that is lit and seen; and for each set of errors and variant
        ``SET/VARIANT/errors`` (runs, frames, 6), m and deg, NaN without a pose; ``nees``,
        ``wrong``, ``missed``, ``outline``, ``attitude_deg``, ``reason`` (runs, frames);
        ``centroids`` (runs, frames, markers, 2), px, NaN where none was used. ``SET/exact/errors``
        is what exact centroids give. Seconds of one core, by frame.

    Raises
    ------
    DatasetError
        If a frame is absent or damaged.
    """
    flight = next(own for own in FLIGHTS if own.key == task.flight)
    plain = under(scenario_of(flight, task.sizes), task.sun)
    world = world_of(plain)
    pattern = world.target.markers
    assert pattern is not None
    registered = registered_pipeline(flight.pipeline)
    numbers = [SEED_STRIDE * task.seed + task.first_run + number for number in range(task.runs)]
    missions = {
        name: [_mission(plain, name, run, registered.make, task.variants) for run in numbers]
        for name in task.errors
    }
    limits = Limits(plain.limits.wrong_position_m, plain.limits.wrong_attitude_deg)
    tables = _Tables(task, len(plain.times_s), len(pattern))
    seconds = []
    for index in range(len(plain.times_s)):
        began = time.process_time()
        once = read_frame(frame_path(Path(frames), task.sun, index))
        there = visible_markers(once.truth, world.camera, pattern)
        tables.frame(index, once, there.whole)
        for place, run in enumerate(numbers):
            shown: dict[str, Frame] = {}
            for name in task.errors:
                own = missions[name][place]
                images = f"{own.scenario.drift} {own.clock}"
                if images not in shown:
                    shown[images] = _frame(world, once, own, run)
                truth = _truth_at(world, once, own.clock)
                for variant, pipeline in own.pipelines.items():
                    said = pipeline.process(shown[images])
                    row = _judged(said, own, truth, there, limits)
                    tables.put(f"{name}/{variant}", place, index, row)
        for name in task.errors:
            tables.exact(name, index, once, missions[name], there.whole)
        seconds.append(time.process_time() - began)
    return Outcome(tables.values(), np.array(seconds))


def _mission(
    plain: Scenario, name: str, run: int, make: Any, variants: tuple[str, ...]
) -> _Mission:
    scenario = with_error_set(plain, name)
    world = world_of(scenario)
    onboard = world.onboard(run)
    own = ERROR_SETS[name]
    turn = np.deg2rad(own.mount_deg) * drawn(run, "mount.turn_deg", 3)
    place = own.mount_m * drawn(run, "mount.place_m", 3)
    variance = np.repeat([np.deg2rad(own.mount_deg) ** 2, own.mount_m**2], 3)
    pipelines = {variant: make(onboard, variant) for variant in variants}
    return _Mission(
        scenario, onboard, world.clock(run), (turn, place), np.diag(variance), pipelines
    )


def _frame(world: World, once: OnceExposed, own: _Mission, run: int) -> Frame:
    """Return a frame as a run sees it."""
    readings = {}
    for stream in world.sensor.streams:
        exposure = Exposure(once.index, stream.band, once.time_s + stream.offset_s)
        image: Image = expose_windows(
            once.images[stream.band],
            once.windows[stream.band],
            own.scenario,
            world.camera,
            exposure,
            once.exposure_ms,
            run,
        )
        middle_s = own.clock.shows(once.time_s) + stream.offset_s
        readings[stream.name] = ImageReading(image, middle_s, once.exposure_ms)
    return Frame(once.index, own.clock.shows(once.time_s), readings)


def _truth_at(world: World, once: OnceExposed, clock: ToldClock) -> RigidTransform:
    """Return the true pose when the true time was what the clock on board shows."""
    if clock == EXACT_CLOCK:
        return once.truth.cam_from_target
    motion = world.scenario.motion
    time_s = min(max(clock.shows(once.time_s), motion.start_s), motion.end_s)
    return world.trajectory.cam_from_target(time_s)


def _judged(
    said: Estimate, own: _Mission, truth: RigidTransform, there: Any, limits: Limits
) -> dict[str, Any]:
    found = judge(said.detected, there)
    centroids = np.full((len(there.whole), 2), np.nan)
    kept = found.true & found.used
    centroids[found.marker[kept]] = found.error_px[kept]
    row: dict[str, Any] = {
        "centroids": centroids,
        "missed": said.pose is None and there.enough,
        "reason": without_numbers(said.reason or "")[:MOST_REASON],
    }
    if said.pose is None:
        return row
    covariance = said.pose.covariance
    pose = PoseEstimate(
        said.pose.cam_from_target.perturbed(*own.mount),
        None if covariance is None else covariance + own.mount_variance,
    )
    error = pose_error(pose.cam_from_target, truth)
    square = frame_nees(pose, truth)
    length_m = float(np.linalg.norm(error.position_m))
    row |= {
        "outline": said.mode == "outline",
        "errors": [*error.position_m, *error.euler_deg],
        "attitude_deg": error.attitude_deg,
        "nees": np.nan if square is None else square,
        "wrong": is_wrong(length_m, error.attitude_deg, ((square, POSE_DOF),), limits),
    }
    return row


class _Tables:
    """The arrays of an outcome, filled frame by frame."""

    def __init__(self, task: FlightTask, frames: int, markers: int) -> None:
        self._shapes: dict[str, tuple[tuple[int, ...], Any, Any]] = {
            "errors": ((6,), np.float32, np.nan),
            "attitude_deg": ((), np.float32, np.nan),
            "nees": ((), np.float32, np.nan),
            "wrong": ((), np.bool_, False),
            "missed": ((), np.bool_, False),
            "outline": ((), np.bool_, False),
            "reason": ((), f"<U{MOST_REASON}", ""),
            "centroids": ((markers, 2), np.float32, np.nan),
        }
        self._values: dict[str, AnyArray] = {
            "time_s": np.zeros(frames),
            "range_m": np.zeros(frames),
            "whole": np.zeros((frames, markers), dtype=np.bool_),
            "shown": np.zeros((frames, markers)),
        }
        for name in task.errors:
            shape = (task.runs, frames, 6)
            self._values[f"{name}/{EXACT_PEER}/errors"] = np.full(shape, np.nan, dtype=np.float32)
            for variant in task.variants:
                for key, (rest, kind, empty) in self._shapes.items():
                    filled = np.full((task.runs, frames, *rest), empty, dtype=kind)
                    self._values[f"{name}/{variant}/{key}"] = filled

    def frame(self, index: int, once: OnceExposed, whole: AnyArray) -> None:
        """Note what a frame is."""
        self._values["time_s"][index] = once.time_s
        self._values["range_m"][index] = np.linalg.norm(once.truth.cam_from_target.translation)
        self._values["whole"][index] = whole
        self._values["shown"][index] = np.minimum(once.truth.visible, once.truth.lamp_lit)

    def put(self, cell: str, run: int, index: int, row: Mapping[str, Any]) -> None:
        """Note what came of a frame in a run."""
        for key, value in row.items():
            self._values[f"{cell}/{key}"][run, index] = value

    def exact(
        self, name: str, index: int, once: OnceExposed, missions: list[_Mission], seen: AnyArray
    ) -> None:
        """Note what exact centroids give in all runs."""
        told = [own.onboard for own in missions]
        cameras = [each.camera for each in told if each.camera is not None]
        points = np.array([e.markers.points_in_target for e in told if e.markers is not None])
        self._values[f"{name}/{EXACT_PEER}/errors"][:, index] = errors_of_exact_centroids(
            cameras, points, once.truth.markers_px, seen, once.truth.cam_from_target
        )

    def values(self) -> dict[str, AnyArray]:
        """Return them by name."""
        return self._values
