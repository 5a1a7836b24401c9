"""One step of Kanade, Lucas and Tomasi's tracker, there and back.

What does not come back to where it began was not followed: an edge that slid along itself, a
glint, a place that another part has covered (Kalal, Mikolajczyk and Matas, Forward-Backward Error,
2010; pyramids as by Bouguet 2000).
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from models.arrays import Floats, Labels, Mask

WINDOW_PX = 15
LEVELS = 3
FARTHEST_BACK_PX = 0.5
CRITERIA = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 30, 0.003)
MEDIAN_OF_SQUARE = 1.386  # of a two-vector's squared length, in its variance per axis


@dataclass(frozen=True, eq=False)
class Followed:
    """Points after a step.

    Attributes
    ----------
    points_px : (n, 2) array, px
    kept : (n,) bool array
        Whether they came back.
    step_sigma_px : float, px
        1 sigma per axis of one step, as the ways back tell it.
    """

    points_px: Floats
    kept: Mask
    step_sigma_px: float


def follow(before: Labels, after: Labels, points_px: Floats, guess_px: Floats) -> Followed:
    """Follow points from one image to the next and back.

    Parameters
    ----------
    before, after : (height, width) uint8 array
    points_px : (n, 2) array, px
        In the first; pixel centres are integers.
    guess_px : (n, 2) array, px
        Where they are thought to be in the second.
    """
    if len(points_px) == 0:
        return Followed(np.zeros((0, 2)), np.zeros(0, dtype=bool), 0.0)
    there, found = _step(before, after, points_px, guess_px)
    back, returned = _step(after, before, there, points_px)
    apart = np.sum((back - points_px) ** 2, axis=1)
    kept = found & returned & (apart < FARTHEST_BACK_PX**2)
    height, width = after.shape
    kept &= (there >= 0.0).all(axis=1) & (there <= [width - 1.0, height - 1.0]).all(axis=1)
    # There and back are two steps.
    sigma = float(np.sqrt(0.5 * np.median(apart[kept]) / MEDIAN_OF_SQUARE)) if kept.any() else 0.0
    return Followed(there, kept, sigma)


def _step(one: Labels, other: Labels, points: Floats, guess: Floats) -> tuple[Floats, Mask]:
    found, status, _ = cv2.calcOpticalFlowPyrLK(
        one,
        other,
        np.array(points, dtype=np.float32, order="C").reshape(-1, 1, 2),
        np.array(guess, dtype=np.float32, order="C").reshape(-1, 1, 2),
        winSize=(WINDOW_PX, WINDOW_PX),
        maxLevel=LEVELS,
        criteria=CRITERIA,
        flags=cv2.OPTFLOW_USE_INITIAL_FLOW,
    )
    return np.asarray(found[:, 0], dtype=np.float64), np.asarray(status[:, 0] == 1)
