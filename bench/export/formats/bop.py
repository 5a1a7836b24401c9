"""BOP scenewise: a folder a dataset, with files of all its images; streams are ``_NAME`` suffixes.

::

    OUT/camera[_STREAM].json, dataset_info.json, test_targets_bop19.json, test_targets_bop24.json
        models/, models_eval/
        train|val|test/000001/scene_camera[_STREAM].json, scene_gt, scene_gt_info, scene_gt_coco
            gray[_STREAM]/000000.png, or rgb
            depth[_STREAM]/000000.png, and depth_m[_STREAM]/000000.exr in m, float
            mask[_STREAM]/000000_000000.png, mask_visib
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from bench.export.formats.bop_check import check_bop
from bench.export.formats.bop_fields import (
    LEAST_VISIBLE,
    camera_table,
    depth_png,
    info_tables,
    pose_tables,
    root_files,
    run_length_table,
    streams_of,
)
from bench.export.formats.format import Files, Format, Streamed
from bench.export.json_stream import entries, table_of_lists
from bench.export.labels import Label
from bench.export.picture import Picture, encoded
from bench.export.plan import UNLABELLED, Plan
from bench.export.record import Record
from bench.export.records import Records
from models.arrays import Mask
from renders.store.sealed_exr import exr_bytes

NAME = "bop"


def exposure(plan: Plan, label: Label, picture: Picture) -> Files:
    """Return the files of one image: itself, its depth, its masks.

    Parameters
    ----------
    plan : Plan
    label : Label
    picture : Picture
    """
    record = label.record
    place = f"{record.split}/{record.scene:06d}"
    suffix, image = plan.suffix(record.stream), f"{record.frame:06d}"
    files = {f"{place}/{folder_of(record)}{suffix}/{image}.png": picture.png}
    depth = depth_png(label)
    if depth is not None and label.depth_m is not None:
        files[f"{place}/depth{suffix}/{image}.png"] = depth
        files[f"{place}/depth_m{suffix}/{image}.exr"] = exr_bytes({"Z": label.depth_m})
    for name, mask in (("mask", label.full), ("mask_visib", label.visible)):
        if mask is not None:
            files[f"{place}/{name}{suffix}/{image}_000000.png"] = mask_png(mask)
    return files


def folder_of(record: Record) -> str:
    """Return what BOP calls the folder of such images."""
    return "gray" if record.channels == 1 else "rgb"


def mask_png(mask: Mask) -> bytes:
    """Return a (height, width) mask as a PNG of 0 and 255."""
    return encoded(np.where(mask, 255, 0).astype(np.uint8), ".png")


def finish(records: Records) -> Streamed:
    """Return the files that tell of all images."""
    plan = records.plan
    yield from root_files(records, TITLE)
    for split, scene, stream in streams_of(plan):
        if split == UNLABELLED:
            continue
        place, suffix = f"{split}/{scene:06d}", plan.suffix(stream)
        tables: dict[str, Callable[[Record], Any]] = {
            "scene_camera": camera_table,
            "scene_gt": pose_tables,
            "scene_gt_info": info_tables,
        }
        for name, table in tables.items():
            of = records.of(split, scene, stream)
            yield f"{place}/{name}{suffix}.json", entries((str(r.frame), table(r)) for r in of)
        yield (
            f"{place}/scene_gt_coco{suffix}.json",
            table_of_lists(
                {"info": {"description": place}, "licenses": [], "categories": _categories(plan)},
                {
                    "images": map(_coco_image(suffix), records.of(split, scene, stream)),
                    "annotations": _annotations(records.of(split, scene, stream)),
                },
            ),
        )


def _categories(plan: Plan) -> list[dict[str, Any]]:
    return [
        {"id": number, "name": str(number), "supercategory": "spacecraft"}
        for number in sorted(plan.object_ids.values())
    ]


def _coco_image(suffix: str) -> Callable[[Record], dict[str, Any]]:
    def table(record: Record) -> dict[str, Any]:
        return {
            "id": record.frame,
            "file_name": f"{folder_of(record)}{suffix}/{record.frame:06d}.png",
            "width": record.width,
            "height": record.height,
        }

    return table


def _annotations(records: Iterator[Record]) -> Iterator[dict[str, Any]]:
    number = 0
    for record in records:
        full, visible = record.full, record.visible
        if full is None or visible is None or visible.box is None or full.box is None:
            continue
        number += 1
        x0, y0, x1, y1 = np.clip(
            full.box, 0, [record.width - 1, record.height - 1] * 2
        ).tolist()  # of the silhouette within the image
        yield {
            "id": number,
            "image_id": record.frame,
            "category_id": record.object_id,
            "iscrowd": 0,
            "area": visible.count,
            "bbox": [x0, y0, x1 - x0 + 1, y1 - y0 + 1],
            "segmentation": run_length_table(visible, record),
            "width": record.width,
            "height": record.height,
            "ignore": record.visible_fraction < LEAST_VISIBLE,
        }


TITLE = "BOP scenewise"
FORMAT = Format(NAME, TITLE, 16, exposure, finish, check_bop)
