"""The scenario's table of the shutter: whether the camera moves while it is open."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic import Field

from models.errors import ScenarioError
from renders.scenario.motion_choice import shortest_gap_ms, takes_stills
from renders.scenario.table import Table

if TYPE_CHECKING:
    from renders.scenario.scenario import Scenario


LONGEST_FRAME_MS = 1000.0


class ShutterTable(Table):
    """How a frame's rows are exposed; see ``renders.world.shutter``.

    Left out, an image is of one instant, the middle of its exposure.
    """

    blur: bool = Field(False, description="whether the camera moves while a row is exposed")
    row_us: float = Field(
        0.0,
        ge=0,
        le=10_000,
        description="from one row's exposure to the next one's, from the top down, of the rows "
        "that are rendered; 0: all rows at once",
    )


def check_shutter(scenario: Scenario, where: str) -> None:
    """Refuse a moving camera whose light would be traced before it is known how far it moves.

    Raises
    ------
    ScenarioError
        The message names the key.
    """
    table = scenario.shutter
    if table is None or not (table.blur or table.row_us):
        return
    if table.blur and scenario.exposure.mode == "auto":
        raise ScenarioError(
            f"{where}: expected exposure.mode as fixed, schedule or table with shutter.blur, got "
            "'auto': light is traced before an image can be metered, and how far the camera moves "
            "in it must be known by then"
        )
    if takes_stills(scenario):
        raise ScenarioError(
            f"{where}: expected motion.poses as 'interpolated' with [shutter]: stills do not move"
        )
    rows_ms = 1e-3 * table.row_us * (scenario.simulated_camera.height - 1)
    open_ms = scenario.exposure.exposure_ms if scenario.exposure.mode == "fixed" else 0.0
    least_ms = min(
        shortest_gap_ms(scenario),
        scenario.motion.pair_gap_ms if scenario.frame_kind == "pairs" else LONGEST_FRAME_MS,
        LONGEST_FRAME_MS,
    )
    if rows_ms + open_ms >= least_ms:
        raise ScenarioError(
            f"{where}: expected all rows to be read before the next image begins, in "
            f"{least_ms:g} ms; shutter.row_us of {table.row_us:g} takes {rows_ms:.4g} ms over "
            f"{scenario.simulated_camera.height} rows, beside {open_ms:g} ms of exposure"
        )
    for key in ("noise", "paths"):
        if getattr(scenario.render, key):
            raise ScenarioError(
                f"{where}: expected no render.{key} with [shutter], got "
                f"{getattr(scenario.render, key)}; leave it out, and choose render.samples"
            )
