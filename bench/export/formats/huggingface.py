"""A Hugging Face folder: images by split with JSON lines beside them, and a Croissant description.

::

    OUT/README.md, croissant.json
        data/train|validation|test/metadata.jsonl, 000001_000000.png

``datasets.load_dataset(OUT)`` reads it offline. Poses are ``x_cam = R x_target + t``, m; pixels
have integer centres; boxes are ``x0, y0, x1, y1`` and belong to the target at both ends; masks are
COCO's packed run lengths.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from bench.export.formats.format import Files, Format, Streamed
from bench.export.formats.huggingface_check import check_huggingface
from bench.export.json_stream import lines
from bench.export.labels import Label
from bench.export.picture import Picture
from bench.export.plan import Plan
from bench.export.record import MaskRecord, Record
from bench.export.records import Records
from bench.export.run_lengths import packed

NAME = "huggingface"
SPLITS = {"train": "train", "val": "validation", "test": "test", "unlabelled": "unlabelled"}
"""What the Hub calls our splits."""


def exposure(plan: Plan, label: Label, picture: Picture) -> Files:
    """Return the image.

    Parameters
    ----------
    plan : Plan
    label : Label
    picture : Picture
    """
    return {f"data/{SPLITS[label.record.split]}/{label.record.key}.png": picture.png}


def finish(records: Records) -> Streamed:
    """Return the metadata of each split."""
    for split in records.plan.splits:
        rows = _rows(records.plan, records.of(split))
        yield f"data/{SPLITS[split]}/metadata.jsonl", lines(rows)


def row(plan: Plan, record: Record) -> dict[str, Any]:
    """Return an image's line; every line has the same keys.

    Parameters
    ----------
    plan : Plan
    record : Record
    """
    names = {number: name for name, number in plan.object_ids.items()}
    points = [point or [-1.0, -1.0] for point in record.keypoints_px]
    return {
        "file_name": f"{record.key}.png",
        "scene": record.scene,
        "frame": record.frame,
        "stream": record.stream,
        "time_s": record.time_s,
        "exposure_ms": record.exposure_ms,
        "target": names.get(record.object_id or 0, ""),
        "width": record.width,
        "height": record.height,
        "camera_px": record.camera or [],
        "distortion": record.distortion,
        "R_cam_from_target": record.rotation or [],
        "t_cam_from_target_m": record.translation_m or [],
        "sun_dir_in_target": record.sun_dir_in_target or [],
        "range_m": -1.0 if record.range_m is None else record.range_m,
        "phase_angle_deg": -1.0 if record.phase_angle_deg is None else record.phase_angle_deg,
        "box_visible_px": _box(record.visible),
        "box_whole_px": _box(record.full),
        "visible_fraction": record.visible_fraction,
        "mask_visible": _mask(record.visible),
        "mask_whole": _mask(record.full),
        "keypoints_px": [float(x) for point in points for x in point],
        "keypoint_states": record.keypoint_states,
    }


def _rows(plan: Plan, records: Iterator[Record]) -> Iterator[dict[str, Any]]:
    return (row(plan, record) for record in records)


def _box(mask: MaskRecord | None) -> list[int]:
    return [] if mask is None or mask.box is None else list(mask.box)


def _mask(mask: MaskRecord | None) -> str:
    return "" if mask is None else packed(mask.lengths)


FORMAT = Format(
    NAME, "a Hugging Face folder with Croissant", 16, exposure, finish, check_huggingface
)
