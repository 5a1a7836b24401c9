"""BOP imagewise: every image with its own labels beside it, and nothing to be joined.

::

    OUT/camera[_STREAM].json, dataset_info.json, test_targets_bop19.json, models/, ...
        train|val|test[_STREAM]/000001_000000.gray.tiff, or .rgb.png
            .depth.png, .camera.json, .gt.json, .gt_info.json, .mask.json, .mask_visib.json
"""

from __future__ import annotations

import json
from typing import Any

from bench.export.formats.bop_check import check_imagewise
from bench.export.formats.bop_fields import (
    camera_table,
    depth_png,
    info_tables,
    pose_tables,
    root_files,
    run_length_table,
)
from bench.export.formats.format import Files, Format, Streamed
from bench.export.labels import Label
from bench.export.picture import Picture
from bench.export.plan import Plan
from bench.export.records import Records

NAME, TITLE = "bop-imagewise", "BOP imagewise"


def exposure(plan: Plan, label: Label, picture: Picture) -> Files:
    """Return the files of one image, each named by the image.

    Parameters
    ----------
    plan : Plan
    label : Label
    picture : Picture
    """
    record = label.record
    place = f"{record.split}{plan.suffix(record.stream)}/{record.scene:06d}_{record.frame:06d}"
    return {f"{place}.{name}": data for name, data in members(label, picture).items()}


def members(label: Label, picture: Picture) -> Files:
    """Return what belongs to one image, by the ending of its name."""
    record = label.record
    grey = {"gray.tiff": picture.tiff()} if picture.is_grey else {"rgb.png": picture.png}
    tables: dict[str, Any] = {"camera.json": camera_table(record)}
    if record.rotation is not None:
        tables |= {"gt.json": pose_tables(record), "gt_info.json": info_tables(record)}
    for name, mask in (("mask.json", record.full), ("mask_visib.json", record.visible)):
        if mask is not None:
            tables[name] = {"0": run_length_table(mask, record)}
    depth = depth_png(label)
    files = {name: (json.dumps(table) + "\n").encode() for name, table in tables.items()}
    return grey | files | ({} if depth is None else {"depth.png": depth})


def finish(records: Records) -> Streamed:
    """Return the files beside the splits."""
    yield from root_files(records, TITLE)


FORMAT = Format(NAME, TITLE, 8, exposure, finish, check_imagewise)
