"""The tables of a scenario that tell of lights, and of what the markers return of them."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from models.errors import ScenarioError
from models.lights.earth import ALBEDO, EARTH_RADIUS_KM, GEO_RADIUS_KM
from models.lights.sun import unit_direction
from models.lights.sun_names import SUN_NAMES
from renders.scenario.table import Name, Table, Triple


class LampsTable(Table):
    """The 800 and 850 nm LED rings; see ``models.lights.led_beam``."""

    intensity_w_sr: float = Field(
        12.0, ge=1e-6, le=1e6, description="on axis, all LEDs of a wavelength"
    )
    count: int = Field(8, ge=1, le=64, description="LEDs of a wavelength")
    radius_m: float = Field(0.03, ge=1e-4, le=0.05, description="of the ring about the lens")
    half_intensity_deg: float = Field(
        25.0, ge=0.1, lt=90, description="off axis; where the intensity has fallen to half"
    )


class SunTable(Table):
    """Where the Sun stands; see ``renders.scenario.sun_choice``."""

    default: Name = Field(
        "S2", description=f'{SUN_NAMES}, a vector such as "0.2,-0.5,1", "table" or "epoch"'
    )
    shared: Annotated[tuple[Name, ...], Field(strict=False, max_length=1000)] = Field(
        (), description="Suns rendered in one pass with any other"
    )


class RetroreflectorTable(Table):
    """The effective retroreflective disc; see ``renders.tracing.retroreflector``."""

    half_angle_deg: float = Field(2.0, gt=0.2, lt=10, description="of the lobe that goes back")
    returned_850: float = Field(0.6, ge=0, le=1, description="share of 850 nm light that goes back")
    returned_800: float = Field(
        0.002, ge=0, le=1, description="share of 800 nm light that goes back"
    )


class EarthTable(Table):
    """The Earth behind or beside the target; see ``models.lights.earth``."""

    shines: bool = Field(False, description="whether it lights the target and is seen")
    direction: Triple = Field(
        (0.0, 0.0, -1.0), description="towards its centre, target frame; length does not matter"
    )
    orbit_radius_km: float = Field(
        GEO_RADIUS_KM, gt=EARTH_RADIUS_KM, le=1e6, description="from its centre to the target"
    )
    albedo: float = Field(ALBEDO, ge=0, le=1, description="share of sunlight that it returns")


class FloodlightTable(Table):
    """A lamp on the chaser, in the camera's passband, for a target without markers."""

    intensity_w_sr: float = Field(0.0, ge=0, le=1e6, description="on axis; 0 is off")
    centre_in_cam: Triple = Field((0.3, 0.0, 0.0), description="its middle, m, camera axes")
    radius_m: float = Field(0.03, ge=1e-4, le=0.5, description="of its ring of LEDs")
    count: int = Field(8, ge=1, le=64, description="LEDs")
    half_intensity_deg: float = Field(
        25.0, ge=0.1, lt=90, description="off axis; where the intensity has fallen to half"
    )


def check_earth(table: EarthTable, where: str) -> None:
    """Refuse an Earth in no direction.

    Raises
    ------
    ScenarioError
    """
    try:
        unit_direction(table.direction)
    except ScenarioError as error:
        raise ScenarioError(
            f"{where}: expected earth.direction of three numbers, not all zero, "
            f"got {list(table.direction)}"
        ) from error
