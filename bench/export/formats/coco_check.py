"""A COCO export reopened: masks against boxes and areas, keypoints against their poses."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from bench.export.formats.format import Findings
from bench.export.formats.reading_back import (
    check_mask,
    compare_keypoints,
    decoded,
    image_of,
    opened,
    points_of_targets,
)


def check_coco(folder: Path) -> Findings:
    """Reopen every split."""
    found, points = Findings(), points_of_targets(folder)
    for path in sorted((folder / "annotations").glob("*.json")):
        table = opened(folder, f"annotations/{path.name}")
        names = {each["id"]: each["name"] for each in table["categories"]}
        images = {each["id"]: each for each in table["images"]}
        for image in images.values():
            found.images += 1
            shape = image_of(folder, f"images/{image['file_name']}").shape[:2]
            if shape != (image["height"], image["width"]):
                found.faults.append(f"{image['file_name']}: expected its size, got {shape}")
        for own in table["annotations"]:
            found.objects += 1
            image = images[own["image_id"]]
            _hold(found, own, image, points.get(names[own["category_id"]]))
    return found


def _hold(found: Findings, own: dict[str, Any], image: dict[str, Any], points: Any) -> None:
    where, (x, y, w, h) = image["file_name"], own["bbox"]
    mask = decoded(own["segmentation"]["counts"], image["height"], image["width"])
    check_mask(found, where, mask, own["area"], [x, y, x + w - 1, y + h - 1])
    triples = own["keypoints"]
    told = [
        (u, v) if seen else None
        for u, v, seen in zip(triples[::3], triples[1::3], triples[2::3], strict=True)
    ]
    pose = (own["R_cam_from_target"], own["t_cam_from_target_m"])
    if points is not None:
        compare_keypoints(found, where, points, pose, own["camera_px"], own["distortion"], told)
    if own["num_keypoints"] != sum(each is not None for each in told):
        found.faults.append(f"{where}: expected num_keypoints as those told")
