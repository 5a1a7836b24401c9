"""What a case asks of a pipeline beside what was measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from bench.scoring.core_score import core_score
from bench.scoring.judgement import Judgement
from bench.scoring.limits import read_asked


@dataclass(frozen=True)
class Check:
    """One thing asked.

    Attributes
    ----------
    what, asked : str
    measured : float or None
    holds : bool or None
        None where there is nothing to judge.
    unit : str
        ``%`` where the number is a share.
    """

    what: str
    asked: str
    measured: float | None
    holds: bool | None
    unit: str


def checks(
    folder: Path, judged: Sequence[Sequence[Judgement]], starts_right: float | None = None
) -> list[Check]:
    """Hold run 0 against what the dataset's case asks for.

    Parameters
    ----------
    folder : Path
        The dataset.
    judged : sequence of sequences of Judgement
    starts_right : float, optional
        Share of the starts without a prior that ended right, where any were tried.
    """
    asked, core = read_asked(folder), core_score(judged, [])
    found: list[Check] = []

    def at_most(what: str, limit: float | None, measured: float | None, unit: str) -> None:
        found.extend(held_at_most(what, limit, measured, unit))

    if asked.starts_right is not None and starts_right is not None:
        text = f"at least {100 * asked.starts_right:g} %"
        holds = starts_right >= asked.starts_right
        found.append(Check("starts acquired rightly", text, starts_right, holds, "%"))
    position_mm = core.position_error_mm.median
    position_m = None if position_mm is None else 1e-3 * position_mm
    at_most("median position error", asked.median_position_m, position_m, "m")
    attitude_deg = core.attitude_error_deg.median
    at_most("median attitude error", asked.median_attitude_deg, attitude_deg, "deg")
    at_most("frames lost once acquired", asked.lost_share, _lost_share(judged[0]), "%")
    longest = float(core.wrong.longest)
    at_most("longest run of wrong poses", asked.wrong_in_a_row, longest, "frames")
    return found


def held_at_most(what: str, limit: float | None, measured: float | None, unit: str) -> list[Check]:
    """Hold a measure against the most that is asked; no check where nothing is asked.

    Parameters
    ----------
    what : str
    limit, measured : float or None
        Shares where the unit is ``%``.
    unit : str
    """
    if limit is None:
        return []
    text = f"{100.0 * limit:g} %" if unit == "%" else f"{limit:g} {unit}"
    holds = None if measured is None else measured <= limit
    return [Check(what, f"at most {text}", measured, holds, unit)]


def _lost_share(judged: Sequence[Judgement]) -> float | None:
    """Return the frames lost over all from the first pose on."""
    first = next((k for k, each in enumerate(judged) if each.position_m is not None), None)
    if first is None:
        return None
    return sum(each.lost for each in judged[first:]) / len(judged[first:])
