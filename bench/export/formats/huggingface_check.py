"""A Hugging Face folder reopened: every line's image, masks and keypoints."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from bench.export.formats.format import Findings
from bench.export.formats.reading_back import (
    MOST_BYTES,
    check_mask,
    compare_keypoints,
    decoded,
    image_of,
    points_of_targets,
)
from models.errors import DatasetError
from models.reading.json_file import read_json_lines


def check_huggingface(folder: Path) -> Findings:
    """Reopen every split.

    Raises
    ------
    DatasetError
        If lines of a split do not have the same keys.
    """
    found, points = Findings(), points_of_targets(folder)
    for path in sorted((folder / "data").glob("*/metadata.jsonl")):
        keys: set[str] = set()
        for number, own in read_json_lines(path, MOST_BYTES):
            keys = keys or set(own)
            if set(own) != keys:
                raise DatasetError(f"{path}:{number}: expected the keys of the lines before")
            _hold(found, folder, path.parent.name, own, points)
    return found


def _hold(
    found: Findings, folder: Path, split: str, own: dict[str, Any], points: dict[str, Any]
) -> None:
    name = f"data/{split}/{own['file_name']}"
    found.images += 1
    height, width = own["height"], own["width"]
    if image_of(folder, name).shape[:2] != (height, width):
        found.faults.append(f"{name}: expected {width} x {height} pixels")
    if not own["R_cam_from_target"]:
        return
    found.objects += 1
    if own["mask_visible"]:
        mask = decoded(own["mask_visible"], height, width)
        check_mask(found, name, mask, int(mask.sum()), own["box_visible_px"] or None)
    flat, states = own["keypoints_px"], own["keypoint_states"]
    told = [
        None if state == "outside" else (x, y)
        for x, y, state in zip(flat[::2], flat[1::2], states, strict=True)
    ]
    if own["target"] in points:
        compare_keypoints(
            found,
            name,
            points[own["target"]],
            (own["R_cam_from_target"], own["t_cam_from_target_m"]),
            own["camera_px"],
            own["distortion"],
            told,
        )
