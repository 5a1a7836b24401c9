"""What moves in a scenario, what its frames are, and when: the choices that its tables leave."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from models.errors import DatasetError, ScenarioError
from models.motion.pose_table import ROUNDING_S, PoseTable, pose_table
from renders.scenario.motion_tables import MotionKind
from renders.scenario.own_target import target_has_dots, target_has_markers

if TYPE_CHECKING:
    from models.motion.table_motion import TableMotion
    from renders.scenario.scenario import Scenario

MOST_FRAMES = 100_000  # over five hours at 5 Hz; a motion of more is a slip
OF_A_TABLE = ("file", "poses", "table")
UNUSED_BY_POSES = ("target_wobble", "ring_in_target_m")
UNUSED_BY_STILLS = ("rate_hz",)


def motion_kind_of(scenario: Scenario) -> MotionKind:
    """Return what moves, typed or not."""
    if scenario.motion.kind is not None:
        return scenario.motion.kind
    if scenario.motion.table is not None:
        return "poses"
    return "approach" if scenario.tumble is None else "tumble"


def frame_kind_of(scenario: Scenario) -> str:
    """Return what a frame is, ``pairs``, ``single`` or ``colour``, typed or not."""
    if scenario.frame is not None:
        return scenario.frame.kind
    kind = motion_kind_of(scenario)
    if kind != "poses":
        return "pairs" if kind == "approach" else "single"
    if scenario.markers is None and target_has_dots(scenario):
        return "colour"
    has_markers = scenario.markers is not None or target_has_markers(scenario)
    return "pairs" if has_markers else "single"


def takes_stills(scenario: Scenario) -> bool:
    """Tell whether each row of a table of poses is a frame."""
    return motion_kind_of(scenario) == "poses" and scenario.motion.poses != "interpolated"


@lru_cache(maxsize=8)
def _read(lines: tuple[str, ...]) -> PoseTable:
    return pose_table(lines, "motion.table")


def table_motion_of(scenario: Scenario) -> TableMotion:
    """Return the motion of a scenario with a table of poses.

    Raises
    ------
    ScenarioError
        If the table cannot be used.
    """
    from models.motion.table_motion import SmoothMotion, Stills  # splines: other motions need none

    assert scenario.motion.table is not None
    try:
        table = _read(scenario.motion.table)
    except DatasetError as error:
        raise ScenarioError(str(error)) from error
    in_pairs = frame_kind_of(scenario) == "pairs"
    gap_s = scenario.motion.pair_gap_ms * 1e-3 if in_pairs else 0.0
    if takes_stills(scenario):
        return Stills(table, gap_s)
    shutter_s = 0.5 * gap_s if in_pairs else 0.5 / scenario.motion.rate_hz
    return SmoothMotion(table, gap_s + shutter_s)


def times_of(scenario: Scenario) -> list[float]:
    """Return the times of the frames, s: middles of the exposures; of a pair, of the 850 nm one."""
    motion = scenario.motion
    if takes_stills(scenario):
        rows_s = table_motion_of(scenario).table.times_s.tolist()
        first, last = motion.start_s - ROUNDING_S, motion.end_s + ROUNDING_S
        return [time_s for time_s in rows_s if first <= time_s <= last]
    count = int((motion.end_s - motion.start_s) * motion.rate_hz + 1e-9) + 1
    return [motion.start_s + number / motion.rate_hz for number in range(count)]


def shortest_gap_ms(scenario: Scenario) -> float:
    """Return the least time from one frame to the next, ms; infinite for one frame of a table."""
    if takes_stills(scenario):
        return float(1e3 * np.diff(times_of(scenario)).min(initial=np.inf))
    return 1e3 / scenario.motion.rate_hz


def check_motion(scenario: Scenario, where: str) -> None:
    """Refuse a motion that is told twice or not at all, and times that cannot be.

    Raises
    ------
    ScenarioError
        The message names the keys.
    """
    motion = scenario.motion
    _check_kind(scenario, where)
    if motion.end_s < motion.start_s:
        raise ScenarioError(
            f"{where}: expected motion.end_s after motion.start_s, "
            f"got {motion.start_s} to {motion.end_s} s"
        )
    if motion_kind_of(scenario) == "poses":
        _check_poses(scenario, where)
    frames = (motion.end_s - motion.start_s) * motion.rate_hz
    if frames >= MOST_FRAMES and not takes_stills(scenario):
        raise ScenarioError(
            f"{where}: expected at most {MOST_FRAMES} frames, got {frames:.3g}: from "
            f"{motion.start_s:g} to {motion.end_s:g} s at {motion.rate_hz:g} Hz; give an earlier "
            "motion.end_s or a lower motion.rate_hz"
        )
    if frame_kind_of(scenario) == "pairs" and motion.pair_gap_ms >= shortest_gap_ms(scenario):
        at = "" if takes_stills(scenario) else f" at {motion.rate_hz:g} Hz"
        raise ScenarioError(
            f"{where}: expected motion.pair_gap_ms below the time between pairs, "
            f"{shortest_gap_ms(scenario):g} ms{at}, got {motion.pair_gap_ms:g} ms"
        )


def _check_kind(scenario: Scenario, where: str) -> None:
    motion, kind = scenario.motion, motion_kind_of(scenario)
    if motion.file is not None:
        raise ScenarioError(
            f"{where}: expected motion.file of a scenario that is read from a file, beside which "
            f"it lies, got {motion.file!r}"
        )
    typed = [key for key in OF_A_TABLE if getattr(motion, key) is not None]
    if kind != "poses" and typed:
        raise ScenarioError(
            f'{where}: expected motion.{typed[0]} with motion.kind = "poses" alone, got it with '
            f'"{kind}"'
        )
    if kind == "poses" and motion.table is None:
        raise ScenarioError(
            f'{where}: expected motion.file, a CSV file of poses, with motion.kind = "poses", '
            "got none"
        )
    if (kind == "tumble") != (scenario.tumble is not None):
        there = "a table [tumble]" if scenario.tumble is not None else "no table [tumble]"
        raise ScenarioError(
            f'{where}: expected a table [tumble] with motion.kind = "tumble" and with no other, '
            f'got "{kind}" and {there}'
        )
    if kind == "tumble" and frame_kind_of(scenario) == "pairs":
        raise ScenarioError(
            f'{where}: expected frame.kind = "single" with [tumble], got "pairs"; a table of poses '
            'takes pairs of any target with markers (motion.kind = "poses")'
        )


def _check_poses(scenario: Scenario, where: str) -> None:
    motion, table = scenario.motion, table_motion_of(scenario).table
    unused = [*UNUSED_BY_POSES, *(UNUSED_BY_STILLS if takes_stills(scenario) else ())]
    _refuse_unused(scenario, unused, where)
    if not takes_stills(scenario) and (
        table.earth_dirs_in_target is not None or table.stars is not None
    ):
        raise ScenarioError(
            f'{where}: expected columns of the Earth and of stars with motion.poses = "stills", '
            "where each row has its own sky, got them in a table that is interpolated; leave them "
            "out"
        )
    first, last = float(table.times_s[0]), float(table.times_s[-1])
    if motion.start_s < first - ROUNDING_S or motion.end_s > last + ROUNDING_S:
        raise ScenarioError(
            f"{where}: expected motion.start_s and end_s within the table of poses, {first:g} to "
            f"{last:g} s, got {motion.start_s:g} to {motion.end_s:g} s; left out, they are its ends"
        )
    if not times_of(scenario):
        raise ScenarioError(
            f"{where}: expected motion.start_s and end_s about a row of the table of poses, got "
            f"{motion.start_s:g} to {motion.end_s:g} s, between two rows"
        )


def _refuse_unused(scenario: Scenario, keys: Sequence[str], where: str) -> None:
    motion = scenario.motion
    for key in keys:
        if getattr(motion, key) != type(motion).model_fields[key].default:
            kind = "stills" if key in UNUSED_BY_STILLS else "poses"
            raise ScenarioError(
                f"{where}: expected motion.{key} to be left out with {kind}, where it has no "
                f"effect, got {getattr(motion, key)!r}"
            )
