"""The table of a sweep: a row for each pose, Sun, exposure, lamp power and pipeline.

``sweep.csv`` and ``sweep.json`` hold the same numbers with all their digits; the unit stands in
the name of the column. An empty cell, or null, is a number that there is not: without a pose there
is no error.
"""

from __future__ import annotations

import csv
import io
import json
import re
import sys
import types
import typing
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np

from bench.scoring.judgement import Judgement
from models.arrays import Floats
from models.errors import DatasetError, cause
from models.estimate import Estimate
from models.lights.sun_grid import NamedSun
from models.reading import csv_table
from models.reading.bounds import MOST_PROSE
from models.reading.fields import Fields
from models.reading.json_file import read_json_table
from models.reading.regular_file import read_lines

TABLE_FORMAT, TABLE_VERSION = "rvbench-sweep", 3
LARGEST = sys.float_info.max  # any number that is one
MOST_COUNTED = 1_000_000

Verdict: TypeAlias = Literal["all found", "some missed", "wrong pose", "no pose"]
VERDICTS: tuple[Verdict, ...] = ("all found", "some missed", "wrong pose", "no pose")
SATURATED = re.compile(r"saturated_(?P<stream>[a-z][a-z0-9_]*)_percent")


@dataclass(frozen=True)
class Row:
    """What one pipeline made of one shot.

    Attributes
    ----------
    sun : str
        Its name, or azimuth/elevation in deg.
    azimuth_deg, elevation_deg : float, deg
        Of the Sun, target frame; see ``models.lights.sun_grid``.
    sun_text : str
        What ``--sun`` reads as this direction to the bit.
    time_s, range_m : float, s and m
        The pose: its moment, and from the camera to the ring's centre.
    exposure_ms, lamp_w_sr : float, ms and W/sr
    pipeline : str
    verdict : str
        ``all found``: a pose, with every expected marker truly found; ``some missed``: a pose
        without; ``wrong pose``: one beyond its covariance and the case's limits; ``no pose``.
    expected, found, mismatched, used : int
        Markers that are truly whole, lit and in the image (or landmarks that show); those of them
        truly found; matches that are not true; markers that the solver kept.
    in_sun : int
        Markers that the Sun lights at least half (or landmarks that it reaches).
    position_error_mm, attitude_error_deg : float or None, mm and deg
    position_sigma_mm : float or None, mm
        How far off the pipeline expects to be, 1-sigma in all three axes together: it follows from
        the markers found and the noise measured, and not from one draw of it.
    error_x_mm, error_y_mm, error_z_mm : float or None, mm
        Along the camera's axes.
    reason : str
        Why there is no pose.
    draws : int
        How often detector noise, first pose and what is told were drawn, this row the first time.
    draws_without_pose, draws_wrong : int
        Draws that gave no pose, or a wrong one.
    draws_found : int
        Markers truly found, all draws together.
    position_rms_mm, position_least_mm, position_most_mm : float or None, mm
        Root mean square, least and largest error of the draws with a pose.
    attitude_rms_deg : float or None, deg
    saturated_percent : dict of str to float, %
        Of the pixels, by image stream; in a table the columns ``saturated_STREAM_percent``.
    """

    sun: str
    azimuth_deg: float
    elevation_deg: float
    sun_text: str
    time_s: float
    range_m: float
    exposure_ms: float
    lamp_w_sr: float
    pipeline: str
    verdict: Verdict
    expected: int
    found: int
    mismatched: int
    used: int
    in_sun: int
    position_error_mm: float | None
    attitude_error_deg: float | None
    position_sigma_mm: float | None
    error_x_mm: float | None
    error_y_mm: float | None
    error_z_mm: float | None
    reason: str
    draws: int
    draws_without_pose: int
    draws_wrong: int
    draws_found: int
    position_rms_mm: float | None
    position_least_mm: float | None
    position_most_mm: float | None
    attitude_rms_deg: float | None
    saturated_percent: dict[str, float]

    @property
    def harshness(self) -> tuple[float, ...]:
        """What orders rows from kind to harsh: no pose, a wrong one, markers missed, the error.

        All of it in the mean over the draws. The error of a single draw orders nothing: then the
        one that the pipeline expects stands for it.
        """
        lost, wrong = 2.0 * self.draws_without_pose / self.draws, self.draws_wrong / self.draws
        missed = self.expected - self.draws_found / self.draws
        if self.position_rms_mm is None:
            return (lost + wrong, missed, -float(self.used))
        size_mm = self.position_sigma_mm if self.draws == 1 else self.position_rms_mm
        return (lost + wrong, missed, np.inf if size_mm is None else size_mm)


@dataclass(frozen=True)
class Setting:
    """A pose, exposure and lamp power: what one Sun map is of."""

    time_s: float
    range_m: float
    exposure_ms: float
    lamp_w_sr: float

    @property
    def title(self) -> str:
        """Return it as a reader reads it."""
        lamps = f", lamps of {self.lamp_w_sr:.3g} W/sr" if self.lamp_w_sr else ""
        return f"{self.range_m:.2f} m, {self.exposure_ms:.3g} ms{lamps}"


def saturated(row: Row) -> float:
    """Return the share of saturated pixels in the last image, %."""
    return list(row.saturated_percent.values())[-1]


def setting_of(row: Row) -> Setting:
    """Return the setting of a row."""
    return Setting(row.time_s, row.range_m, row.exposure_ms, row.lamp_w_sr)


def judged_row(
    sun: NamedSun,
    setting: Setting,
    pipeline: str,
    judged: Judgement,
    along_m: Floats | None,
    saturated_percent: dict[str, float],
    again: Sequence[Judgement] = (),
) -> Row:
    """Return the row of one judged estimate.

    Parameters
    ----------
    sun : NamedSun
    setting : Setting
    pipeline : str
    judged : Judgement
    along_m : (3,) array or None, m
        Estimate minus truth along the camera's axes.
    saturated_percent : dict of str to float
        Of all pixels, by image stream.
    again : sequence of Judgement
        Of the other draws.
    """
    counts = judged.counts
    silent = judged.estimate.detections is None  # what it found is not told: its pose alone counts
    verdict: Verdict = "all found" if silent or counts.found == counts.expected else "some missed"
    if judged.position_m is None:
        verdict = "no pose"
    elif judged.wrong:
        verdict = "wrong pose"
    along_mm = [None] * 3 if along_m is None else [1e3 * float(x) for x in along_m]
    return Row(
        sun=sun.name,
        azimuth_deg=sun.azimuth_deg,
        elevation_deg=sun.elevation_deg,
        sun_text=sun.text,
        **asdict(setting),
        pipeline=pipeline,
        verdict=verdict,
        expected=counts.expected,
        found=counts.found,
        mismatched=counts.mismatched,
        used=counts.used,
        in_sun=counts.in_sun,
        position_error_mm=None if judged.position_m is None else 1e3 * judged.position_m,
        attitude_error_deg=judged.attitude_deg,
        position_sigma_mm=_sigma_mm(judged.estimate),
        error_x_mm=along_mm[0],
        error_y_mm=along_mm[1],
        error_z_mm=along_mm[2],
        reason=judged.estimate.reason or "",
        **_over_draws([judged, *again]),
        saturated_percent=saturated_percent,
    )


def _over_draws(drawn: Sequence[Judgement]) -> dict[str, Any]:
    errors_mm = [1e3 * each.position_m for each in drawn if each.position_m is not None]
    turns_deg = [each.attitude_deg for each in drawn if each.attitude_deg is not None]
    return {
        "draws": len(drawn),
        "draws_without_pose": sum(each.position_m is None for each in drawn),
        "draws_wrong": sum(each.position_m is not None and each.wrong for each in drawn),
        "draws_found": sum(each.counts.found for each in drawn),
        "position_rms_mm": _rms(errors_mm),
        "position_least_mm": min(errors_mm, default=None),
        "position_most_mm": max(errors_mm, default=None),
        "attitude_rms_deg": _rms(turns_deg),
    }


def _rms(values: Sequence[float]) -> float | None:
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else None


def _flat(row: Row) -> dict[str, Any]:
    """Return a row by column: each stream's saturation is one."""
    values = asdict(row)
    saturated = values.pop("saturated_percent")
    return {**values, **{f"saturated_{name}_percent": x for name, x in saturated.items()}}


def _sigma_mm(estimate: Estimate) -> float | None:
    if estimate.pose is None or estimate.pose.covariance is None:
        return None
    variance_m2 = float(np.trace(estimate.pose.covariance[3:, 3:]))
    return 1e3 * variance_m2**0.5 if 0.0 <= variance_m2 < np.inf else None


def to_csv(rows: list[Row]) -> str:
    """Return the text of ``sweep.csv``."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    flat = [_flat(row) for row in rows]
    header = list(flat[0]) if flat else PLAIN_COLUMNS
    writer.writerow(header)
    for values in flat:
        cells = (values[name] for name in header)
        writer.writerow(
            ["" if x is None else repr(x) if isinstance(x, float) else x for x in cells]
        )
    return text.getvalue()


def read_csv(path: Path) -> list[Row]:
    """Read ``sweep.csv`` back.

    Raises
    ------
    DatasetError
        If it is missing, or a column or number of it is.
    """
    try:
        header = "".join(read_lines(path)[:1]).split(",") if path.is_file() else []
        saturated = [name for name in header if SATURATED.fullmatch(name)]
        return [_row(each) for each in csv_table.read_csv(path, [*PLAIN_COLUMNS, *saturated])]
    except DatasetError as error:
        raise DatasetError(
            f"expected the table of a sweep at {path}, got: {cause(error)}; sweep again: only what "
            "is missing is done"
        ) from error


def to_json(rows: list[Row], about: dict[str, Any]) -> str:
    """Return the text of ``sweep.json``: what was swept, and the rows."""
    table = {
        "format": TABLE_FORMAT,
        "version": TABLE_VERSION,
        **about,
        "rows": [_flat(row) for row in rows],
    }
    return json.dumps(table, indent=1, allow_nan=False) + "\n"


def read_json(path: Path) -> tuple[list[Row], dict[str, Any]]:
    """Read ``sweep.json`` back: its rows, and what was swept.

    Raises
    ------
    DatasetError
        If it is missing, broken, or of another version.
    """
    try:
        table = read_json_table(path)
        if (table.pop("format"), table.pop("version")) != (TABLE_FORMAT, TABLE_VERSION):
            raise ValueError("another format or version")
        rows = Fields(table, path).tables("rows")
        del table["rows"]
        return [_row(record) for record in rows], table
    except (DatasetError, KeyError, ValueError) as error:
        raise DatasetError(
            f"expected a sweep at {path}, got: {cause(error)}; sweep again: only what is missing "
            "is done"
        ) from error


def _row(record: Fields) -> Row:
    kinds = {name: typing.get_type_hints(Row)[name] for name in PLAIN_COLUMNS}
    saturated = [name for name in record if SATURATED.fullmatch(name)]
    record.only((*kinds, *saturated))
    values: dict[str, Any] = {}
    for name, kind in kinds.items():
        options = typing.get_args(kind) if isinstance(kind, types.UnionType) else (kind,)
        if type(None) in options and record.value(name) in (None, ""):
            values[name] = None
        elif float in options:
            values[name] = record.number(name, -LARGEST, LARGEST)
        elif kind is int:
            values[name] = record.whole(name, 0, MOST_COUNTED)
        elif name == "verdict":
            values[name] = record.choice(name, VERDICTS)
        else:
            values[name] = record.text(name, MOST_PROSE, lines=True)
    values["saturated_percent"] = {
        SATURATED.sub(r"\g<stream>", name): record.number(name, 0.0, 100.0) for name in saturated
    }
    return Row(**values)


PLAIN_COLUMNS = [field.name for field in fields(Row) if field.name != "saturated_percent"]
