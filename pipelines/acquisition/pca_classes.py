"""Which image points lie far along the target's principal directions: the classes B1 and B2.

Source: Pesce et al. 2019, section III, equations 1 to 3. Equation 2 is meant of ``p - centroid``;
and what it calls the distance from an axis is the distance along it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Indices, Mask


@dataclass(frozen=True, eq=False)
class PcaClasses:
    """Points far from the centroid along each principal direction.

    Attributes
    ----------
    first, second : (n,) arrays of bool
        B1 and B2; the first direction is the one along which the points spread most.
    threshold_px : float, px
        D_th: mean distance of the points from their centroid.
    """

    first: Mask
    second: Mask
    threshold_px: float

    @property
    def either(self) -> Indices:
        """Indices of the points in one class or both."""
        return np.flatnonzero(self.first | self.second)


def pca_classes(points_px: Floats) -> PcaClasses:
    """Classify the points of one image.

    Parameters
    ----------
    points_px : (n, 2) array, px
        At least one point.
    """
    away = points_px - points_px.mean(axis=0)
    spread = away.T @ away / len(away)  # equation 1
    _, directions = np.linalg.eigh(spread)
    along = np.abs(away @ directions[:, ::-1])  # equation 2
    threshold = float(np.linalg.norm(away, axis=1).mean())
    return PcaClasses(along[:, 0] > threshold, along[:, 1] > threshold, threshold)
