"""Sensor tables, estimates and truth as MCAP, for tools of robotics: an extra, ``rvbench[mcap]``.

One file a dataset. Messages are JSON, times are nanoseconds from the first reading on; channels are
``/frames``, ``/tables/STREAM``, ``/estimates/NAME`` and ``/truth``.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from bench.export.plan import Plan
from bench.export.source import Source
from bench.export.tables import estimates_of, truth_rows
from models.atomic_file import whole_or_absent
from models.dataset.estimates_file import estimate_to_json
from models.dataset.sensor_table import read_table
from models.errors import ScenarioError

ANYTHING = json.dumps({"type": "object"}).encode()


def check_mcap() -> None:
    """Refuse ``--mcap`` where the package is not installed.

    Raises
    ------
    ScenarioError
    """
    try:
        import mcap.writer  # noqa: F401
    except ImportError as error:
        raise ScenarioError(
            "expected the package mcap for --mcap, found none; `pip install mcap`, or leave the "
            "option out: the tables leave as CSV in any case"
        ) from error


def write_mcap(plan: Plan, folder: Path) -> list[str]:
    """Write a file for each dataset and return their names in the export.

    Parameters
    ----------
    plan : Plan
    folder : Path
        Of the export.

    Raises
    ------
    StorageError
        If it cannot be written.
    """
    from mcap.writer import Writer

    names = []
    for source in plan.sources:
        name = f"tables/{source.number:06d}.mcap"
        began_s = min(time_s for _, time_s, _ in _messages(source))
        with whole_or_absent(folder / name) as scratch, scratch.open("wb") as file:
            writer = Writer(file)
            writer.start(library="rvbench")
            schema = writer.register_schema("rvbench", "jsonschema", ANYTHING)
            channels: dict[str, int] = {}
            for topic, time_s, message in _messages(source):
                if topic not in channels:
                    channels[topic] = writer.register_channel(topic, "json", schema)
                stamp = round((time_s - began_s) * 1e9)
                data = json.dumps(message).encode()
                writer.add_message(channels[topic], stamp, data, stamp)
            writer.finish()
        names.append(name)
    return names


def _messages(source: Source) -> Iterator[tuple[str, float, dict[str, Any]]]:
    dataset = source.dataset
    for entry in dataset.entries:
        told = {"index": entry.index, "exposure_ms": entry.exposure_ms}
        yield "/frames", entry.time_s, {"time_s": entry.time_s, **told}
    for stream in dataset.info.streams:
        if stream.kind != "table":
            continue
        readings = read_table(stream.path(source.folder), stream.columns, dataset.entries)
        for index, own in readings.items():
            for time_s, row in zip(own.time_s.tolist(), own.rows.tolist(), strict=True):
                values = dict(zip(stream.columns, row, strict=True))
                yield f"/tables/{stream.name}", time_s, {"index": index, "time_s": time_s, **values}
    for name, said in estimates_of(source):
        for each in said:
            yield f"/{name}", each.time_s, estimate_to_json(each)
    for row in truth_rows(source):
        yield "/truth", float(row["time_s"]), row
