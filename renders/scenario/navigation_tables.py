"""The scenario's table of a chaser that navigates for itself, on a real orbit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from models.errors import ScenarioError
from renders.scenario.sun_choice import epoch_in
from renders.scenario.table import Table

if TYPE_CHECKING:
    from renders.scenario.scenario import Scenario

SENSORS, STATED = "sensors", "stated"
OF_SENSORS = (
    "receive_gain_dbi", "star_rate_hz", "lasting_errors", "start_sigma_m", "start_sigma_m_s",
    "start_sigma_deg", "relative_from_s",
)  # fmt: skip
OF_STATED = ("chaser_sigma_m", "chaser_sigma_m_s")


class NavigationTable(Table):
    """The chaser finds its own orbit and attitude, and both satellites fly in the real field.

    Its sensors come as the streams ``gnss``, ``inertial`` and ``star_attitude``, from time 0 on:
    with ``motion.start_s`` above it the filter has settled at the first image.
    """

    by: Literal["sensors", "stated"] = Field(
        "sensors",
        description="stated: no sensors; the orbit is told, wrong by tumble.onboard.chaser_sigma_m",
    )
    regime: Literal["leo", "geo"] = Field("leo", description="of the receiver and the filter")
    field_degree: int = Field(36, ge=2, le=36, description="of the Earth's gravity field")
    chaser_mass_kg: float = Field(100.0, gt=0, le=1e6, description="as air and light meet it")
    chaser_area_m2: float = Field(1.28, gt=0, le=1e5, description="as air and light meet it")
    target_mass_kg: float = Field(3800.0, gt=0, le=1e6, description="as air and light meet it")
    target_area_m2: float = Field(50.0, gt=0, le=1e5, description="as air and light meet it")
    receive_gain_dbi: float | None = Field(
        None, ge=-10, le=30, description="of the GNSS antenna; 3 in leo and 6 in geo unless typed"
    )
    star_rate_hz: int = Field(5, ge=1, le=100, description="of the star sensor; a divisor of 100")
    lasting_errors: bool = Field(
        False, description="whether errors of ranges last, as real ones do, or are new each second"
    )
    relative_from_s: float | None = Field(
        None,
        ge=0,
        le=1e6,
        description="when it turns to its target; left out: at once",
    )
    start_sigma_m: float = Field(1000.0, ge=0, le=1e5, description="of the start, per axis")
    start_sigma_m_s: float = Field(1.0, ge=0, le=100, description="of the start, per axis")
    start_sigma_deg: float = Field(0.3, ge=0, le=5, description="of the start, per axis")


def check_navigation(scenario: Scenario, where: str) -> None:
    """Refuse a chaser that navigates where nothing flies freely, and keys without effect.

    Raises
    ------
    ScenarioError
        The message names the key.
    """
    table = scenario.navigation
    if table is None:
        return
    if scenario.tumble is None:
        raise ScenarioError(
            f"{where}: expected [navigation] with [tumble] alone, whose chaser is on an orbit; got "
            "it without"
        )
    if scenario.tumble.onboard.knows_target is False:
        raise ScenarioError(
            f"{where}: expected [navigation] with a known target, got "
            "tumble.onboard.knows_target = false; leave one of them out"
        )
    try:
        epoch_in(scenario)
    except ScenarioError as error:
        raise ScenarioError(
            f"{where}: [navigation] needs to know where the Earth has turned to: {error}"
        ) from error
    if 100 % table.star_rate_hz:
        raise ScenarioError(
            f"{where}: expected navigation.star_rate_hz to divide 100, the rate of the gyroscopes, "
            f"got {table.star_rate_hz}"
        )
    if table.by == STATED:
        _refuse(where, "navigation", OF_SENSORS, table, 'navigation.by = "stated"')
    else:
        _refuse(where, "tumble.onboard", OF_STATED, scenario.tumble.onboard, "[navigation]")


def _refuse(where: str, name: str, keys: tuple[str, ...], table: Table, beside: str) -> None:
    for key in keys:
        if getattr(table, key) != type(table).model_fields[key].default:
            raise ScenarioError(
                f"{where}: expected {name}.{key} to be left out with {beside}, where it has no "
                f"effect; got {getattr(table, key)!r}"
            )
