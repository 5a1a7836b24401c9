"""Which pixel centres the target covers, whatever stands before it and however far out it reaches.

The renders' labels tell what each pixel shows. What is behind something else, or beyond the
image's edge, they do not: that is found here, by filling projected triangles row by row. No
renderer is loaded for it. A lens that distorts bends straight edges, so triangles are filled as an
ideal lens would show them, and that picture is bent.
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
CHUNK_ROWS = 128  # of a canvas bent at once


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
    pixels = corners[..., :2] / corners[..., 2:] * [camera.fx, camera.fy] + [camera.cx, camera.cy]
    canvas = filled(pixels + np.array([left, top]), width + 2 * left, height + 2 * top)
    if camera.distorted:
        return _bent(canvas, camera, left, top)
    box = box_of(canvas)
    if box is not None:
        box = (box[0] - left, box[1] - top, box[2] - left, box[3] - top)
    inside = canvas[top : top + height, left : left + width]
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
    y = np.arange(int(counts.sum())) - np.repeat(np.cumsum(counts) - counts - low[chosen], counts)
    left, right = np.full(len(y), np.inf), np.full(len(y), -np.inf)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        (xa, ya), (xb, yb) = triangles[chosen, a].T, triangles[chosen, b].T
        with np.errstate(divide="ignore", invalid="ignore"):
            slope = (xb - xa) / (yb - ya)
        lowest, highest = np.minimum(ya, yb), np.where(ya == yb, -np.inf, np.maximum(ya, yb))
        crossed = (np.repeat(lowest, counts) <= y) & (y <= np.repeat(highest, counts))
        owner = np.repeat(np.arange(len(chosen)), counts)[crossed]
        x = xa[owner] + (y[crossed] - ya[owner]) * slope[owner]
        left[crossed] = np.minimum(left[crossed], x)
        right[crossed] = np.maximum(right[crossed], x)
    height, wide = steps.shape
    first = np.ceil(np.clip(left, 0.0, wide - 1.0)).astype(np.int64)
    last = np.floor(np.clip(right, -1.0, wide - 2.0)).astype(np.int64)
    some = (first <= last) & np.isfinite(left)
    row = y[some] * wide
    for place, step in ((row + first[some], 1), (row + last[some] + 1, -1)):
        steps += step * np.bincount(place, minlength=height * wide).reshape(height, wide)


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


def _bent(canvas: Mask, camera: Camera, left: int, top: int) -> Silhouette:
    """Return what a lens that distorts makes of an ideal lens's canvas.

    Pixels of the image look up what their ray meets. Beyond the image each place of the canvas
    counts as the area that the lens makes of it.
    """
    inside = _seen_through(canvas, camera, left, top)
    count, boxes = float(np.count_nonzero(inside)), [box_of(inside)]
    for start in range(0, len(canvas), CHUNK_ROWS):
        rows = canvas[start : start + CHUNK_ROWS + 1]  # one more, for the last row's slope
        if len(rows) < 2 or not rows.any():
            continue
        v, u = np.indices(rows.shape, dtype=np.float64)
        ideal = np.stack([u - left - camera.cx, v + start - top - camera.cy], axis=-1)
        ideal /= [camera.fx, camera.fy]
        bent = camera.distort(ideal) * [camera.fx, camera.fy] + [camera.cx, camera.cy]
        across, down = np.gradient(bent, axis=1), np.gradient(bent, axis=0)
        area = across[..., 0] * down[..., 1] - across[..., 1] * down[..., 0]
        beyond = rows & (np.linalg.norm(ideal, axis=-1) < camera.fold_radius)
        beyond &= ~camera.contains(bent)
        beyond[CHUNK_ROWS:] = False
        if beyond.any():
            count += float(area[beyond].sum())
            low, high = np.rint(bent[beyond].min(axis=0)), np.rint(bent[beyond].max(axis=0))
            boxes.append((int(low[0]), int(low[1]), int(high[0]), int(high[1])))
    held = np.array([box for box in boxes if box is not None], dtype=np.int64).reshape(-1, 4)
    if not len(held):
        return Silhouette(inside, 0, None)
    (x0, y0), (x1, y1) = held[:, :2].min(axis=0).tolist(), held[:, 2:].max(axis=0).tolist()
    return Silhouette(inside, round(count), (x0, y0, x1, y1))


def _seen_through(canvas: Mask, camera: Camera, left: int, top: int) -> Mask:
    """Return what each pixel of a lens that distorts meets of an ideal lens's canvas."""
    v, u = np.indices((camera.height, camera.width), dtype=np.float64)
    ideal = camera.normalise(np.stack([u, v], axis=-1).reshape(-1, 2))
    places = np.rint(ideal * [camera.fx, camera.fy] + [camera.cx + left, camera.cy + top])
    low, high = np.zeros(2), np.array(canvas.shape[::-1])
    held = np.asarray(((places >= low) & (places < high)).all(axis=1))
    columns, rows = np.where(held[:, None], places, 0).astype(np.int64).T
    return np.asarray((held & canvas[rows, columns]).reshape(camera.height, camera.width))
