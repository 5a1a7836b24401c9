"""Numbers against time that a reader may explore: what a chain gives, and what all share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any, Literal

from bench.scoring.score import shown_labels

Kind = Literal["line", "dots", "band", "bound", "level", "steps"]
Values = Sequence[float | None]


@dataclass(frozen=True)
class TimeLine:
    """One number of every frame.

    Attributes
    ----------
    label : str
    pipeline : str
        Whose it is; empty for what is of none.
    kind : str
        ``line`` or ``dots`` of values; ``band``, shaded, and ``bound``, dashed, on both sides of
        zero; ``level``, dashed, on one; ``steps`` of counts.
    values : sequence of float or None
        By frame.
    """

    label: str
    pipeline: str
    kind: Kind
    values: Values


@dataclass(frozen=True)
class TimePlot:
    """A plot against time.

    Attributes
    ----------
    title, unit : str
    lines : tuple of TimeLine
    """

    title: str
    unit: str
    lines: tuple[TimeLine, ...]

    @property
    def is_empty(self) -> bool:
        """Whether no line has a value at any frame."""
        return all(value is None for line in self.lines for value in line.values)


def values_of(score: dict[str, Any], label: str, *keys: str | int) -> list[float | None]:
    """Return one number of every frame of a pipeline, as ``score.json`` has it.

    Parameters
    ----------
    score : dict
    label : str
        Of the pipeline.
    keys : str or int
        From a frame's row down to the number; None where the way ends.
    """
    found = []
    for row in score["pipelines"][label]["per_frame"]:
        value: Any = row
        for key in keys:
            value = None if value is None else value[key]
        found.append(value)
    return found


def position_unit(score: dict[str, Any]) -> tuple[str, float]:
    """Return the unit of a page's position errors, and what a millimetre is in it.

    Parameters
    ----------
    score : dict

    Returns
    -------
    str, float
        Metres where half of all errors are larger than one.
    """
    there = [
        value
        for label in score["pipelines"]
        for value in values_of(score, label, "position_error_mm")
        if value is not None
    ]
    return ("m", 1e-3) if there and median(there) >= 1000.0 else ("mm", 1.0)


def size_plots(score: dict[str, Any]) -> list[TimePlot]:
    """Plot what every chain knows: the sizes of the errors in position and attitude."""
    length, of_a_millimetre = position_unit(score)
    return [
        TimePlot(
            title,
            unit,
            tuple(
                TimeLine(label, label, "line", _times(factor, values_of(score, label, key)))
                for label in shown_labels(score)
            ),
        )
        for title, unit, key, factor in (
            ("position error", length, "position_error_mm", of_a_millimetre),
            ("attitude error", "deg", "attitude_error_deg", 1.0),
        )
    ]


def _times(factor: float, values: list[float | None]) -> list[float | None]:
    return [None if value is None else factor * value for value in values]
