"""A SPEED+ export reopened: its camera, its keypoints, and every image of its lists."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.io import loadmat

from bench.export.formats.format import Findings
from bench.export.formats.reading_back import (
    MOST_BYTES,
    compare_keypoints,
    image_of,
    inside,
    opened,
)
from models.reading.bounds import POINT_PX
from models.reading.csv_table import read_csv

LISTS = ("train.json", "validation.json", "test.json")


def check_speedplus(folder: Path) -> Findings:
    """Reopen camera, keypoints, lists, images and masks."""
    found = Findings()
    if not (folder / "camera.json").is_file():
        if (folder / "synthetic").exists():
            found.faults.append("expected a camera.json beside the lists, found none")
        return found
    camera = opened(folder, "camera.json")
    size = (camera["Nv"], camera["Nu"])
    if abs(camera["fx"] / camera["ppx"] - camera["cameraMatrix"][0][0]) > 1e-6 * camera["Nu"]:
        found.faults.append("camera.json: expected fx in m as that of the matrix times the pitch")
    mat = folder / "tangoPoints.mat"
    told_px = _told_px(folder)
    points = loadmat(inside(folder, mat.name))["tango3Dpoints"].T if mat.is_file() else None
    for name in LISTS:
        if not (folder / "synthetic" / name).is_file():
            continue
        for label in opened(folder, f"synthetic/{name}"):
            found.images += 1
            where = label["filename"]
            image = image_of(folder, f"synthetic/images/{where}")
            mask = image_of(folder, f"synthetic/masks/{where}")
            if image.shape[:2] != size or mask.shape != size:
                found.faults.append(f"{where}: expected image and mask of the camera's size")
            wxyz = np.array(label["q_vbs2tango_true"])
            if abs(np.linalg.norm(wxyz) - 1.0) > 1e-9:
                found.faults.append(f"{where}: expected a unit quaternion")
            found.objects += 1
            if points is not None:
                (fx, _, cx), (_, fy, cy), _ = camera["cameraMatrix"]
                told = told_px.get(Path(where).stem, [])
                lens = camera["distCoeffs"]
                compare_keypoints(found, where, points, _pose(label), (fx, fy, cx, cy), lens, told)
    return found


def _pose(label: dict[str, list[float]]) -> tuple[list[float], list[float]]:
    """Return R and t of ``x_cam = R x + t``: the transpose of the quaternion's passive matrix."""
    w, x, y, z = label["q_vbs2tango_true"]
    passive = np.array(
        [
            [w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)],
            [2 * (x * y - w * z), w * w - x * x + y * y - z * z, 2 * (y * z + w * x)],
            [2 * (x * z + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z],
        ]
    )
    return passive.T.ravel().tolist(), label["r_Vo2To_vbs_true"]


def _told_px(folder: Path) -> dict[str, list[tuple[float, float] | None]]:
    """Return where the keypoints of each image were said to fall; None out of the field."""
    told: dict[str, list[tuple[float, float] | None]] = {}
    columns = ("key", "name", "x_px", "y_px", "state")
    for row in read_csv(folder / "tables" / "keypoints.csv", columns, most_bytes=MOST_BYTES):
        held = row.value("state") != "outside" and not row.empty("x_px")
        point = (row.number("x_px", *POINT_PX), row.number("y_px", *POINT_PX)) if held else None
        told.setdefault(str(row.value("key")), []).append(point)
    return told
