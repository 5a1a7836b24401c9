"""COCO: boxes, masks as run lengths, and keypoints with their visibility, one file a split.

::

    OUT/images/train|val|test/000001_000000.png
        annotations/train.json, ...

Pixels have integer centres; boxes are ``x, y, w, h`` from the first pixel that belongs to the
target to behind the last, as pycocotools makes them of masks. A keypoint's v is 2 where it is
seen, 1 where it is hidden by a body or in shadow, 0 where it is out of the field;
``keypoint_states`` tells which, beside COCO's own keys.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from bench.export.formats.coco_check import check_coco
from bench.export.formats.format import Files, Format, Streamed
from bench.export.json_stream import table_of_lists
from bench.export.keypoints import OUTSIDE, VISIBLE
from bench.export.labels import Label
from bench.export.picture import Picture
from bench.export.plan import UNLABELLED, Plan
from bench.export.record import Record
from bench.export.records import Records
from bench.export.run_lengths import packed

NAME = "coco"
CONVENTIONS = (
    "pixel centres are integers; keypoint v: 2 seen, 1 hidden by a body or in shadow, 0 out of the "
    "field (keypoint_states tells which); segmentation is of what is seen"
)


def exposure(plan: Plan, label: Label, picture: Picture) -> Files:
    """Return the image.

    Parameters
    ----------
    plan : Plan
    label : Label
    picture : Picture
    """
    return {image_path(label.record): picture.png}


def image_path(record: Record) -> str:
    """Return where an image lies in the export."""
    return f"images/{record.split}/{record.key}.png"


def finish(records: Records) -> Streamed:
    """Return the annotations of each split."""
    for split in records.plan.splits:
        if split == UNLABELLED:
            continue
        head = {"info": {"description": CONVENTIONS}, "licenses": [],
                "categories": categories(records.plan)}  # fmt: skip
        lists = {
            "images": _images(records.of(split)),
            "annotations": _annotations(records.of(split)),
        }
        yield f"annotations/{split}.json", table_of_lists(head, lists)


def categories(plan: Plan) -> list[dict[str, Any]]:
    """Return a category for each target, with its keypoints and the lines between them."""
    told = []
    for number, source in plan.targets():
        table: dict[str, Any] = {
            "id": number,
            "name": source.dataset.info.target,
            "supercategory": "spacecraft",
        }
        if source.target is not None:
            model = source.target.keypoints
            table["keypoints"] = list(model.names)
            table["skeleton"] = [[a + 1, b + 1] for a, b in model.skeleton]
        told.append(table)
    return told


def keypoint_triples(record: Record) -> list[float]:
    """Return x, y, v of each keypoint, in a row; zeros where it is out of the field."""
    triples: list[float] = []
    for point, state in zip(record.keypoints_px, record.keypoint_states, strict=True):
        told = point is not None and state != OUTSIDE
        x, y = point if told and point is not None else (0.0, 0.0)
        triples += [x, y, (2 if state == VISIBLE else 1) if told else 0]
    return triples


def _images(records: Iterator[Record]) -> Iterator[dict[str, Any]]:
    for number, record in enumerate(records, start=1):
        yield {
            "id": number,
            "file_name": f"{record.split}/{record.key}.png",
            "width": record.width,
            "height": record.height,
            "scene": record.scene,
            "frame": record.frame,
            "stream": record.stream,
        }


def _sized(box: tuple[int, int, int, int]) -> list[int]:
    """Return a box of first and last pixels as x, y, width and height."""
    x0, y0, x1, y1 = box
    return [x0, y0, x1 - x0 + 1, y1 - y0 + 1]


def _annotations(records: Iterator[Record]) -> Iterator[dict[str, Any]]:
    for number, record in enumerate(records, start=1):
        visible, full = record.visible, record.full
        if visible is None or visible.box is None:
            continue
        triples = keypoint_triples(record)
        yield {
            "id": number,
            "image_id": number,
            "category_id": record.object_id,
            "iscrowd": 0,
            "bbox": _sized(visible.box),
            "area": visible.count,
            "segmentation": {
                "size": [record.height, record.width],
                "counts": packed(visible.lengths),
            },
            "keypoints": triples,
            "num_keypoints": sum(v > 0 for v in triples[2::3]),
            "keypoint_states": record.keypoint_states,
            "visible_fraction": record.visible_fraction,
            "box_of_whole": None if full is None or full.box is None else _sized(full.box),
            "R_cam_from_target": record.rotation,
            "t_cam_from_target_m": record.translation_m,
            "camera_px": record.camera,
            "distortion": record.distortion,
        }


FORMAT = Format(NAME, "COCO keypoints and instances", 16, exposure, finish, check_coco)
