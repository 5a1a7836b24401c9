"""The scenario's table of a range finder."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic import Field

from models.errors import ScenarioError
from renders.scenario.table import Table

if TYPE_CHECKING:
    from renders.scenario.scenario import Scenario


class RangeFinderTable(Table):
    """A range finder along the boresight, which reads the surface that it meets.

    Its readings come as the stream ``range_finder``; see ``models.sensors.range_finder``.
    """

    sigma_m: float = Field(0.01, gt=0, le=1e3, description="1-sigma of a right echo")
    rate_hz: float = Field(1.0, gt=0, le=1e6, description="readings; at most one a frame")
    outlier_share: float = Field(0.0, ge=0, le=1, description="of the readings: wrong echoes")
    outlier_span_m: float = Field(
        10.0, gt=0, le=1e6, description="either way, within which a wrong echo is"
    )
    drop_out_share: float = Field(0.0, ge=0, le=1, description="of the readings: none comes")
    footprint_mrad: float = Field(
        0.0, ge=0, le=100, description="half the beam's full angle; 0: a single ray"
    )


def check_range_finder(scenario: Scenario, where: str) -> None:
    """Refuse a range finder where nothing reads it, and an unknown target that is told of.

    Raises
    ------
    ScenarioError
        The message names the table.
    """
    tumble = scenario.tumble
    if scenario.range_finder is not None and tumble is None:
        raise ScenarioError(
            f"{where}: expected [range_finder] with [tumble] alone, got it without; no other "
            "pipeline reads it"
        )
    if tumble is None or tumble.onboard.knows_target is not False or scenario.told is None:
        return
    if scenario.told.target is not None:
        raise ScenarioError(
            f"{where}: expected told.target to be left out where tumble.onboard.knows_target is "
            "false, got one"
        )
