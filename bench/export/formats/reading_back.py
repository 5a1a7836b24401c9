"""What the checks of all formats share: files opened anew, and points projected by OpenCV.

Nothing that wrote an export is used to read it: a fault in the one would be one in the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from bench.export.formats.format import Findings
from models.arrays import AnyArray, Floats
from models.errors import DatasetError
from models.reading.json_file import read_json
from models.reading.regular_file import read_bytes

MOST_BYTES = 8_000_000_000
MOST_IMAGE = 1_000_000_000
REPROJECTED_PX = 0.01
TARGETS = "targets.json"


def inside(folder: Path, name: str) -> Path:
    """Return the place of a file that an export names.

    Raises
    ------
    DatasetError
        If the name leads out of the folder.
    """
    place = folder / name
    if Path(name).is_absolute() or ".." in Path(name).parts or not name:
        raise DatasetError(f"{folder}: expected names of files within it, got {name[:200]!r}")
    return place


def opened(folder: Path, name: str) -> Any:
    """Return what a JSON file of an export holds.

    Raises
    ------
    DatasetError
        If it cannot be read.
    """
    return read_json(inside(folder, name), MOST_BYTES)


def image_of(folder: Path, name: str) -> AnyArray:
    """Return an image of an export, (height, width) or (height, width, 3).

    Raises
    ------
    DatasetError
        If it cannot be read.
    """
    path = inside(folder, name)
    image = cv2.imdecode(np.frombuffer(read_bytes(path, MOST_IMAGE), np.uint8), -1)
    if image is None:
        raise DatasetError(f"expected a whole image at {path}, got none; export again")
    return np.asarray(image)


def points_of_targets(folder: Path) -> dict[str, Floats]:
    """Return each target's keypoints by its name, (k, 3) m."""
    table = opened(folder, TARGETS)
    return {
        name: np.array(own["keypoints_in_target_m"], dtype=np.float64).reshape(-1, 3)
        for name, own in table.items()
    }


def compare_keypoints(
    found: Findings,
    where: str,
    points_in_target: Floats,
    pose: tuple[Sequence[float], Sequence[float]],
    camera: Sequence[float],
    distortion: Sequence[float],
    told_px: Sequence[Sequence[float] | None],
) -> None:
    """Project keypoints anew and add to the findings what differs.

    Parameters
    ----------
    found : Findings
    where : str
        For the message.
    points_in_target : (k, 3) array, m
    pose : (9 floats, 3 floats)
        R row by row, and t in m, of ``x_cam = R x_target + t``.
    camera : 4 floats, px
        fx, fy, cx, cy.
    distortion : 5 floats
    told_px : sequence of (x, y) or None
        As written; None where nothing is told.
    """
    if len(told_px) != len(points_in_target):
        found.faults.append(
            f"{where}: expected {len(points_in_target)} keypoints, got {len(told_px)}"
        )
        return
    rotation, translation = np.reshape(pose[0], (3, 3)), np.array(pose[1], dtype=np.float64)
    fx, fy, cx, cy = camera
    matrix = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    for point, told in zip(points_in_target, told_px, strict=True):
        if told is None:
            continue
        anew, _ = cv2.projectPoints(
            point[None], cv2.Rodrigues(rotation)[0], translation, matrix, np.array(distortion)
        )
        apart = float(np.linalg.norm(anew.ravel() - np.array(told)))
        found.keypoints += 1
        found.reprojection_px = max(found.reprojection_px, apart)
        if not apart <= REPROJECTED_PX:
            found.faults.append(
                f"{where}: expected a keypoint within {REPROJECTED_PX} px of its projection, "
                f"got {apart:.3g} px"
            )


def decoded(counts: str, height: int, width: int) -> AnyArray:
    """Return the mask of COCO's packed run lengths, (height, width) of bool.

    Parameters
    ----------
    counts : str
    height, width : int, px

    Raises
    ------
    DatasetError
        If they are not those of a mask of that size.
    """
    lengths: list[int] = []
    value = shift = 0
    for character in counts:
        group = ord(character) - 48
        value |= (group & 31) << shift
        shift += 5
        if not group & 32:
            value -= (1 << shift) if group & 16 else 0
            lengths.append(value + (lengths[-2] if len(lengths) > 2 else 0))
            value = shift = 0
        if shift > 60 or len(lengths) > height * width + 1:
            break
    if any(each < 0 for each in lengths) or sum(lengths) != height * width:
        raise DatasetError(f"expected run lengths of {height} x {width} pixels, got others")
    return np.repeat(np.arange(len(lengths)) % 2 == 1, lengths).reshape((width, height)).T


def check_mask(
    found: Findings, where: str, mask: AnyArray, count: int, box: Sequence[int] | None
) -> None:
    """Hold a mask against how many pixels it is said to have, and their box.

    Parameters
    ----------
    found : Findings
    where : str
    mask : (height, width) array of bool
    count : int
    box : 4 ints or None
        x0, y0, x1, y1, both ends belonging to it.
    """
    rows, columns = np.nonzero(mask)
    drawn = (
        [int(x) for x in (columns.min(), rows.min(), columns.max(), rows.max())]
        if len(rows)
        else None
    )
    if len(rows) != count:
        found.faults.append(f"{where}: expected a mask of {count} pixels, got {len(rows)}")
    if drawn != (None if box is None else list(box)):
        found.faults.append(f"{where}: expected the box {drawn} of its mask, got {box}")
