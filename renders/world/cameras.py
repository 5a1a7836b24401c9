"""The camera's streams: which images one frame has, when, and with what lamps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from models.camera import Camera
from models.dataset.description import INDEX
from models.errors import ScenarioError
from models.frame import IMAGE, IMAGE_800, IMAGE_850
from models.lights.led_beam import LedRing
from renders.detector.expose import SUNLIGHT_NM
from renders.scenario.scenario import Scenario
from renders.tracing.light_groups import NIR800, NIR850, SUNLIGHT, LampGroup, LightGroup
from renders.world.colour_light import in_each_colour
from renders.world.exposure import FILTERED, Exposure, band_suffix

BANDS = (800, 850)


@dataclass(frozen=True)
class ImageStream:
    """The images of one band.

    Attributes
    ----------
    name : str
    band : int
        800, 850 or ``FILTERED``.
    offset_s : float, s
        Middle of its exposure minus the frame's time.
    floodlights : tuple of LampGroup
        Lamps that shine on every exposure.
    own_lamps : LampGroup or None
        Those that shine on its exposures alone.
    """

    name: str
    band: int
    offset_s: float = 0.0
    floodlights: tuple[LampGroup, ...] = ()
    own_lamps: LampGroup | None = None

    @property
    def files(self) -> str:
        """Path of its images in a dataset."""
        return f"frames/{INDEX}{band_suffix(self.band)}.png"

    @property
    def lamps(self) -> list[LampGroup]:
        """Every lamp that shines on its exposures."""
        return [*self.floodlights, *([] if self.own_lamps is None else [self.own_lamps])]


@dataclass(frozen=True)
class ImagingSensor:
    """A camera with its streams.

    Attributes
    ----------
    camera : Camera
        That renders.
    streams : tuple of ImageStream
        In order of time; the last meters the next frame's exposure.
    in_colour : bool
        Whether its chip lies behind Bayer's filters.
    """

    camera: Camera
    streams: tuple[ImageStream, ...]
    in_colour: bool = False

    @cached_property
    def bands(self) -> tuple[int, ...]:
        """The exposures of one frame, in order of time."""
        return tuple(stream.band for stream in self.streams)

    def stream(self, band: int) -> ImageStream:
        """Return the stream of a band."""
        return self.streams[self.bands.index(band)]

    def seen(self, groups: Sequence[LightGroup]) -> list[LightGroup]:
        """Return groups as it sees them: whole, or each in its three colours."""
        if not self.in_colour:
            return list(groups)
        return [part for group in groups for part in in_each_colour(group)]

    def lamps(self, band: int) -> LampGroup:
        """Return the lamps of a band alone.

        Raises
        ------
        ScenarioError
            If it has none.
        """
        lamps = self.stream(band).own_lamps
        if lamps is None:
            raise ScenarioError("expected a camera with lamps for its markers, this one has none")
        return lamps

    def exposures(self, frame: int, time_s: float) -> list[Exposure]:
        """Return the exposures of a frame, in order of time."""
        return [Exposure(frame, each.band, time_s + each.offset_s) for each in self.streams]


def pair_camera(scenario: Scenario) -> ImagingSensor:
    """Return the camera of image pairs: 800 nm, then 850 nm, each with its ring of lamps."""
    lit, gap_s = floodlights(scenario), scenario.motion.pair_gap_ms * 1e-3
    return ImagingSensor(
        scenario.simulated_camera,
        (
            ImageStream(IMAGE_800, 800, -gap_s, lit, lamps_of_band(scenario, 800)),
            ImageStream(IMAGE_850, 850, 0.0, lit, lamps_of_band(scenario, 850)),
        ),
    )


def single_camera(scenario: Scenario) -> ImagingSensor:
    """Return the camera of single images: all that its filter passes, a floodlight or none."""
    stream = ImageStream(IMAGE, FILTERED, floodlights=floodlights(scenario))
    return ImagingSensor(scenario.simulated_camera, (stream,))


def colour_camera(scenario: Scenario) -> ImagingSensor:
    """Return the camera of single images in colour, with an illuminator or none."""
    stream = ImageStream(IMAGE, FILTERED, floodlights=floodlights(scenario))
    return ImagingSensor(scenario.simulated_camera, (stream,), in_colour=True)


def lamps_of_band(scenario: Scenario, band: int) -> LampGroup:
    """Return the lamps of 800 or 850 nm; the two rings interleave."""
    table = scenario.lamps
    half_step_deg = 180.0 / table.count
    ring = LedRing(
        wavelength_nm=float(band),
        intensity_w_sr=table.intensity_w_sr,
        count=table.count,
        radius_m=table.radius_m,
        phase_deg=half_step_deg if band == 850 else 0.0,
        half_intensity_deg=table.half_intensity_deg,
    )
    return LampGroup(f"lamps_{band}", ring, NIR850 if band == 850 else NIR800)


def floodlights(scenario: Scenario) -> tuple[LampGroup, ...]:
    """Return the floodlight, if the scenario has one."""
    table = scenario.floodlight
    if table.intensity_w_sr <= 0.0:
        return ()
    ring = LedRing(
        wavelength_nm=SUNLIGHT_NM,
        intensity_w_sr=table.intensity_w_sr,
        count=table.count,
        radius_m=table.radius_m,
        half_intensity_deg=table.half_intensity_deg,
        centre_in_cam=table.centre_in_cam,
    )
    return (LampGroup("floodlight", ring, SUNLIGHT),)
