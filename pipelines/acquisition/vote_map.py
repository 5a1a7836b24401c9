"""How well a pose's landmarks fall on image points, for thousands of poses: a map of votes."""

from __future__ import annotations

import cv2
import numpy as np

from models.arrays import Floats

CELLS_PER_REACH = 4.0
MOST_CELLS = 4096  # along an axis
LEAST_DEPTH_M = 1e-3


class VoteMap:
    """A raster over the image in which each cell holds the vote of a landmark that falls there.

    A vote is ``1 - (d / reach)^2`` at a distance d from the nearest point, and zero beyond.

    Parameters
    ----------
    away_px : (n, 2) array, px
        Undistorted points, relative to the principal point.
    reach_px : float, px
    """

    def __init__(self, away_px: Floats, reach_px: float) -> None:
        low = away_px.min(axis=0) - reach_px
        high = away_px.max(axis=0) + reach_px
        self._cell_px = max(reach_px / CELLS_PER_REACH, float((high - low).max()) / MOST_CELLS)
        shape = np.ceil((high - low) / self._cell_px).astype(np.int64) + 3
        self._low = low - self._cell_px  # the outermost cells stay empty
        empty = np.ones(shape[::-1], dtype=np.uint8)
        columns, rows = np.floor((away_px - self._low) / self._cell_px).astype(np.int64).T
        empty[rows, columns] = 0
        distance = cv2.distanceTransform(empty, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        votes = np.maximum(1.0 - (distance * (self._cell_px / reach_px)) ** 2, 0.0)
        votes[[0, -1]] = 0.0
        votes[:, [0, -1]] = 0.0
        self._votes = votes.astype(np.float32).reshape(-1)
        self._shape = (int(shape[1]), int(shape[0]))

    def votes_for(
        self, rotations: Floats, translations: Floats, points_in_target: Floats, focal_px: float
    ) -> Floats:
        """Return the sum of votes of each pose.

        Parameters
        ----------
        rotations : (p, 3, 3) array
        translations : (p, 3) array, m
            ``cam_from_target``.
        points_in_target : (m, 3) array, m
        focal_px : float, px

        Returns
        -------
        (p,) array
        """
        scale = focal_px / self._cell_px
        turns = rotations.astype(np.float32)
        turns[:, :2] *= scale
        shifts = translations.astype(np.float32)
        shifts[:, :2] *= scale
        in_cam = turns.reshape(-1, 3) @ points_in_target.T.astype(np.float32)
        in_cam = in_cam.reshape(len(turns), 3, -1)
        in_cam += shifts[:, :, None]
        np.maximum(in_cam[:, 2], np.float32(LEAST_DEPTH_M), out=in_cam[:, 2])
        height, width = self._shape
        cells = in_cam[:, :2] / in_cam[:, 2:]
        cells -= (self._low / self._cell_px).astype(np.float32)[:, None]
        columns = np.clip(cells[:, 0], 0, width - 1).astype(np.int32)
        rows = np.clip(cells[:, 1], 0, height - 1).astype(np.int32)
        rows *= width
        rows += columns
        return self._votes[rows].sum(axis=1).astype(np.float64)
