"""Centroids of blobs, weighted by intensity (Opromolla et al. 2022, equation 6)."""

from __future__ import annotations

import numpy as np

from models.arrays import AnyArray, Floats
from pipelines.detection.blobs import Blobs


def weighted_centroids(blobs: Blobs, intensity: AnyArray) -> Floats:
    """Return the centroids.

    Parameters
    ----------
    blobs : Blobs
    intensity : (height, width) array
        The difference image, not negative where there is a blob.

    Returns
    -------
    (n, 2) array, px: (u, v), pixel centres being integers.
    """
    weight = intensity[blobs.rows, blobs.columns].astype(np.float64)
    count = len(blobs)
    total = np.bincount(blobs.label, weights=weight, minlength=count)
    moments = [
        np.bincount(blobs.label, weights=weight * where, minlength=count)
        for where in (blobs.columns, blobs.rows)
    ]
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.stack(moments, axis=-1) / total[:, None]
