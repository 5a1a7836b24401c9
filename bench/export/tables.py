"""Sensor tables, estimates and truth as CSV: they leave with every format.

::

    OUT/tables/labels.csv        pose, Sun, range, boxes of every image
        keypoints.csv            where each keypoint falls, and its state
        000001/frames.csv        of the first dataset, by the clock on board
        000001/STREAM.csv        what a sensor without images gave
        000001/truth.csv         what was sealed of each exposure, number by number
        000001/truth_NAME.csv    other tables behind the wall
        000001/estimates/NAME.csv, 000001/runs/001/NAME.csv
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from bench.export.formats.format import Streamed
from bench.export.record import MaskRecord, Record
from bench.export.records import Records
from bench.export.source import Source
from models.dataset.estimates_file import read_estimates
from models.dataset.frame_table import frames_to_csv
from models.dataset.sensor_table import read_table, table_to_csv
from models.estimate import Estimate
from models.reading.regular_file import MOST_LINE_BYTES, read_text

MOST_NUMBERS = 16  # of a key of the truth, to be columns; more than a pose is no column's work
NO_POINT: tuple[Any, ...] = (None, None)
NO_VECTOR: tuple[Any, ...] = (None, None, None)
POSE = ("qw", "qx", "qy", "qz", "tx_m", "ty_m", "tz_m")
LABEL_COLUMNS = (
    "key", "scene", "frame", "stream", "split", "target", "time_s", "exposure_ms",
    *(f"{name}_cam_from_target" for name in POSE),
    "sun_x_in_target", "sun_y_in_target", "sun_z_in_target", "range_m", "phase_angle_deg",
    "seen_x0_px", "seen_y0_px", "seen_x1_px", "seen_y1_px",
    "whole_x0_px", "whole_y0_px", "whole_x1_px", "whole_y1_px", "visible_fraction",
)  # fmt: skip
ESTIMATE_COLUMNS = (
    "frame", "time_s", "mode", *(f"{name}_cam_from_target" for name in POSE), "residual_rms_px",
    "covariance_rad_m", "reason",
)  # fmt: skip


def table_files(records: Records) -> Streamed:
    """Return all tables.

    Parameters
    ----------
    records : Records
    """
    names = {number: name for name, number in records.plan.object_ids.items()}
    yield "tables/labels.csv", _rows(LABEL_COLUMNS, (_label(r, names) for r in records.of()))
    columns = ("key", "name", "x_px", "y_px", "state")
    yield "tables/keypoints.csv", _rows(columns, _keypoints(records))
    for source in records.plan.sources:
        place, dataset = f"tables/{source.number:06d}", source.dataset
        yield f"{place}/frames.csv", [frames_to_csv(dataset.entries).encode()]
        for stream in dataset.info.streams:
            if stream.kind == "table":
                path = stream.path(source.folder)
                readings = read_table(path, stream.columns, dataset.entries)
                text = table_to_csv(stream.columns, readings.items())
                yield f"{place}/{stream.name}.csv", [text.encode()]
        yield from _truth(source, place)
        for name, said in estimates_of(source):
            yield f"{place}/{name}.csv", _rows(ESTIMATE_COLUMNS, map(_estimate, said))


def estimates_of(source: Source) -> Iterator[tuple[str, list[Estimate]]]:
    """Walk what pipelines said of a dataset, with a name for each file.

    Raises
    ------
    DatasetError
        If a file cannot be read.
    """
    for path in sorted((source.folder / "estimates").glob("*.jsonl")):
        yield f"estimates/{path.stem}", read_estimates(path)
    for path in sorted((source.folder / "seeds").glob("[0-9]*/estimates/*.jsonl")):
        yield f"runs/{path.parent.parent.name}/{path.stem}", read_estimates(path)
    for stream in source.dataset.info.streams:
        if stream.kind == "estimates":
            yield f"estimates/stream_{stream.name}", read_estimates(stream.path(source.folder))


def truth_rows(source: Source) -> Iterator[dict[str, Any]]:
    """Walk what was sealed of each exposure, as single numbers by name."""
    if not source.truth.places:
        return
    with source.truth.path.open("rb") as file:
        while text := file.readline(MOST_LINE_BYTES):
            yield dict(_numbers(json.loads(text), ""))


def _truth(source: Source, place: str) -> Streamed:
    first = next(truth_rows(source), None)
    if first is not None:
        columns = tuple(first)
        rows = ([own.get(name, "") for name in columns] for own in truth_rows(source))
        yield f"{place}/truth.csv", _rows(columns, rows)
    for path in sorted((source.folder / "truth").glob("*.csv")):
        yield f"{place}/truth_{path.stem}.csv", [read_text(path).encode()]


def _numbers(value: Any, name: str) -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for key, own in value.items():
            yield from _numbers(own, f"{name}.{key}" if name else key)
    elif isinstance(value, list):
        flat = np.array(value, dtype=object).ravel().tolist()
        if len(flat) <= MOST_NUMBERS:
            for number, own in enumerate(flat):
                yield f"{name}_{number}", "" if own is None else own
    else:
        yield name, value


def _rows(columns: Iterable[str], rows: Iterable[Iterable[Any]]) -> Iterator[bytes]:
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        writer.writerow(["" if each is None else each for each in row])
        yield stream.getvalue().encode()
        stream.seek(0)
        stream.truncate()
    yield stream.getvalue().encode()


def _label(record: Record, names: dict[int, str]) -> list[Any]:
    return [
        record.key,
        record.scene,
        record.frame,
        record.stream,
        record.split,
        names.get(record.object_id or 0),
        record.time_s,
        record.exposure_ms,
        *_pose(record.rotation, record.translation_m),
        *(record.sun_dir_in_target or NO_VECTOR),
        record.range_m,
        record.phase_angle_deg,
        *_box(record.visible),
        *_box(record.full),
        record.visible_fraction if record.full is not None else None,
    ]


def _keypoints(records: Records) -> Iterator[list[Any]]:
    for record in records.of():
        target = records.plan.sources[record.scene - 1].target
        if target is None or not record.keypoint_states:
            continue
        for name, point, state in zip(
            target.keypoints.names, record.keypoints_px, record.keypoint_states, strict=True
        ):
            yield [record.key, name, *(point or NO_POINT), state]


def _estimate(said: Estimate) -> list[Any]:
    pose = said.pose
    rotation = None if pose is None else pose.cam_from_target.rotation.ravel().tolist()
    translation = None if pose is None else pose.cam_from_target.translation.tolist()
    covariance = None if pose is None or pose.covariance is None else pose.covariance
    return [
        said.frame,
        said.time_s,
        said.mode,
        *_pose(rotation, translation),
        None if pose is None else pose.residual_rms_px,
        None if covariance is None else " ".join(map(repr, covariance.ravel().tolist())),
        said.reason,
    ]


def _pose(rotation: list[float] | None, translation_m: list[float] | None) -> list[Any]:
    if rotation is None or translation_m is None:
        return [None] * 7
    turn = Rotation.from_matrix(np.reshape(rotation, (3, 3)))
    return [*turn.as_quat(canonical=True, scalar_first=True).tolist(), *translation_m]


def _box(mask: MaskRecord | None) -> list[Any]:
    return [None] * 4 if mask is None or mask.box is None else list(mask.box)


def as_path(folder: Path) -> str:
    """Return how a dataset's folder is named in what leaves: by its last name alone."""
    return folder.resolve().name
