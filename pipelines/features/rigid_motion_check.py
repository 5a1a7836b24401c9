"""Which tracks move as points of one rigid body do between two images.

Highlights slide over foil, shadows creep and the limb of a round body is another place in every
image: none of them keeps the epipolar geometry of the body's points for long.
"""

from __future__ import annotations

import cv2
import numpy as np

from models.arrays import Floats, Mask

FEWEST = 8  # tracks, below which nothing is told apart
THRESHOLD_PX = 1.0
CONFIDENCE = 0.999
LEAST_MOVE_PX = 3.0  # median; of a body that hardly moves no geometry is known
SEED = 1
MOST_DRAWS = 2000


def moves_rigidly(before_px: Floats, after_px: Floats, matrix: Floats) -> Mask:
    """Return which tracks agree with the motion that most of them share, (n,) bool.

    Parameters
    ----------
    before_px, after_px : (n, 2) array, px
        Undistorted pixels.
    matrix : (3, 3) array, px
        Calibration matrix K.
    """
    count = len(before_px)
    moved = np.linalg.norm(after_px - before_px, axis=1)
    if count < FEWEST or float(np.median(moved)) < LEAST_MOVE_PX:
        return np.ones(count, dtype=bool)
    cv2.setRNGSeed(SEED)
    _, inliers = cv2.findEssentialMat(
        before_px,
        after_px,
        matrix,
        method=cv2.RANSAC,
        prob=CONFIDENCE,
        threshold=THRESHOLD_PX,
        maxIters=MOST_DRAWS,
    )
    if inliers is None or int(np.sum(inliers)) < max(FEWEST, count // 2):
        return np.ones(count, dtype=bool)  # nothing that most agree on
    return np.asarray(inliers.ravel() > 0)
