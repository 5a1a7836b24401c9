"""What a case calls wrong, and what it asks for: the tables ``[limits]`` and ``[asked]``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from models.reading.fields import Fields
from models.reading.toml_file import read_toml
from renders.scenario.case_files import MOST_SCENARIO_BYTES

LARGEST = 1e9


@dataclass(frozen=True)
class Limits:
    """Beyond which an error is no noise.

    Attributes
    ----------
    wrong_position_m, wrong_attitude_deg : float
    """

    wrong_position_m: float = 1.0
    wrong_attitude_deg: float = 10.0


@dataclass(frozen=True)
class Asked:
    """What a case asks of a pipeline; None where it asks nothing.

    Attributes
    ----------
    median_position_m, median_attitude_deg : float or None
    lost_share : float or None
        Most frames lost, over those from the first pose on.
    wrong_in_a_row : int or None
        Most wrong poses one after another.
    starts_right : float or None
        Least share of the starts without a prior that end right.
    range_share, rate_deg_s, axis_deg, shape_rms_m : float or None
        Of an unknown target: median errors of distance (relative), rate and spin axis over the
        second half, and the root mean square distance of the shape's points from the surface.
    """

    median_position_m: float | None = None
    median_attitude_deg: float | None = None
    lost_share: float | None = None
    wrong_in_a_row: int | None = None
    starts_right: float | None = None
    range_share: float | None = None
    rate_deg_s: float | None = None
    axis_deg: float | None = None
    shape_rms_m: float | None = None


def read_limits(folder: Path) -> Limits:
    """Read a dataset's limits from behind the wall; the usual ones where it tells none.

    Raises
    ------
    DatasetError
        If the scenario cannot be read, or a value cannot be.
    """
    fields = _table(folder, "limits")
    if fields is None:
        return Limits()
    return Limits(
        wrong_position_m=fields.number("wrong_position_m", 0.0, LARGEST),
        wrong_attitude_deg=fields.number("wrong_attitude_deg", 0.0, 180.0),
    )


def read_asked(folder: Path) -> Asked:
    """Read what a dataset's case asks for; nothing where it tells nothing.

    Raises
    ------
    DatasetError
        If the scenario cannot be read, or a value cannot be.
    """
    fields = _table(folder, "asked")
    if fields is None:
        return Asked()

    def perhaps(key: str, take: Callable[..., Any], *span: float) -> Any:
        return take(key, *span) if key in fields else None

    return Asked(
        median_position_m=perhaps("median_position_m", fields.number, 0.0, LARGEST),
        median_attitude_deg=perhaps("median_attitude_deg", fields.number, 0.0, 180.0),
        lost_share=perhaps("lost_share", fields.number, 0.0, 1.0),
        wrong_in_a_row=perhaps("wrong_in_a_row", fields.whole, 0, 1_000_000),
        starts_right=perhaps("starts_right", fields.number, 0.0, 1.0),
        range_share=perhaps("range_share", fields.number, 0.0, LARGEST),
        rate_deg_s=perhaps("rate_deg_s", fields.number, 0.0, LARGEST),
        axis_deg=perhaps("axis_deg", fields.number, 0.0, 180.0),
        shape_rms_m=perhaps("shape_rms_m", fields.number, 0.0, LARGEST),
    )


def _table(folder: Path, name: str) -> Fields | None:
    path = folder / "truth" / "scenario.toml"
    if not path.is_file():
        return None
    fields = Fields(read_toml(path, MOST_SCENARIO_BYTES), path)
    return fields.table(name) if name in fields else None
