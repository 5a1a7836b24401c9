"""What a place looks like, and which lost track it is.

SIFT's descriptors (Lowe 2004); Volpe et al. 2017 name SURF, which SIFT stands for.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from models.arrays import Floats, Labels, Radiance

PATCH_PX = 14.0  # diameter that a place is described by
RATIO = 0.7  # of the best to the second distance (Lowe 2004)
FARTHEST = 110.0  # of two descriptors: the nearest of other places are 150 to 250 apart


def described(image: Labels, points_px: Floats) -> Radiance:
    """Return a descriptor of each place, (n, 128) float32.

    Parameters
    ----------
    image : (height, width) uint8 array
    points_px : (n, 2) array, px
    """
    if len(points_px) == 0:
        return np.zeros((0, 128), dtype=np.float32)
    places = [
        cv2.KeyPoint(float(x), float(y), PATCH_PX, _up(image, x, y), 1.0, 0, k)
        for k, (x, y) in enumerate(points_px.tolist())
    ]
    kept, found = cv2.SIFT_create().compute(image, places)
    table = np.full((len(points_px), 128), np.inf, dtype=np.float32)
    for place, row in zip(kept, found if found is not None else [], strict=True):
        table[place.class_id] = row
    return table


def recognised(lost: Radiance, found: Radiance) -> Sequence[tuple[int, int]]:
    """Return pairs of (lost, found) that look alike and like no other, both ways.

    Parameters
    ----------
    lost : (m, 128) array
    found : (n, 128) array
    """
    if len(lost) < 2 or len(found) < 2:
        return []
    apart = np.linalg.norm(lost[:, None].astype(float) - found[None].astype(float), axis=2)
    apart = np.where(np.isfinite(apart), apart, np.inf)
    pairs = []
    for one, row in enumerate(apart):
        other = int(row.argmin())
        second = float(np.partition(row, 1)[1])
        best = float(row[other])
        if best < FARTHEST and best < RATIO * second and int(apart[:, other].argmin()) == one:
            pairs.append((one, other))
    return pairs


def _up(image: Labels, x: float, y: float) -> float:
    """Return the direction in which a place brightens, deg: a turned image is described alike."""
    half = round(0.5 * PATCH_PX)
    row, column = round(y), round(x)
    patch = image[
        max(0, row - half) : row + half + 1, max(0, column - half) : column + half + 1
    ].astype(np.float32)
    if min(patch.shape) < 3:
        return 0.0
    down, right = np.gradient(patch)
    return float(np.rad2deg(np.arctan2(down.sum(), right.sum())) % 360.0)
