"""Frames of a flight, rendered once for all runs: light of all its Suns in one pass, then exposed.

What is kept of a frame is its image under each Sun and what the lens gets round the markers; the
light itself only passes through the store, within its budget.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from rich.console import Console

from bench.suites.opromolla2022.cases import Flight, named_sun
from bench.suites.opromolla2022.frame_file import OnceExposed, frame_path, write_frame
from models.arrays import Floats, Image
from models.camera import Camera
from models.errors import StorageError
from models.markers import MarkerPattern
from models.onboard import needed
from models.pose import RigidTransform
from models.progress_lines import LinePace, told
from renders.batches.replay import read_groups
from renders.batches.studio import Studio, start_renderer
from renders.batches.sweep_batches import PoseLight, suns_in_a_batch
from renders.detector.compose import compose
from renders.detector.exposure_control import ExposureControl
from renders.detector.marker_windows import check_windows, cut_windows
from renders.scenario.scenario import RenderRequest, Scenario, resolve
from renders.store.light_keys import PHYSICS_VERSION, LightKeys
from renders.store.radiance_store import RadianceStore, default_store
from renders.truth.exposure_truth import ExposureTruth
from renders.variant.choice import choose_variant
from renders.world.build import world_of
from renders.world.exposure import Exposure

MEMORY_GB = 4.0
REACH_RADII, REACH_PX = 1.3, 6.0  # round a marker: what any fit looks at
MOST_ROUNDS = 3  # of tracing what another process took out of the store meanwhile
FRAMES_VERSION = 1  # raise it when the same light gives other frames


@dataclass(frozen=True)
class FlightSizes:
    """How much of a flight.

    Attributes
    ----------
    rate_hz : float, Hz
    width : int, px
    samples : int, optional
        Per pixel; the case's own unless given.
    """

    rate_hz: float
    width: int
    samples: int | None = None


def scenario_of(flight: Flight, sizes: FlightSizes) -> Scenario:
    """Return a flight's scenario, without named errors.

    Raises
    ------
    ScenarioError
        If the sizes are none.
    """
    request = RenderRequest(
        flight.case, Path(), rate_hz=sizes.rate_hz, width=sizes.width, spp=sizes.samples
    )
    scenario = resolve(request)
    check_windows(scenario)
    return scenario


def under(scenario: Scenario, sun: str) -> Scenario:
    """Return a scenario under another Sun."""
    return scenario.model_copy(update={"sun": scenario.sun.model_copy(update={"default": sun})})


def flight_folder(frames: Path, flight: Flight, scenario: Scenario) -> Path:
    """Return where a flight's frames lie: the name holds the hash of all that shapes them.

    Parameters
    ----------
    frames : Path
        The suite's folder of frames.
    flight : Flight
    scenario : Scenario
        See ``scenario_of``.
    """
    return frames / f"{flight.key}-{flight_hash(flight, scenario)}"


def flight_hash(flight: Flight, scenario: Scenario) -> str:
    """Return the hash of all that shapes a flight's frames but the family of variants."""
    shaped = {
        "scenario": scenario.fingerprint(),
        "suns": flight.suns,
        "physics": PHYSICS_VERSION,
        "frames": FRAMES_VERSION,
        "numpy": np.__version__,
        "reach": (REACH_RADII, REACH_PX),
    }
    return hashlib.sha256(json.dumps(shaped, sort_keys=True).encode()).hexdigest()[:12]


class FlightFrames:
    """The frames of a flight, and those of them that are not there.

    Parameters
    ----------
    folder : Path
        See ``flight_folder``.
    flight : Flight
    scenario : Scenario
    suns : sequence of str
        Those of the flight's that are wanted.
    """

    def __init__(
        self, folder: Path, flight: Flight, scenario: Scenario, suns: Sequence[str]
    ) -> None:
        self.folder, self.scenario = folder, scenario
        self.suns = [sun for sun in flight.suns if sun in set(suns)]
        self.frames = len(scenario.times_s)

    def missing(self, index: int) -> list[int]:
        """Return the numbers of the Suns under which a frame is not there."""
        return [
            number
            for number, sun in enumerate(self.suns)
            if not frame_path(self.folder, sun, index).is_file()
        ]

    @property
    def left(self) -> list[int]:
        """Frames that are not there under every Sun."""
        return [index for index in range(self.frames) if self.missing(index)]

    def make(
        self,
        store: Path | None,
        budget_bytes: float | None,
        variant: Literal["auto", "llvm", "cuda", "scalar"],
        console: Console,
        threads: int | None = None,
    ) -> int:
        """Render what is missing; return how many frames that were.

        Parameters
        ----------
        store : Path or None
            Where light is kept; the house's cache unless given.
        budget_bytes : float or None
            What that may take.
        variant : str
            auto, llvm, cuda or scalar.
        console : Console
            For progress.
        threads : int, optional
            Cores to use; all unless given.

        Raises
        ------
        ScenarioError, StorageError, VariantError
            Each says what to do; nothing already done is lost.
        """
        left = self.left
        if left:
            chosen = choose_variant(variant)
            _Maker(self, store, budget_bytes, chosen, threads).make(left, console)
        return len(left)


class _Maker:
    def __init__(
        self,
        own: FlightFrames,
        store: Path | None,
        budget_bytes: float | None,
        variant: str,
        threads: int | None,
    ) -> None:
        self.own = own
        scenario = under(own.scenario, own.suns[0])
        self.world = world = world_of(scenario)
        world.check_poses()
        self.markers = needed(world.target.markers, "markers.toml", "the suite")
        place = RadianceStore(store or default_store(), budget_bytes)
        place.open_for_writing()
        keys = LightKeys(world, "scalar" if variant.startswith("scalar") else "jit")
        self.studio = Studio(world, place, keys, self.markers)
        self.worlds = [world_of(under(own.scenario, sun)) for sun in own.suns]
        self.control = ExposureControl(world, world.onboard(0).prior)
        self.named = [named_sun(sun) for sun in own.suns]
        colours = 3 if world.sensor.in_colour else 1
        most = suns_in_a_batch(world.camera, colours * len(world.bands), MEMORY_GB)
        self.groups_in_a_pass = colours * most
        start_renderer(variant, threads)

    def make(self, left: Sequence[int], console: Console) -> None:
        lines = LinePace(len(left))
        by_frame: dict[int, list[Exposure]] = {}
        for exposure in self.world.exposures:
            by_frame.setdefault(exposure.frame, []).append(exposure)
        for done, index in enumerate(left, start=1):
            self._make_frame(index, by_frame[index])
            if lines.due(done):
                to_come = told(lines.spent_s / done * (len(left) - done))
                console.print(
                    f"{self.own.folder.name}: {done} of {len(left)} frames; left: {to_come}",
                    soft_wrap=True,
                )

    def _make_frame(self, index: int, exposures: list[Exposure]) -> None:
        light = PoseLight(self.studio, self.named, exposures, self.worlds)
        truths: dict[str, ExposureTruth] | None = None
        for _ in range(MOST_ROUNDS):
            missing = self.own.missing(index)
            if not missing:
                return
            keys = {each.key for sun in missing for each in light.groups_of_sun[sun]}
            absent = {key for key in keys if self.studio.store.read(key) is None}
            for batch in light.batches(missing, absent, self.groups_in_a_pass):
                in_hand = [each.key for sun in batch.suns for each in light.groups_of_sun[sun]]
                traced = [each.key for each in batch.groups]
                self.studio.store.room.take_in_hand(frozenset([*in_hand, *traced]))
                light.trace(batch.groups)
                if batch.suns and truths is None:
                    truths = {
                        name: record
                        for name, record in light.truths().items()
                        if isinstance(record, ExposureTruth)
                    }
                for sun in batch.suns:
                    self._expose(light, sun, index, (truths or {})[self.own.suns[sun]])
        raise StorageError(
            f"expected to read back what was just written to {self.studio.store.folder}, got "
            "nothing; choose another --store on a disk that keeps it, or a larger "
            "--store-budget-gb"
        )

    def _expose(self, light: PoseLight, sun: int, index: int, truth: ExposureTruth) -> None:
        """Expose one frame under one Sun; nothing is written if its light is gone."""
        world = self.worlds[sun]
        entry = self.control.entry(index, _no_image)
        images, windows = {}, {}
        for exposure in light.exposures:
            groups = read_groups(self.studio.store, world, exposure, light.keys(sun)[exposure.band])
            if groups is None:
                return
            centres, reach = marker_places(world.camera, self.markers, light.poses[exposure.band])
            images[exposure.band] = compose(world, groups, exposure, entry.exposure_ms, 0)
            windows[exposure.band] = cut_windows(world, groups, exposure, centres, reach)
        frame = OnceExposed(index, entry.time_s, entry.exposure_ms, images, windows, truth)
        write_frame(frame_path(self.own.folder, self.own.suns[sun], index), frame)


def _no_image(index: int) -> Image:
    raise AssertionError("the suite's cases plan their exposures")


def marker_places(
    camera: Camera, markers: MarkerPattern, pose: RigidTransform
) -> tuple[Floats, Floats]:
    """Return where markers are in an image, (n, 2) px, and how far round each a fit looks, (n,) px.

    Parameters
    ----------
    camera : Camera
    markers : MarkerPattern
    pose : RigidTransform
        ``cam_from_target``.
    """
    in_cam = pose @ markers.points_in_target
    with np.errstate(divide="ignore"):
        radius_px = np.where(in_cam[:, 2] > 0.0, camera.fx * markers.radius_m / in_cam[:, 2], 0.0)
    return camera.project(in_cam), REACH_RADII * radius_px + REACH_PX
