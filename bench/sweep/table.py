"""The table of a sweep: a row for each pose, Sun, exposure, lamp power and pipeline.

``sweep.csv`` and ``sweep.json`` hold the same numbers with all their digits; the unit stands in
the name of the column. An empty cell, or null, is a number that there is not: without a pose there
is no error.
"""

from __future__ import annotations

import csv
import io
import json
import sys
import types
import typing
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, Literal, TypeAlias

from bench.scoring.detections import VisibleMarkers, judge
from models.errors import DatasetError, cause
from models.estimate import Estimate, PoseEstimate
from models.lights.sun_grid import NamedSun
from models.pose import pose_error
from models.reading import csv_table
from models.reading.bounds import MOST_PROSE
from models.reading.fields import Fields
from models.reading.json_file import read_json_table
from renders.truth.exposure_truth import ExposureTruth

TABLE_FORMAT, TABLE_VERSION = "rvbench-sweep", 1
HALF = 0.5
LARGEST = sys.float_info.max  # any number that is one
MOST_COUNTED = 1_000_000

Verdict: TypeAlias = Literal["all found", "some missed", "no pose"]
VERDICTS: tuple[Verdict, ...] = ("all found", "some missed", "no pose")


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
        without; ``no pose``.
    expected, found, mismatched, used : int
        Markers that are truly whole, lit and in the image; those of them truly found; matches
        that are not true; markers that the solver kept. See ``bench.scoring.detections``.
    in_sun : int
        Markers that the Sun lights at least half.
    position_error_mm, attitude_error_deg : float or None, mm and deg
    error_x_mm, error_y_mm, error_z_mm : float or None, mm
        Along the camera's axes.
    saturated_800_percent, saturated_850_percent : float, %
        Of the pixels.
    reason : str
        Why there is no pose.
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
    error_x_mm: float | None
    error_y_mm: float | None
    error_z_mm: float | None
    saturated_800_percent: float
    saturated_850_percent: float
    reason: str

    @property
    def harshness(self) -> tuple[float, ...]:
        """What orders rows from kind to harsh: no pose, markers missed, then the error."""
        if self.position_error_mm is None:
            return (1.0, float(self.expected - self.found), -float(self.used), 0.0)
        missed = float(self.expected - self.found)
        return (0.0, missed, 0.0, self.position_error_mm)


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
        return (
            f"{self.range_m:.2f} m, {self.exposure_ms:.3g} ms, lamps of {self.lamp_w_sr:.3g} W/sr"
        )


def setting_of(row: Row) -> Setting:
    """Return the setting of a row."""
    return Setting(row.time_s, row.range_m, row.exposure_ms, row.lamp_w_sr)


def judged_row(
    sun: NamedSun,
    setting: Setting,
    pipeline: str,
    estimate: Estimate,
    truth: ExposureTruth,
    markers: VisibleMarkers,
    saturated_percent: dict[int, float],
) -> Row:
    """Hold one estimate against the truth."""
    judged = judge(estimate.detections, markers)
    expected, found = int(markers.expected.sum()), int(markers.expected[judged.found].sum())
    error = (
        pose_error(estimate.cam_from_target, truth.cam_from_target)
        if isinstance(estimate, PoseEstimate)
        else None
    )
    along_mm = [None] * 3 if error is None else [1e3 * float(x) for x in error.position_m]
    verdict: Verdict = "all found" if found == expected else "some missed"
    return Row(
        sun=sun.name,
        azimuth_deg=sun.azimuth_deg,
        elevation_deg=sun.elevation_deg,
        sun_text=sun.text,
        **asdict(setting),
        pipeline=pipeline,
        verdict=verdict if error is not None else "no pose",
        expected=expected,
        found=found,
        mismatched=int(judged.mismatch.sum()),
        used=len(judged.solved_with),
        in_sun=int((truth.sun_lit >= HALF).sum()),
        position_error_mm=None
        if error is None
        else 1e3 * float((error.position_m @ error.position_m) ** 0.5),
        attitude_error_deg=None if error is None else float(error.attitude_deg),
        error_x_mm=along_mm[0],
        error_y_mm=along_mm[1],
        error_z_mm=along_mm[2],
        saturated_800_percent=saturated_percent[800],
        saturated_850_percent=saturated_percent[850],
        reason=getattr(estimate, "reason", ""),
    )


def to_csv(rows: list[Row]) -> str:
    """Return the text of ``sweep.csv``."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([field.name for field in fields(Row)])
    for row in rows:
        values = asdict(row).values()
        writer.writerow(
            ["" if x is None else repr(x) if isinstance(x, float) else x for x in values]
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
        columns = [field.name for field in fields(Row)]
        return [_row(record) for record in csv_table.read_csv(path, columns)]
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
        "rows": [asdict(row) for row in rows],
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
    kinds = typing.get_type_hints(Row)
    record.only(tuple(kinds))
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
    return Row(**values)
