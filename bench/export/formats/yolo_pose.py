"""YOLO-pose: a text file an image, everything as a share of the image's width and height.

::

    OUT/images/train|val|test/000001_000000.png
        labels/train|val|test/000001_000000.txt
        data.yaml

A line is ``class cx cy w h`` and ``x y v`` of each keypoint. Shares are counted from the image's
corner, so half a pixel is added to our pixel centres; boxes reach from the outer edge of the first
pixel to that of the last.
"""

from __future__ import annotations

import json
from collections.abc import Iterator

from bench.export.formats.coco import keypoint_triples
from bench.export.formats.format import Files, Format, Streamed
from bench.export.formats.yolo_check import check_yolo
from bench.export.labels import Label
from bench.export.picture import Picture
from bench.export.plan import TEST, TRAIN, UNLABELLED, VAL, Plan
from bench.export.record import Record
from bench.export.records import Records

NAME = "yolo-pose"


def exposure(plan: Plan, label: Label, picture: Picture) -> Files:
    """Return the image and its labels.

    Parameters
    ----------
    plan : Plan
    label : Label
    picture : Picture
    """
    record = label.record
    files = {f"images/{record.split}/{record.key}.png": picture.png}
    if record.split != UNLABELLED:
        text = line(record, points_of(plan))
        files[f"labels/{record.split}/{record.key}.txt"] = text.encode()
    return files


def points_of(plan: Plan) -> int:
    """Return how many keypoints a line has: as many as the richest target."""
    return max((len(s.target.keypoints) for _, s in plan.targets() if s.target), default=0)


def line(record: Record, points: int) -> str:
    """Return the line of an image; nothing where the target is not seen."""
    visible = record.visible
    if visible is None or visible.box is None or record.object_id is None:
        return ""
    width, height = record.width, record.height
    x0, y0, x1, y1 = visible.box
    numbers = [
        (x0 + x1 + 1) / 2 / width,
        (y0 + y1 + 1) / 2 / height,
        (x1 - x0 + 1) / width,
        (y1 - y0 + 1) / height,
    ]
    words = [str(record.object_id - 1), *(f"{x:.9f}" for x in numbers)]
    triples = keypoint_triples(record)
    for x, y, v in zip(triples[::3], triples[1::3], triples[2::3], strict=True):
        if v:
            words += [f"{(x + 0.5) / width:.9f}", f"{(y + 0.5) / height:.9f}", str(int(v))]
        else:
            words += ["0", "0", "0"]
    words += ["0"] * (3 * points - len(triples))
    return " ".join(words) + "\n"


def finish(records: Records) -> Streamed:
    """Return ``data.yaml``."""
    yield "data.yaml", _described(records.plan)


def _described(plan: Plan) -> Iterator[bytes]:
    targets = plan.targets()
    points = points_of(plan)
    mirrored = None
    if len(targets) == 1 and targets[0][1].target is not None:
        mirrored = targets[0][1].target.keypoints.mirrored()
    held = [split for split in (TRAIN, VAL, TEST) if split in plan.splits]
    lines = [
        "# keypoints: x y v; v is 2 where seen, 1 where hidden or in shadow, 0 out of the field",
        *(f"{split}: images/{split}" for split in held),
        *([] if VAL in held else [f"val: images/{held[-1]}"] if held else []),
        f"kpt_shape: [{points}, 3]",
    ]
    if mirrored is None:
        lines.append("# no plane of symmetry: train without mirrored images (fliplr=0.0)")
    lines.append(f"flip_idx: {json.dumps(list(mirrored or range(points)))}")
    lines.append("names:")
    lines += [f"  {number - 1}: {json.dumps(s.dataset.info.target)}" for number, s in targets]
    yield ("\n".join(lines) + "\n").encode()


FORMAT = Format(NAME, "YOLO-pose", 8, exposure, finish, check_yolo)
