"""The scenario's table of two satellites that fly on orbits of their own, one to the other."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from models.errors import ScenarioError
from models.lights.earth import EARTH_RADIUS_KM
from renders.scenario.frame_checks import refuse_what_has_no_effect
from renders.scenario.motion_choice import motion_kind_of
from renders.scenario.sun_choice import EPOCH, epoch_in
from renders.scenario.table import Table, Triple
from renders.scenario.tumble_tables import OrbitTable

if TYPE_CHECKING:
    from renders.scenario.scenario import Scenario

REAL, TWO_BODY = "real", "two_body"
FARTHEST_M = 1e5
Away = Annotated[float, Field(ge=-FARTHEST_M, le=FARTHEST_M)]
Speed = Annotated[float, Field(ge=-1000, le=1000)]
NO_EFFECT: dict[str, tuple[str, ...] | None] = {
    "motion": ("ring_in_target_m", "longitude_deg"),
    "stars": ("zenith_right_ascension_deg", "q_target_from_icrs_wxyz", "rate_in_target_deg_h"),
    "earth": ("direction", "orbit_radius_km"),
}
OF_THE_FIELD = ("degree", "target_mass_kg", "target_area_m2", "chaser_mass_kg", "chaser_area_m2")


class OrbitsTable(Table):
    """An approach of two satellites, each on its own orbit; see ``models.motion.two_orbits``.

    Elements and states are those of time 0, axes of the ICRS, whose z is taken as the Earth's. The
    target's z axis points away from the Earth, its x back along its track; the chaser turns so that
    its camera looks at ``aim_in_target_m``. Earth and stars stand where that has them, and with
    ``sun.default = "epoch"`` the Sun.
    """

    target: OrbitTable = Field(description="the target's elements")
    chaser: OrbitTable | None = Field(
        None, description="the chaser's elements, or chaser_from_target_m in their place"
    )
    chaser_from_target_m: Annotated[tuple[Away, Away, Away], Field(strict=False)] | None = Field(
        None,
        description="from centre of mass to centre of mass; radial, along the track, normal",
    )
    chaser_from_target_m_s: Annotated[tuple[Speed, Speed, Speed], Field(strict=False)] = Field(
        (0.0, 0.0, 0.0), description="its rate in the turning frame"
    )
    field: Literal["real", "two_body"] = Field(
        "real",
        description="real: harmonics of the Earth, Sun, Moon, light and air; two_body: Kepler's",
    )
    degree: int = Field(36, ge=2, le=36, description="of the Earth's gravity field")
    target_mass_kg: float = Field(3800.0, gt=0, le=1e6, description="as air and light meet it")
    target_area_m2: float = Field(50.0, gt=0, le=1e5, description="as air and light meet it")
    chaser_mass_kg: float = Field(1500.0, gt=0, le=1e6, description="as air and light meet it")
    chaser_area_m2: float = Field(15.0, gt=0, le=1e5, description="as air and light meet it")
    aim_in_target_m: Triple | None = Field(
        None, description="what the camera looks at; the middle of the target's markers"
    )
    chaser_com_to_camera_m: float = Field(
        1.5, ge=0, le=100, description="from its centre of mass to the lens, along the boresight"
    )


def check_orbits(scenario: Scenario, where: str) -> None:
    """Refuse orbits without a date, through the Earth, or told twice, and what they decide.

    Raises
    ------
    ScenarioError
        The message names the key.
    """
    table = scenario.orbits
    if table is None:
        return
    if motion_kind_of(scenario) != "approach":
        raise ScenarioError(
            f"{where}: expected [orbits] with an approach, which they are, got motion.kind = "
            f'"{motion_kind_of(scenario)}"; leave out one of them'
        )
    if (table.chaser is None) == (table.chaser_from_target_m is None):
        got = "both" if table.chaser is not None else "neither"
        raise ScenarioError(
            f"{where}: expected either orbits.chaser or orbits.chaser_from_target_m, got {got}"
        )
    if table.chaser is not None and table.chaser_from_target_m_s != (0.0, 0.0, 0.0):
        raise ScenarioError(
            f"{where}: expected orbits.chaser_from_target_m_s with orbits.chaser_from_target_m "
            "alone, got it with orbits.chaser"
        )
    for name in ("target", "chaser"):
        own = getattr(table, name)
        if own is not None and own.a_km * (1.0 - own.e) <= EARTH_RADIUS_KM:
            raise ScenarioError(
                f"{where}: expected orbits.{name}.a_km and e of an orbit outside the Earth, "
                f"{EARTH_RADIUS_KM:g} km, got one with its perigee at "
                f"{own.a_km * (1.0 - own.e):g} km"
            )
    refuse_what_has_no_effect(scenario, NO_EFFECT, "[orbits]", where)
    if table.field == TWO_BODY:
        plain = type(table).model_fields
        for key in OF_THE_FIELD:
            if getattr(table, key) != plain[key].default:
                raise ScenarioError(
                    f"{where}: expected orbits.{key} to be left out with orbits.field = "
                    f'"{TWO_BODY}", where it has no effect, got {getattr(table, key)!r}'
                )
    if table.field == REAL or scenario.sun.default == EPOCH:
        try:
            epoch_in(scenario)
        except ScenarioError as error:
            raise ScenarioError(
                f"{where}: [orbits] need to know where Earth, Sun and Moon are: {error}"
            ) from error
