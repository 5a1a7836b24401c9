"""A scenario: a TOML file read into frozen tables that refuse unknown keys, and its options.

A case such as ``maxar-approach`` is a scenario that ships with the bench; a path to a TOML file
works wherever a case's name does. Every default is written out beside the output.
"""

from __future__ import annotations

import difflib
import hashlib
import json
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import tomli_w
from pydantic import Field, NonNegativeFloat, ValidationError

from models.camera import Camera, camera_preset
from models.errors import ScenarioError, cause
from models.lights.sun import sun_direction
from models.sensors.camera_chip import Detector, Optics, Radiation
from models.sensors.lens_scatter import LensScatter
from renders.scenario.camera_tables import (
    CameraTable,
    DetectorTable,
    ExposureTable,
    LensScatterTable,
    OpticsTable,
    RadiationTable,
    check_exposure,
    check_focus,
)
from renders.scenario.errors import explain
from renders.scenario.light_tables import EarthTable, FloodlightTable, check_earth
from renders.scenario.sky_tables import StarsTable, check_stars
from renders.scenario.table import Table
from renders.scenario.tumble_tables import TumbleTable, check_tumble

CASES = Path(__file__).resolve().parents[2] / "bench" / "cases"
OPTIONS = {
    "motion.rate_hz": "--rate-hz",
    "motion.start_s": "--span-s (its start)",
    "motion.end_s": "--span-s (its end)",
    "camera.width": "--width",
    "render.samples": "--spp",
    "sun.default": "--sun",
}
"""Which option stands for which key."""


class LampsTable(Table):
    """The 800 and 850 nm LED rings; see ``models.lights.led_beam``."""

    intensity_w_sr: float = Field(12.0, gt=0, description="on axis, all LEDs of a wavelength")
    count: int = Field(8, ge=1, le=64)
    radius_m: float = Field(0.03, gt=0, le=0.05)
    half_intensity_deg: float = Field(25.0, gt=0, lt=90)


class SunTable(Table):
    """Where the Sun stands: S1 to S7, or a vector x,y,z in the target frame.

    With ``[tumble]`` a vector in the inertial frame of the orbit.
    """

    default: str = Field("S2", description='S1 to S7, or a vector such as "0.2,-0.5,1"')
    shared: tuple[str, ...] = Field((), description="Suns rendered in one pass with any other")


class RetroreflectorTable(Table):
    """The effective retroreflective disc; see ``renders.tracing.retroreflector``."""

    half_angle_deg: float = Field(2.0, gt=0.2, lt=10)
    returned_850: float = Field(0.6, ge=0, le=1)
    returned_800: float = Field(0.002, ge=0, le=1)


class MotionTable(Table):
    """The approach and its clock, or that of ``[tumble]``; see ``models.motion.approach``."""

    start_s: float = Field(0.0, ge=0)
    end_s: float = Field(330.0, gt=0)
    rate_hz: float = Field(5.0, gt=0, le=15, description="pose rate; a pair is 33 ms apart")
    pair_gap_ms: float = Field(33.0, gt=0, description="800 nm exposure before the 850 nm one")
    target_wobble: bool = Field(True, description="attitude motion of the stabilised target")


class RenderTable(Table):
    """How light is traced."""

    samples: int = Field(16, ge=1, le=4096, description="per pixel; best a power of two")
    marker_samples: int = Field(4096, ge=1, description="per pixel in the marker windows")
    max_depth: int = Field(4, ge=1, le=32, description="surface interactions of a path")
    seed: int = Field(1, ge=0)


class PriorTable(Table):
    """1-sigma of the first pose, Opromolla 2022 Table 5."""

    sigma_t_m: tuple[NonNegativeFloat, NonNegativeFloat, NonNegativeFloat] = (0.017, 0.017, 0.05)
    sigma_euler_deg: tuple[NonNegativeFloat, NonNegativeFloat, NonNegativeFloat] = (1.0, 1.0, 1.0)


class CalibrationTable(Table):
    """1-sigma of the calibrated camera against the simulated one; zero is exact."""

    sigma_focal_px: float = Field(0.0, ge=0)
    sigma_principal_point_px: float = Field(0.0, ge=0)


class Scenario(Table):
    """Everything that shapes a dataset: of image pairs, or of single images if it tumbles."""

    name: str
    description: str = ""
    target: str = "maxar1300"
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
    prior: PriorTable = PriorTable()
    calibration: CalibrationTable = CalibrationTable()  # type: ignore[call-arg]
    tumble: TumbleTable | None = Field(None, description="a free target, without markers")

    @property
    def times_s(self) -> list[float]:
        """Middles of the exposures, s; of a pair, of the 850 nm one."""
        span = self.motion.end_s - self.motion.start_s
        count = int(span * self.motion.rate_hz + 1e-9) + 1
        return [self.motion.start_s + number / self.motion.rate_hz for number in range(count)]

    @property
    def simulated_camera(self) -> Camera:
        """The camera that renders."""
        table = self.camera
        camera = camera_preset(table.preset).resized(table.width)
        coefficients = {name: getattr(table, name) for name in ("k1", "k2", "p1", "p2", "k3")}
        return Camera(
            camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, **coefficients
        )

    @property
    def pixel_scale(self) -> float:
        """Columns over those of the preset: below 1, pixels are larger than the chip's own."""
        return self.camera.width / camera_preset(self.camera.preset).width

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
        return Detector(**table)

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
        """Return a hash of everything in it but its prose."""
        table = self.model_dump(mode="json", exclude={"description"}, exclude_none=True)
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
        S1 to S7 or x,y,z.
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
        all, markers or none; see ``renders.store.kept_light``.
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
    keep_light: Literal["all", "markers", "none"] = "all"
    keep_every: int | None = None
    threads: int | None = None


def case_names() -> list[str]:
    """Return the names of the cases that ship with the bench."""
    return sorted(path.stem for path in CASES.glob("*.toml"))


def case_path(case: str) -> Path:
    """Return the file of a case, by name or path.

    Raises
    ------
    ScenarioError
        If there is none; the message lists the cases and suggests the nearest.
    """
    path = CASES / f"{case}.toml"
    if path.is_file() and "/" not in case:
        return path
    if case.endswith(".toml"):
        if Path(case).is_file():
            return Path(case)
        raise ScenarioError(f"expected a scenario file at {case}, found none")
    near = difflib.get_close_matches(case, case_names(), n=1)
    hint = f"; perhaps you meant {near[0]}" if near else ""
    raise ScenarioError(
        f"expected a case among {', '.join(case_names())}, or a path to a .toml file, "
        f"got {case!r}{hint}"
    )


def read_scenario(path: Path) -> Scenario:
    """Read a scenario file.

    Raises
    ------
    ScenarioError
        If it is not TOML, has an unknown key, or a value of the wrong kind, size or shape; the
        message names file and key.
    """
    try:
        table = tomllib.loads(path.read_text())
    except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ScenarioError(f"{path}: expected a scenario as TOML, got: {cause(error)}") from error
    try:
        scenario = Scenario(**table)
    except ValidationError as error:
        raise ScenarioError(explain(str(path), error, Scenario, {})) from error
    return check_scenario(scenario, str(path))


def check_scenario(scenario: Scenario, where: str) -> Scenario:
    """Refuse what no single key can show: an empty span, a Sun that is none, odd samples."""
    motion = scenario.motion
    in_pairs = scenario.tumble is None
    if in_pairs and motion.pair_gap_ms * motion.rate_hz >= 1e3:
        raise ScenarioError(
            f"{where}: expected motion.pair_gap_ms below the time between pairs, "
            f"{1e3 / motion.rate_hz:g} ms at {motion.rate_hz:g} Hz, got {motion.pair_gap_ms:g} ms"
        )
    if motion.end_s < motion.start_s:
        raise ScenarioError(
            f"{where}: expected motion.end_s after motion.start_s, "
            f"got {motion.start_s} to {motion.end_s} s"
        )
    check_tumble(scenario, where)
    gap = ("motion.pair_gap_ms", motion.pair_gap_ms)
    if not in_pairs:
        gap = ("the time between images", 1e3 / motion.rate_hz)
    check_exposure(scenario.exposure, *gap, where)
    check_focus(scenario.optics, where)
    check_earth(scenario.earth, where)
    check_stars(scenario.stars, where)
    for name in (scenario.sun.default, *scenario.sun.shared):
        sun_direction(name)
    camera_preset(scenario.camera.preset)
    return scenario


def resolve(request: RenderRequest) -> Scenario:
    """Read a request's case and apply its options.

    Raises
    ------
    ScenarioError
        If the case, an option, or their combination cannot be used.
    """
    if request.threads is not None and request.threads < 1:
        raise ScenarioError(
            f"expected --threads of at least 1, got {request.threads}; "
            "leave it out to use all cores"
        )
    scenario = read_scenario(case_path(request.case))
    motion = {
        key: getattr(request, key)
        for key in ("rate_hz", "start_s", "end_s")
        if getattr(request, key) is not None
    }
    changes: dict[str, dict[str, Any]] = {
        "motion": motion,
        "camera": {} if request.width is None else {"width": request.width},
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
