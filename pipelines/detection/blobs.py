"""Connected blobs of a binary image (8-connected, as MATLAB's and OpenCV's default)."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from models.arrays import Floats, Indices, Mask


@dataclass(frozen=True, eq=False)
class Blobs:
    """The blobs of one binary image.

    Attributes
    ----------
    rows, columns : (m,) int arrays
        The foreground pixels.
    label : (m,) int array
        Which blob each belongs to, from 0.
    area_px : (n,) array, px
        Pixels of each blob.
    foreground : (height, width) array of bool
        All of them, to look at neighbours.
    """

    rows: Indices
    columns: Indices
    label: Indices
    area_px: Floats
    foreground: Mask

    def __len__(self) -> int:
        return len(self.area_px)

    def kept(self, keep: Mask) -> Blobs:
        """Return only the blobs marked True, numbered anew.

        Parameters
        ----------
        keep : (n,) array of bool
        """
        pixels = keep[self.label]
        renumbered = np.cumsum(keep) - 1
        return Blobs(
            rows=self.rows[pixels],
            columns=self.columns[pixels],
            label=renumbered[self.label[pixels]],
            area_px=self.area_px[keep],
            foreground=self.foreground,
        )

    def bounding_boxes(self) -> Indices:
        """Return (n, 4): first row, last row, first column, last column."""
        boxes = np.empty((len(self), 4), dtype=np.int64)
        for axis, where in ((0, self.rows), (2, self.columns)):
            low = np.full(len(self), np.iinfo(np.int64).max)
            high = np.full(len(self), -1)
            np.minimum.at(low, self.label, where)
            np.maximum.at(high, self.label, where)
            boxes[:, axis], boxes[:, axis + 1] = low, high
        return boxes


def find_blobs(foreground: Mask) -> Blobs:
    """Label the 8-connected blobs of a binary image.

    Parameters
    ----------
    foreground : (height, width) array of bool
    """
    mask = foreground.astype(np.uint8)
    left, top, width, height = cv2.boundingRect(mask)
    if width == 0 or height == 0:
        none = np.zeros(0, dtype=np.int64)
        return Blobs(none, none, none, np.zeros(0), foreground)
    crop = np.ascontiguousarray(mask[top : top + height, left : left + width])
    count, labels = cv2.connectedComponents(crop, connectivity=8)
    rows, columns = np.nonzero(crop)
    label = labels[rows, columns].astype(np.int64) - 1
    area = np.bincount(label, minlength=count - 1).astype(np.float64)
    return Blobs(rows + top, columns + left, label, area, foreground)
