"""The scenario's tables of the camera: which one flies, its lens, its chip, its exposures."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from models.camera import CAMERAS, Camera
from models.errors import ScenarioError
from models.sensors.camera_chip import Detector
from renders.scenario.table import Name, Table

Radial = Annotated[float, Field(ge=-10, le=10)]  # what folds within the image is refused below
Tangential = Annotated[float, Field(ge=-1, le=1)]
PRESET = "chaser_fixed"
OWN = ("file", "height", "fx", "fy", "cx", "cy", "fov_deg", "rendered_width")
"""Keys that tell of a camera of one's own."""
LEAST_LEVELS_DN = 10.0  # from bias to saturation: with fewer there is no picture
MOST_READ_NOISE = 0.1  # of what a pixel can tell


class CameraTable(Table):
    """Which camera flies, as simulated: a preset, or one of your own; see ``camera_choice``."""

    preset: Name | None = Field(
        None, description=f"{', '.join(CAMERAS)}; chaser_fixed where no camera is typed"
    )
    file: Name | None = Field(
        None, description="a camera.toml beside the scenario, for the keys of a camera of your own"
    )
    width: int = Field(2048, ge=64, le=8192, description="columns; the field of view stays")
    height: int | None = Field(None, ge=16, le=8192, description="rows, of a camera of your own")
    fx: float | None = Field(None, ge=1, le=1e6, description="focal length, px of the width typed")
    fy: float | None = Field(None, ge=1, le=1e6, description="fx where left out")
    cx: float | None = Field(
        None, ge=-1e5, le=1e5, description="principal point, px from the middle of the first pixel"
    )
    cy: float | None = Field(
        None, ge=-1e5, le=1e5, description="as cx; the image's middle where either is left out"
    )
    fov_deg: float | None = Field(
        None, ge=0.01, le=170, description="across the width, instead of fx, fy, cx and cy"
    )
    rendered_width: int | None = Field(
        None, ge=64, le=8192, description="columns that are rendered of a camera of your own"
    )
    k1: Radial = Field(0.0, description="radial distortion, r^2: Brown-Conrady, in OpenCV's sense")
    k2: Radial = Field(0.0, description="radial distortion, r^4")
    p1: Tangential = Field(0.0, description="tangential distortion")
    p2: Tangential = Field(0.0, description="tangential distortion")
    k3: Radial = Field(0.0, description="radial distortion, r^6")

    @model_validator(mode="before")
    @classmethod
    def _preset_unless_typed(cls, table: Any) -> Any:
        if isinstance(table, dict) and all(table.get(key) is None for key in ("preset", *OWN)):
            return {**table, "preset": PRESET}
        if isinstance(table, dict) and "width" not in table:
            named = CAMERAS.get(str(table.get("preset")))
            if named is not None and named.width != cls.model_fields["width"].default:
                return {**table, "width": named.width}
        return table


class OpticsTable(Table):
    """The lens; see ``models.sensors.camera_chip.Optics``."""

    f_number: float = Field(
        16.0, ge=0.5, le=1000, description="focal length over aperture; no lens is below 0.5"
    )
    transmission: float = Field(
        0.8, ge=1e-4, le=1, description="of lens and filter, within the passband"
    )
    psf_sigma_px: float = Field(
        0.5, ge=0, le=50, description="1-sigma of the blur, on the chip's own pixel"
    )
    vignetting: bool = Field(
        True, description="whether light falls with the fourth power of the cosine off axis"
    )
    focus_m: float = Field(
        0.0, ge=0, le=1e6, description="depth that is sharp; 0: sharp at any depth"
    )
    veiling_glare: float = Field(0.0, ge=0, le=0.5, description="share of the scene's light")
    veiling_glare_px: float = Field(
        400.0, ge=20, le=1e5, description="how wide, on the chip's own pixel"
    )


class DetectorTable(Table):
    """The chip; see ``models.sensors.camera_chip.Detector``."""

    pixel_pitch_um: float = Field(
        13.5, ge=0.1, le=1000, description="a preset's at 2048 columns; your own camera's as typed"
    )
    quantum_efficiency: float = Field(0.5, ge=1e-4, le=1, description="in the passband")
    prnu: float = Field(
        0.005,
        ge=0,
        le=0.5,
        description="pixel response non-uniformity, 1-sigma, relative; fixed for a chip",
    )
    dark_current_e_s: float = Field(20.0, ge=0, le=1e7, description="of a pixel")
    full_well_e: float = Field(100_000.0, ge=100, le=1e8, description="charge that a pixel holds")
    blooming: float = Field(
        0.0,
        ge=0,
        le=1,
        description="share of the charge beyond it that spills to the pixels above and below",
    )
    read_noise_e: float = Field(12.0, ge=0, le=1e5, description="1-sigma of each reading")
    gain_e_dn: float = Field(26.0, ge=1e-3, le=1e6, description="electrons a number")
    bias_dn: float = Field(100.0, ge=0, le=65_535, description="level without light")
    bits: int = Field(12, ge=8, le=16, description="of the converter")


class LensScatterTable(Table):
    """Sunlight scattered in the lens; see ``models.sensors.lens_scatter``."""

    peak_1_sr: float = Field(
        0.0, ge=0, le=1e6, description="towards the Sun; some 10 for a clean lens"
    )
    shoulder_deg: float = Field(
        0.6, gt=0.01, le=30, description="from the Sun; within it the scatter is level"
    )
    slope: float = Field(2.0, ge=0.01, le=4, description="power with which it falls outside")
    hood_deg: float = Field(
        90.0, ge=0.01, le=90, description="off axis; the hood shades a Sun beyond"
    )
    hood_leak: float = Field(
        0.0, ge=0, le=1, description="share of the scatter that is left behind the hood"
    )


class RadiationTable(Table):
    """Energetic particles; see ``renders.detector.radiation_hits``."""

    flux_cm2_s: float = Field(
        0.0,
        ge=0,
        le=10_000,
        description="through the chip; GEO: 5 at solar minimum, some 3000 in a great flare",
    )
    depth_um: float = Field(
        40.0, ge=0.1, le=1000, description="of the silicon that collects charge"
    )
    charge_e_um: float = Field(106.0, ge=0.1, le=1e6, description="left along a particle's way")


ScheduleRow = Annotated[tuple[float, float], Field(strict=False)]  # s, ms
SHORTEST_MS, LONGEST_MS = 1e-4, 1e5


class ExposureTable(Table):
    """Exposure time; see ``renders.detector.exposure_control``.

    ``schedule``: as ``schedule_ms`` has it, or else proportional to the square of the range by the
    prior, which reckons with markers. ``auto``: the first as given, each other metered from the
    image before it, of a pair from the 850 nm one. ``fixed``: as given. ``table``: that of each row
    of the poses. Of single images what is given is meant for the chip's own pixels; see
    ``renders.world.exposure_plan``.
    """

    mode: Literal["schedule", "auto", "fixed", "table"] = Field(
        "schedule", description="how exposure times are set"
    )
    marker_fill: float = Field(
        0.6, ge=1e-3, le=1, description="schedule: share of full well, on axis"
    )
    exposure_ms: float = Field(
        1.0, ge=1e-4, le=1e5, description="fixed: each frame's; auto: the first's"
    )
    percentile: float = Field(99.9, ge=1, le=100, description="auto: of the levels, is metered")
    percentile_fill: float = Field(0.6, ge=1e-3, le=0.95, description="auto: share of the range")
    max_step: float = Field(2.0, gt=1, le=1000, description="auto: largest factor between frames")
    min_ms: float = Field(0.01, ge=1e-4, le=1e5, description="auto: shortest")
    max_ms: float = Field(20.0, ge=1e-4, le=1e5, description="auto: longest")
    schedule_ms: Annotated[tuple[ScheduleRow, ...], Field(strict=False, max_length=10_000)] = Field(
        (), description="schedule: [time_s, exposure_ms] in order of time, linear between"
    )
    noise_seed: int | None = Field(
        None,
        ge=0,
        le=2**63 - 1,
        description="of the detector's noise, beside run, frame and stream: cases without one "
        "share its draws frame by frame",
    )


NEAREST_FOCUS_M = 0.1  # lenses of this kind focus no nearer; a thin lens never within its f


def check_focus(table: OpticsTable, where: str) -> None:
    """Refuse a focus that no lens has.

    Raises
    ------
    ScenarioError
        The message names the key.
    """
    if 0.0 < table.focus_m < NEAREST_FOCUS_M:
        raise ScenarioError(
            f"{where}: expected optics.focus_m of at least {NEAREST_FOCUS_M:g} m, or 0 for a lens "
            f"that is sharp at any depth, got {table.focus_m:g} m"
        )


def check_exposure(table: ExposureTable, gap: str, gap_ms: float, where: str) -> None:
    """Refuse a shortest exposure above the longest, and exposures that last into the next.

    Parameters
    ----------
    table : ExposureTable
    gap : str
        What the time from one exposure to the next is called.
    gap_ms : float, ms
    where : str

    Raises
    ------
    ScenarioError
        The message names the key.
    """
    check_schedule(table, gap, gap_ms, where)
    if table.mode in ("schedule", "table"):
        return
    longest, key = table.exposure_ms, "exposure_ms"
    if table.mode == "auto":
        if not table.min_ms <= table.exposure_ms <= table.max_ms:
            raise ScenarioError(
                f"{where}: expected exposure.exposure_ms, the first frame's, between "
                f"exposure.min_ms and exposure.max_ms, got {table.exposure_ms:g} with "
                f"{table.min_ms:g} to {table.max_ms:g} ms"
            )
        longest, key = table.max_ms, "max_ms"
    if longest >= gap_ms:
        raise ScenarioError(
            f"{where}: expected exposure.{key} below {gap}, {gap_ms:g} ms, "
            f"when the next exposure begins, got {longest:g} ms"
        )


def check_lens(made: Callable[[], Camera], where: str) -> None:
    """Refuse a camera that cannot be, such as one whose distortion folds the image over.

    Raises
    ------
    ScenarioError
        The message names the file and the keys.
    """
    try:
        made()
    except ScenarioError as error:
        raise ScenarioError(f"{where}: {error}") from error


def check_detector(detector: Detector, where: str) -> None:
    """Refuse electronics that leave no picture: all bias, all noise, or fewer than ten levels.

    Parameters
    ----------
    detector : Detector
        As typed, or of a file.
    where : str

    Raises
    ------
    ScenarioError
        The message names the keys.
    """
    levels_dn = detector.saturation_dn - detector.bias_dn
    if levels_dn < LEAST_LEVELS_DN:
        raise ScenarioError(
            f"{where}: expected detector.bias_dn, full_well_e, gain_e_dn and bits to leave at "
            f"least {LEAST_LEVELS_DN:g} DN between bias and saturation, got {levels_dn:.3g} with "
            f"a bias of {detector.bias_dn:g} DN, a full well of {detector.full_well_e:g} e at "
            f"{detector.gain_e_dn:g} e/DN, and {detector.max_dn} the largest number"
        )
    told_e = levels_dn * detector.gain_e_dn
    if detector.read_noise_e > MOST_READ_NOISE * told_e:
        raise ScenarioError(
            f"{where}: expected detector.read_noise_e of at most a tenth of what a pixel can tell, "
            f"{told_e:.3g} e between bias and saturation, got {detector.read_noise_e:g} e"
        )


def check_schedule(table: ExposureTable, gap: str, gap_ms: float, where: str) -> None:
    """Refuse typed exposure times that are out of order, cannot be, or have no effect.

    Parameters
    ----------
    table, gap, gap_ms, where
        As of ``check_exposure``.

    Raises
    ------
    ScenarioError
        The message names the key.
    """
    rows = table.schedule_ms
    if not rows:
        return
    for key, plain in (("mode", "schedule"), ("marker_fill", ExposureTable().marker_fill)):  # type: ignore[call-arg]
        if getattr(table, key) != plain:
            raise ScenarioError(
                f"{where}: expected exposure.{key} as {plain!r}, or left out, with "
                f"exposure.schedule_ms, which sets every exposure; got {getattr(table, key)!r}"
            )
    for (before_s, _), (after_s, _) in pairwise(rows):
        if not after_s > before_s:
            raise ScenarioError(
                f"{where}: expected exposure.schedule_ms in order of time, each instant once, "
                f"got {after_s:g} s after {before_s:g} s"
            )
    for time_s, exposure_ms in rows:
        if not SHORTEST_MS <= exposure_ms <= LONGEST_MS or exposure_ms >= gap_ms:
            raise ScenarioError(
                f"{where}: expected exposures in exposure.schedule_ms of at least "
                f"{SHORTEST_MS:g} ms and below {gap}, {min(gap_ms, LONGEST_MS):g} ms, when the "
                f"next exposure begins, got {exposure_ms:g} ms at {time_s:g} s"
            )
