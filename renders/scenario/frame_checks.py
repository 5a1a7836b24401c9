"""What must agree in a scenario between its frames and its other tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.errors import ScenarioError
from renders.scenario.motion_choice import (
    frame_kind_of,
    motion_kind_of,
    shortest_gap_ms,
    table_motion_of,
    times_of,
)

if TYPE_CHECKING:
    from renders.scenario.scenario import Scenario

PAIRS_ALONE: dict[str, tuple[str, ...] | None] = {
    "lamps": None,
    "prior": None,
    "motion": ("pair_gap_ms",),
    "exposure": ("marker_fill",),
}
"""Tables, or keys of them, that shape image pairs alone: typed with single images they mislead."""
NOT_IN_COLOUR: dict[str, tuple[str, ...] | None] = {"stars": ("shine",), "retroreflector": None}
"""Those that are told for the near infrared alone."""


def check_frames(scenario: Scenario, where: str) -> None:
    """Refuse what has no effect on single images, and exposures that no table gives.

    Raises
    ------
    ScenarioError
        The message names the key.
    """
    mode = scenario.exposure.mode
    if mode == "table":
        _check_exposure_column(scenario, where)
    if frame_kind_of(scenario) == "pairs" or motion_kind_of(scenario) == "tumble":
        return
    in_colour = frame_kind_of(scenario) == "colour"
    if mode == "schedule" and not scenario.exposure.schedule_ms:
        raise ScenarioError(
            f"{where}: expected exposure.mode, of single images, as auto, fixed or table, or as "
            "schedule with exposure.schedule_ms = [[time_s, exposure_ms], ...]; got 'schedule' "
            "without, which reckons with markers"
        )
    unused = {**PAIRS_ALONE, **NOT_IN_COLOUR} if in_colour else PAIRS_ALONE
    kept = {name: keys for name, keys in unused.items() if not (in_colour and name == "prior")}
    refuse_what_has_no_effect(scenario, kept, "colour" if in_colour else "single images", where)


def refuse_what_has_no_effect(
    scenario: Scenario, unused: dict[str, tuple[str, ...] | None], what: str, where: str
) -> None:
    """Refuse tables, or keys of them, that differ from their defaults.

    Parameters
    ----------
    scenario : Scenario
    unused : dict of str to tuple of str or None
        By table: its keys without effect, or None for all.
    what : str
        With which they have none: ``[tumble]``.
    where : str
        The scenario, for the message.

    Raises
    ------
    ScenarioError
        The message names the key.
    """
    for name, keys in unused.items():
        table = getattr(scenario, name)
        plain = type(table)()
        for key in keys or type(table).model_fields:
            if getattr(table, key) != getattr(plain, key):
                raise ScenarioError(
                    f"{where}: expected {name}.{key} to be left out with {what}, where it has "
                    f"no effect, got {getattr(table, key)!r}"
                )


def _check_exposure_column(scenario: Scenario, where: str) -> None:
    if motion_kind_of(scenario) != "poses" or (
        table_motion_of(scenario).table.exposures_ms is None
    ):
        raise ScenarioError(
            f"{where}: expected a table of poses with a column exposure_ms for exposure.mode = "
            '"table", got none'
        )
    gap, gap_ms = "the time between images", shortest_gap_ms(scenario)
    if frame_kind_of(scenario) == "pairs":
        gap, gap_ms = "motion.pair_gap_ms", scenario.motion.pair_gap_ms
    motion = table_motion_of(scenario)
    longest_ms, time_s = max((motion.exposure_ms(time_s), time_s) for time_s in times_of(scenario))
    if longest_ms >= gap_ms:
        raise ScenarioError(
            f"{where}: expected exposure_ms in the table of poses below {gap}, {gap_ms:g} ms, when "
            f"the next exposure begins, got {longest_ms:g} ms at {time_s:g} s"
        )
