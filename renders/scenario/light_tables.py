"""The tables of a scenario that tell of lights beside the Sun and the pair's lamps."""

from __future__ import annotations

from pydantic import Field

from models.errors import ScenarioError
from models.lights.earth import ALBEDO, EARTH_RADIUS_KM, GEO_RADIUS_KM
from models.lights.sun import unit_direction
from renders.scenario.table import Table, Triple


class EarthTable(Table):
    """The Earth behind or beside the target; see ``models.lights.earth``."""

    shines: bool = Field(False, description="whether it lights the target and is seen")
    direction: Triple = Field(
        (0.0, 0.0, -1.0), description="towards its centre, target frame; length does not matter"
    )
    orbit_radius_km: float = Field(GEO_RADIUS_KM, gt=EARTH_RADIUS_KM, le=1e6)
    albedo: float = Field(ALBEDO, ge=0, le=1)


class FloodlightTable(Table):
    """A lamp on the chaser, in the camera's passband, for a target without markers."""

    intensity_w_sr: float = Field(0.0, ge=0, le=1e6, description="on axis; 0 is off")
    centre_in_cam: Triple = Field((0.3, 0.0, 0.0), description="m")
    radius_m: float = Field(0.03, ge=1e-4, le=0.5)
    count: int = Field(8, ge=1, le=64)
    half_intensity_deg: float = Field(25.0, ge=0.1, lt=90)


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
