"""What the three BOP formats share: their tables of one image, in mm, and their files of all.

Written to the format's description (BOP toolkit, docs/bop_datasets_format.md, 2025): the camera is
OpenCV's with integer pixel centres, ``x_cam = R x_model + t``, boxes are ``x, y, w, h`` with w and
h the difference of the outermost pixels, depth is along the boresight.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from bench.export.formats.format import Streamed
from bench.export.json_stream import items, whole
from bench.export.labels import Label
from bench.export.model_files import model_files
from bench.export.picture import encoded
from bench.export.plan import TEST, UNLABELLED, Plan
from bench.export.record import Box, MaskRecord, Record
from bench.export.records import Records
from models.arrays import Image

MM = 1e3
NOTHING = [-1, -1, -1, -1]
LEAST_VISIBLE = 0.1  # of the silhouette, for an object to be a target
LARGEST = 65535


def camera_table(record: Record) -> dict[str, Any]:
    """Return an image's entry of ``scene_camera.json``; of a lens that distorts, with how."""
    table: dict[str, Any] = {"depth_scale": record.depth_scale_mm}
    if record.matrix is not None:
        table = {"cam_K": record.matrix, **table}
    if any(record.distortion):
        table["distortion"] = record.distortion
    return table


def pose_tables(record: Record) -> list[dict[str, Any]]:
    """Return an image's entry of ``scene_gt.json``."""
    if record.rotation is None or record.translation_m is None:
        return []
    return [
        {
            "cam_R_m2c": record.rotation,
            "cam_t_m2c": [MM * x for x in record.translation_m],
            "obj_id": record.object_id,
        }
    ]


def info_tables(record: Record) -> list[dict[str, Any]]:
    """Return an image's entry of ``scene_gt_info.json``."""
    if record.rotation is None:
        return []
    full, visible = record.full, record.visible
    seen = visible is not None and visible.count > 0
    return [
        {
            "bbox_obj": _box(full.box) if seen and full is not None else NOTHING,
            "bbox_visib": _box(visible.box) if seen and visible is not None else NOTHING,
            "px_count_all": 0 if full is None else full.count,
            "px_count_valid": record.valid,
            "px_count_visib": 0 if visible is None else visible.count,
            "visib_fract": record.visible_fraction,
        }
    ]


def run_length_table(mask: MaskRecord, record: Record) -> dict[str, Any]:
    """Return a mask as BOP's own run lengths, not packed."""
    return {"counts": mask.lengths, "size": [record.height, record.width]}


def depth_image(label: Label) -> Image | None:
    """Return the depth in steps of the scale, (height, width), 0 where there is none."""
    if label.depth_m is None:
        return None
    steps = np.rint(MM * label.depth_m.astype(np.float64) / label.record.depth_scale_mm)
    return np.where((steps < 1) | (steps > LARGEST), 0, steps).astype(np.uint16)


def depth_png(label: Label) -> bytes | None:
    """Return the depth as a 16-bit PNG; None where there is none."""
    depth = depth_image(label)
    return None if depth is None else encoded(depth, ".png")


def root_files(records: Records, title: str) -> Streamed:
    """Return the files beside the splits: models, cameras, targets and what the export is of.

    Parameters
    ----------
    records : Records
    title : str
        Of the format.
    """
    plan = records.plan
    yield from model_files(plan)
    for stream in plan.streams:
        first = next(records.of(stream=stream), None)
        if first is not None and first.camera is not None:
            yield f"camera{plan.suffix(stream)}.json", whole(_simulated(first))
    judged = next((s for s in (TEST, "val", "train") if s in plan.splits), TEST)
    yield "test_targets_bop19.json", items(_targets19(records, judged))
    yield "test_targets_bop24.json", items(_targets24(records, judged))
    yield "dataset_info.json", whole(_told(plan, title, judged))


def streams_of(plan: Plan) -> Iterator[tuple[str, int, str]]:
    """Return each split, dataset and stream that holds images."""
    yield from dict.fromkeys((shot.split, shot.scene, shot.stream) for shot in plan.shots)


def _box(box: Box | None) -> list[int]:
    if box is None:
        return NOTHING
    x0, y0, x1, y1 = box
    return [x0, y0, x1 - x0, y1 - y0]


def _simulated(record: Record) -> dict[str, Any]:
    assert record.camera is not None
    fx, fy, cx, cy = record.camera
    return {
        "cx": cx,
        "cy": cy,
        "depth_scale": record.depth_scale_mm,
        "fx": fx,
        "fy": fy,
        "height": record.height,
        "width": record.width,
    }


def _visible(records: Records, split: str) -> Iterable[Record]:
    """Return one record for each frame of a split whose object is seen enough."""
    stream = {each.number: each.dataset.info.image_streams[0].name
              for each in records.plan.sources if each.dataset.info.image_streams}  # fmt: skip
    for record in records.of(split=split):
        if record.stream == stream[record.scene] and record.visible_fraction >= LEAST_VISIBLE:
            yield record


def _targets19(records: Records, split: str) -> Iterator[dict[str, Any]]:
    for each in _visible(records, split):
        yield {
            "scene_id": each.scene,
            "im_id": each.frame,
            "obj_id": each.object_id,
            "inst_count": 1,
        }


def _targets24(records: Records, split: str) -> Iterator[dict[str, Any]]:
    for each in _visible(records, split):
        yield {"scene_id": each.scene, "im_id": each.frame}


def _told(plan: Plan, title: str, judged: str) -> dict[str, Any]:
    return {
        "name": "-".join(dict.fromkeys(source.dataset.info.case for source in plan.sources)),
        "format": title,
        "objects": {str(number): name for name, number in plan.object_ids.items()},
        "scenes": {str(source.number): source.dataset.info.case for source in plan.sources},
        "cameras": list(plan.streams),
        "splits": [split for split in plan.splits if split != UNLABELLED],
        "targets_are_of": judged,
        "units": "mm",
        "pixel_centres": "integers: the first pixel's centre is (0, 0)",
        "visibility_tolerance": "none: masks are those of the ray tracer",
    }
