"""A scenario: a TOML file read into frozen tables that refuse unknown keys, and its options.

A case such as ``maxar-approach`` is a scenario that ships with the bench; a path to a TOML file
works wherever a case's name does. Every default is written out beside the output.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import tomli_w
from pydantic import Field, ValidationError

from models.camera import Camera
from models.errors import ScenarioError, UnreadableError, cause
from models.reading.options import check_option
from models.reading.toml_file import read_toml
from models.sensors.camera_chip import Detector, Optics, Radiation
from models.sensors.lens_scatter import LensScatter
from models.spacecraft.catalogue import TARGETS
from renders.scenario.arm_tables import ArmTable, check_arm
from renders.scenario.asked_tables import AskedTable, LimitsTable
from renders.scenario.camera_choice import camera_of, check_camera, pixel_scale
from renders.scenario.camera_tables import (
    CameraTable,
    DetectorTable,
    ExposureTable,
    LensScatterTable,
    OpticsTable,
    RadiationTable,
    check_detector,
    check_exposure,
    check_focus,
    check_lens,
)
from renders.scenario.case_files import MOST_SCENARIO_BYTES, case_path
from renders.scenario.drift_table import DriftTable
from renders.scenario.embedded_files import with_files_read
from renders.scenario.error_sets import ErrorSetName, check_error_set, with_error_set
from renders.scenario.errors import explain
from renders.scenario.frame_checks import check_frames
from renders.scenario.light_tables import (
    EarthTable,
    FloodlightTable,
    LampsTable,
    RetroreflectorTable,
    SunTable,
    check_earth,
)
from renders.scenario.marker_tables import MarkersTable, markers_from
from renders.scenario.motion_choice import (
    check_motion,
    frame_kind_of,
    motion_kind_of,
    shortest_gap_ms,
    times_of,
)
from renders.scenario.motion_tables import FrameTable, MotionKind, MotionTable
from renders.scenario.navigation_tables import NavigationTable, check_navigation
from renders.scenario.orbit_tables import OrbitsTable, check_orbits
from renders.scenario.own_target import OwnTargetTable
from renders.scenario.picture_checks import check_picture
from renders.scenario.range_tables import RangeFinderTable, check_range_finder
from renders.scenario.shutter_table import ShutterTable, check_shutter
from renders.scenario.sky_tables import StarsTable, check_stars
from renders.scenario.sun_choice import check_suns
from renders.scenario.surface_tables import SurfaceTable
from renders.scenario.table import Name, Prose, Table
from renders.scenario.told_tables import CalibrationTable, PriorTable, ToldTable, check_told
from renders.scenario.tumble_tables import TumbleTable, check_tumble

OPTIONS = {
    "motion.rate_hz": "--rate-hz",
    "motion.start_s": "--span-s (its start)",
    "motion.end_s": "--span-s (its end)",
    "camera.width": "--width",
    "camera.rendered_width": "--width",
    "render.samples": "--spp",
    "sun.default": "--sun",
}
"""Which option stands for which key."""
MOST_THREADS = 512
SHAPING_NOTHING: dict[str, bool | set[str]] = {
    "description": True,
    "limits": True,
    "asked": True,
    "own_target": {"file"},
}
"""Prose, what is asked, and where a mesh lies."""


class RenderTable(Table):
    """How light is traced."""

    samples: int = Field(
        16,
        ge=1,
        le=4096,
        description="per pixel; best a power of two",
    )
    noise: float | None = Field(
        None,
        ge=0.05,
        le=100,
        description="of the light, in units of the detector's own, to which each pixel is sampled",
    )
    paths: int = Field(
        0,
        ge=0,
        le=2**28,
        description="of sunlight that are followed from each Sun to what mirrors throw it onto, "
        "once for all exposures where it stands still; 0: all light is found from the lens",
    )
    marker_samples: int = Field(
        4096, ge=1, le=65_536, description="per pixel in the marker windows"
    )
    max_depth: int = Field(4, ge=1, le=32, description="surface interactions of a path")
    seed: int = Field(
        1,
        ge=0,
        le=2**63 - 1,
        description="of the Monte-Carlo noise, and of the chaser's navigation",
    )


class Scenario(Table):
    """Everything that shapes a dataset: of image pairs, or of single images if it tumbles."""

    name: Name = Field(description="of the case")
    description: Prose = Field("", description="prose for its reader")
    target: Name = Field(
        "maxar1300",
        description=f"{', '.join(TARGETS)}, or a .toml file of a spacecraft of your own",
    )
    camera: CameraTable = CameraTable()  # type: ignore[call-arg]
    optics: OpticsTable = OpticsTable()  # type: ignore[call-arg]
    detector: DetectorTable = DetectorTable()  # type: ignore[call-arg]
    lens_scatter: LensScatterTable = LensScatterTable()  # type: ignore[call-arg]
    radiation: RadiationTable = RadiationTable()  # type: ignore[call-arg]
    lamps: LampsTable = LampsTable()  # type: ignore[call-arg]
    sun: SunTable = SunTable()  # type: ignore[call-arg]
    earth: EarthTable = EarthTable()  # type: ignore[call-arg]
    floodlight: FloodlightTable = FloodlightTable()  # type: ignore[call-arg]
    stars: StarsTable = StarsTable()  # type: ignore[call-arg]
    retroreflector: RetroreflectorTable = RetroreflectorTable()  # type: ignore[call-arg]
    motion: MotionTable = MotionTable()  # type: ignore[call-arg]
    render: RenderTable = RenderTable()  # type: ignore[call-arg]
    exposure: ExposureTable = ExposureTable()  # type: ignore[call-arg]
    shutter: ShutterTable | None = Field(
        None, description="where the camera moves while its shutter is open"
    )
    prior: PriorTable = PriorTable()  # type: ignore[call-arg]
    calibration: CalibrationTable = CalibrationTable()  # type: ignore[call-arg]
    tumble: TumbleTable | None = Field(None, description="a free target, without markers")
    range_finder: RangeFinderTable | None = Field(None, description="along the boresight")
    navigation: NavigationTable | None = Field(
        None, description="the chaser's own, and both orbits in the real field"
    )
    orbits: OrbitsTable | None = Field(
        None, description="of target and chaser, in place of the papers' approach"
    )
    limits: LimitsTable = LimitsTable()  # type: ignore[call-arg]
    asked: AskedTable = AskedTable()  # type: ignore[call-arg]
    frame: FrameTable | None = Field(None, description="what a frame is")
    markers: MarkersTable | None = Field(
        None, description="your own, in a file or here, instead of the target's"
    )
    arm: ArmTable | None = Field(None, description="the chaser's arm, where it moves")
    told: ToldTable | None = Field(None, description="what a pipeline is told otherwise")
    drift: DriftTable | None = Field(None, description="what lamps and lens have become")
    errors: ErrorSetName | None = Field(
        None,
        description="a named set of errors in place of [prior], [calibration], [told] and [drift]",
    )
    surface: Annotated[tuple[SurfaceTable, ...], Field(strict=False, max_length=100)] | None = (
        Field(None, description="materials of this specimen that differ from the house's")
    )
    own_target: OwnTargetTable | None = Field(None, description="as its file had it")

    @property
    def motion_kind(self) -> MotionKind:
        """What moves: ``approach``, ``tumble`` or ``poses``."""
        return motion_kind_of(self)

    @property
    def frame_kind(self) -> str:
        """What a frame is: ``pairs``, ``single`` or ``colour``."""
        return frame_kind_of(self)

    @property
    def times_s(self) -> list[float]:
        """Middles of the exposures, s; of a pair, of the 850 nm one."""
        return times_of(self)

    @property
    def simulated_camera(self) -> Camera:
        """The camera that renders."""
        return camera_of(self.camera)

    @property
    def pixel_scale(self) -> float:
        """Columns over those of the chip: below 1, pixels are larger than the chip's own."""
        return pixel_scale(self.camera)

    @property
    def simulated_optics(self) -> Optics:
        """The lens, its blur in the pixels that are rendered."""
        table = self.optics.model_dump()
        table["psf_sigma_px"] *= self.pixel_scale
        table["veiling_glare_px"] *= self.pixel_scale
        return Optics(**table)

    @property
    def simulated_detector(self) -> Detector:
        """The chip, with the pixels that are rendered."""
        table = self.detector.model_dump()
        table["pixel_pitch_um"] /= self.pixel_scale
        return Detector(**table, mosaic="rggb" if self.frame_kind == "colour" else "none")

    @property
    def simulated_scatter(self) -> LensScatter:
        """What the lens scatters of the Sun."""
        return LensScatter(**self.lens_scatter.model_dump())

    @property
    def simulated_radiation(self) -> Radiation:
        """The particles that hit the chip."""
        return Radiation(**self.radiation.model_dump())

    @property
    def needs_depth(self) -> bool:
        """Whether a frame is composed from the depth of its pixels, and not from light alone."""
        return self.optics.focus_m > 0.0 or self.stars.shine

    def to_toml(self) -> str:
        """Write the scenario with every default resolved."""
        return tomli_w.dumps(json.loads(self.model_dump_json(exclude_none=True)))

    def fingerprint(self) -> str:
        """Return a hash of everything in it that shapes a dataset."""
        table = self.model_dump(mode="json", exclude=SHAPING_NOTHING, exclude_none=True)
        return hashlib.sha256(json.dumps(table, sort_keys=True).encode()).hexdigest()


@dataclass(frozen=True)
class RenderRequest:
    """A case and the options typed with it.

    Attributes
    ----------
    case : str
        Name of a case, or path of a scenario file.
    out : Path
        Folder of the dataset.
    sun : str, optional
        A name such as S1 or E-S15, or x,y,z.
    rate_hz, start_s, end_s : float, optional
    width : int, optional, px
    spp : int, optional
        Samples per pixel.
    variant : str
        auto, llvm, cuda or scalar.
    seeds : int
        Runs that are meant over the same light; above 1, light that has left the store is
        rendered again even where its frame is there.
    store : Path, optional
        Folder of the radiance store.
    store_budget_gb : float, optional
        What the store may take of the disk; see ``renders.store.budget``.
    keep_light : str
        all, some or none; see ``renders.store.kept_light``.
    keep_every : int, optional
        With ``markers``, frames from one whole frame to the next.
    threads : int, optional
    """

    case: str
    out: Path
    sun: str | None = None
    rate_hz: float | None = None
    start_s: float | None = None
    end_s: float | None = None
    width: int | None = None
    spp: int | None = None
    variant: Literal["auto", "llvm", "cuda", "scalar"] = "auto"
    seeds: int = 1
    store: Path | None = None
    store_budget_gb: float | None = None
    keep_light: Literal["all", "some", "none"] = "all"
    keep_every: int | None = None
    threads: int | None = None


def read_scenario(path: Path) -> Scenario:
    """Read a scenario file, and the files that it names.

    Raises
    ------
    ScenarioError
        If it is not TOML, has an unknown key, or a value of the wrong kind, size or shape; the
        message names file and key.
    """
    try:
        table = read_toml(path, MOST_SCENARIO_BYTES)
    except UnreadableError as error:
        raise ScenarioError(f"{path}: expected a scenario as TOML, got: {cause(error)}") from error
    try:
        scenario = Scenario(**with_files_read(table, path))
    except ValidationError as error:
        raise ScenarioError(explain(str(path), error, Scenario, {})) from error
    return check_scenario(scenario, str(path))


def check_scenario(scenario: Scenario, where: str) -> Scenario:
    """Refuse what no single key can show: an empty span, a Sun that is none, a camera twice."""
    check_motion(scenario, where)
    check_suns(scenario, where)
    check_tumble(scenario, where)
    check_range_finder(scenario, where)
    check_navigation(scenario, where)
    check_orbits(scenario, where)
    check_frames(scenario, where)
    gap = ("the time between images", shortest_gap_ms(scenario))
    if scenario.frame_kind == "pairs":
        gap = ("motion.pair_gap_ms", scenario.motion.pair_gap_ms)
    check_exposure(scenario.exposure, *gap, where)
    check_shutter(scenario, where)
    check_focus(scenario.optics, where)
    check_earth(scenario.earth, where)
    check_stars(scenario.stars, where)
    check_camera(scenario.camera, where)
    check_lens(lambda: scenario.simulated_camera, where)
    check_detector(scenario.simulated_detector, where)
    check_picture(scenario, where)
    if scenario.markers is not None:
        markers_from(scenario.markers, where)
    check_arm(scenario, where)
    check_error_set(scenario, where)
    if scenario.errors is not None:
        scenario = with_error_set(scenario, scenario.errors)
    check_told(scenario, where)
    return scenario


def check_threads(threads: int | None) -> None:
    """Refuse a number of threads that no machine can start.

    Raises
    ------
    ScenarioError
    """
    hint = "leave it out to use all cores"
    check_option("--threads", threads, 1, MOST_THREADS, whole=True, hint=hint)


def resolve(request: RenderRequest) -> Scenario:
    """Read a request's case and apply its options.

    Raises
    ------
    ScenarioError
        If the case, an option, or their combination cannot be used.
    """
    check_threads(request.threads)
    scenario = read_scenario(case_path(request.case))
    motion = {
        key: getattr(request, key)
        for key in ("rate_hz", "start_s", "end_s")
        if getattr(request, key) is not None
    }
    changes: dict[str, dict[str, Any]] = {
        "motion": motion,
        "camera": {} if request.width is None else {_width_key(scenario): request.width},
        "render": {} if request.spp is None else {"samples": request.spp},
        "sun": {} if request.sun is None else {"default": request.sun},
    }
    table = scenario.model_dump()
    for name, values in changes.items():
        table[name].update(values)
    try:
        changed = Scenario(**table)
    except ValidationError as error:
        raise ScenarioError(explain(request.case, error, Scenario, OPTIONS)) from error
    return check_scenario(changed, f"{request.case} with the options given")


def _width_key(scenario: Scenario) -> str:
    """Return the key of [camera] that ``--width`` stands for."""
    return "width" if scenario.camera.preset is not None else "rendered_width"
