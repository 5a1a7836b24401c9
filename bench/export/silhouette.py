"""Which pixel centres the target covers, whatever stands before it and however far out it reaches.

The renders' labels tell what each pixel shows. What is behind something else, or beyond the
image's edge, they do not: that is found here, by filling projected triangles row by row. No
renderer is loaded for it. A lens that distorts bends straight edges, so triangles are cut until
theirs are short.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import AnyArray, Floats, Indices, Mask
from models.camera import Camera
from models.pose import RigidTransform

NEAR_M = 0.01  # what is nearer to the lens has no picture
AROUND = 1  # image sizes on each side of the image, within which a silhouette is followed
MOST_ROWS = 4_000_000  # of triangles filled at once
SHORT_PX = 12.0  # a side so short is straight to a hundredth of a pixel, whatever the lens
MOST_SPLITS = 12
FAR_SIDES = 6.0  # image sizes from the boresight, beyond which nothing comes back into the canvas


@dataclass(frozen=True, eq=False)
class Silhouette:
    """The target alone, as the camera would show it.

    Attributes
    ----------
    inside : (height, width) array of bool
        Pixels of the image.
    count : int
        Pixels in all, those beyond the image's edge too.
    box : (int, int, int, int) or None, px
        Least and greatest column and row: ``x0, y0, x1, y1``, both ends belonging to it; it may
        leave the image. None where nothing is covered.
    """

    inside: Mask
    count: int
    box: tuple[int, int, int, int] | None


def silhouette(
    vertices_in_target: Floats, faces: Indices, camera: Camera, cam_from_target: RigidTransform
) -> Silhouette:
    """Return the silhouette of a mesh.

    Parameters
    ----------
    vertices_in_target : (n, 3) array, m
    faces : (f, 3) array of int
    camera : Camera
        The true one.
    cam_from_target : RigidTransform
    """
    width, height = camera.width, camera.height
    left, top = AROUND * width, AROUND * height
    in_cam = cam_from_target @ vertices_in_target
    corners = _in_front(in_cam, faces)
    if camera.distorted:
        corners = _split(corners, camera)
    pixels = camera.project(corners)
    pixels = pixels[np.isfinite(pixels).all(axis=(1, 2))]
    canvas = filled(pixels + np.array([left, top]), width + 2 * left, height + 2 * top)
    inside = canvas[top : top + height, left : left + width]
    box = box_of(canvas)
    if box is not None:
        box = (box[0] - left, box[1] - top, box[2] - left, box[3] - top)
    return Silhouette(inside, int(np.count_nonzero(canvas)), box)


def box_of(mask: Mask) -> tuple[int, int, int, int] | None:
    """Return the least and greatest column and row of a (height, width) mask: x0, y0, x1, y1."""
    columns, rows = np.flatnonzero(mask.any(axis=0)), np.flatnonzero(mask.any(axis=1))
    if not len(columns):
        return None
    return int(columns[0]), int(rows[0]), int(columns[-1]), int(rows[-1])


def filled(triangles: Floats, width: int, height: int) -> Mask:
    """Tell which pixel centres lie in any triangle, edges included.

    Parameters
    ----------
    triangles : (f, 3, 2) array, px
        Any of them may reach out of the picture.
    width, height : int, px

    Returns
    -------
    (height, width) array of bool
    """
    steps = np.zeros((height, width + 1), dtype=np.int32)
    low = np.clip(np.ceil(triangles[..., 1].min(axis=1)), 0, height).astype(np.int64)
    high = np.clip(np.floor(triangles[..., 1].max(axis=1)), -1, height - 1).astype(np.int64)
    beside = (triangles[..., 0].max(axis=1) < 0.0) | (triangles[..., 0].min(axis=1) > width - 1.0)
    rows = np.where(beside, 0, np.maximum(high - low + 1, 0))
    there = np.flatnonzero(rows)
    ends = np.cumsum(rows[there])
    for start in range(0, int(ends[-1]) if len(ends) else 0, MOST_ROWS):
        first, last = np.searchsorted(ends, [start, start + MOST_ROWS], side="right")
        _fill(triangles, low, rows, there[first:last], steps)
    return np.asarray(np.cumsum(steps[:, :width], axis=1) > 0)


def _fill(triangles: Floats, low: Indices, rows: Indices, chosen: Indices, steps: AnyArray) -> None:
    """Add to each row where a triangle's stretch of it begins, and take away where it ends."""
    counts = rows[chosen]
    owner = np.repeat(chosen, counts)
    y = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts) + low[owner]
    left = np.full(len(owner), np.inf)
    right = np.full(len(owner), -np.inf)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        (xa, ya), (xb, yb) = triangles[owner, a].T, triangles[owner, b].T
        crossed = (np.minimum(ya, yb) <= y) & (y <= np.maximum(ya, yb)) & (ya != yb)
        with np.errstate(divide="ignore", invalid="ignore"):
            x = xa + (y - ya) * (xb - xa) / (yb - ya)
        left = np.where(crossed, np.minimum(left, x), left)
        right = np.where(crossed, np.maximum(right, x), right)
    width = steps.shape[1] - 1
    first = np.ceil(np.clip(left, 0.0, width)).astype(np.int64)
    last = np.floor(np.clip(right, -1.0, width - 1.0)).astype(np.int64)
    some = (first <= last) & np.isfinite(left) & np.isfinite(right)
    np.add.at(steps, (y[some], first[some]), 1)
    np.add.at(steps, (y[some], last[some] + 1), -1)


def _in_front(in_cam: Floats, faces: Indices) -> Floats:
    """Return the triangles in front of the lens, (f, 3, 3), cut where they reach behind it."""
    ahead = in_cam[:, 2] > NEAR_M
    count = ahead[faces].sum(axis=1)
    whole = in_cam[faces[count == 3]]
    pieces = [whole]
    for face in faces[(count == 1) | (count == 2)]:
        corners = in_cam[face]
        kept: list[Floats] = []
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            if a[2] > NEAR_M:
                kept.append(a)
            if (a[2] > NEAR_M) != (b[2] > NEAR_M):
                cut = a + (NEAR_M - a[2]) / (b[2] - a[2]) * (b - a)
                kept.append(np.array([cut[0], cut[1], NEAR_M]))
        pieces += [np.array([[kept[0], kept[k], kept[k + 1]]]) for k in range(1, len(kept) - 1)]
    return np.concatenate(pieces)


def _split(corners: Floats, camera: Camera) -> Floats:
    """Return triangles, (f, 3, 3), cut in four until they are small in the picture.

    What lies beyond the lens's fold, or far beside the canvas, is left out.
    """
    focal = np.array([camera.fx, camera.fy])
    far = FAR_SIDES * np.array([camera.width, camera.height]) / focal
    edge = np.minimum(camera.fold_radius, far)
    for _ in range(MOST_SPLITS):
        ideal = corners[..., :2] / corners[..., 2:]
        beside = (ideal > edge).all(axis=1) | (ideal < -edge).all(axis=1)
        corners, ideal = corners[~beside.any(axis=1)], ideal[~beside.any(axis=1)]
        sides = np.linalg.norm((ideal - np.roll(ideal, -1, axis=1)) * focal, axis=-1)
        large = sides.max(axis=1) > SHORT_PX
        if not large.any():
            break
        a, b, c = np.moveaxis(corners[large], 1, 0)
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        quarters = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        cut = [np.stack(each, axis=1) for each in quarters]
        corners = np.concatenate([corners[~large], *cut])
    return corners
