"""The cells that an image is cut into: where points fall among them, and those under a pose."""

from __future__ import annotations

import numpy as np

from models.arrays import AnyArray, Floats, Indices
from models.camera import Camera
from models.pose import RigidTransform

NEAREST_M = 1e-3


def points_in_cells(
    points: Floats, camera: Camera, pose: RigidTransform, cell_px: float, corner_px: Floats
) -> tuple[Floats, Floats, Indices]:
    """Return points in camera axes, (n, 3) m, their depths, (n,) m, and their cells, (n, 2).

    By the pinhole alone, without distortion.

    Parameters
    ----------
    points : (n, 3) array, m
        In the target frame.
    camera : Camera
    pose : RigidTransform
        ``cam_from_target``.
    cell_px : float, px
    corner_px : (2,) array, px
        Of the first cell's outer corner.
    """
    in_cam = points @ pose.rotation.T + pose.translation
    depth = np.maximum(in_cam[:, 2], NEAREST_M)
    flat = in_cam[:, :2] / depth[:, None] * np.array([camera.fx, camera.fy])
    flat += np.array([camera.cx, camera.cy])
    return in_cam, depth, np.floor((flat - corner_px) / cell_px).astype(np.int64)


def cells_under(
    cells: AnyArray, corner: Indices, shape: tuple[int, ...], beyond: float
) -> AnyArray:
    """Return an image's cells under another grid of the same cells, and ``beyond`` where it ends.

    Parameters
    ----------
    cells : (rows, columns) array
    corner : (2,) array of int
        Column and row of the other grid's first cell among the image's.
    shape : (int, int)
        Height and width of the other grid.
    beyond : float

    Returns
    -------
    (height, width) array
    """
    height, width = shape
    corner_column, corner_row = corner.tolist()
    found = np.full((height, width), beyond, dtype=cells.dtype)
    rows, columns = cells.shape
    left, top = max(0, corner_column), max(0, corner_row)
    right, bottom = min(columns, corner_column + width), min(rows, corner_row + height)
    if right > left and bottom > top:
        found[
            top - corner_row : bottom - corner_row, left - corner_column : right - corner_column
        ] = cells[top:bottom, left:right]
    return found
