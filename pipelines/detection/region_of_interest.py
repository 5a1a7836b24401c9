"""The part of an image in which markers are looked for (Opromolla et al. 2022, equation 15)."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats
from models.camera import Camera
from pipelines.detection.image_difference import Region


def region_of_interest(
    camera: Camera,
    predicted_px: Floats,
    share: tuple[float, float],
    margin_px: Floats | float = 0.0,
) -> Region | None:
    """Return the region round predicted markers, within the image.

    Parameters
    ----------
    camera : Camera
    predicted_px : (n, 2) array, px
        NaN for a marker that cannot be seen.
    share : tuple of 2 floats
        How much of the larger extent of the pattern is added on each side, in u and in v.
    margin_px : (2,) array or float, px
        What is added besides.

    Returns
    -------
    Region or None
        None where it lies outside the image, or no marker can be seen.
    """
    seen = predicted_px[np.isfinite(predicted_px).all(axis=1)]
    if len(seen) == 0:
        return None
    extent = float(np.ptp(seen, axis=0).max())
    added = np.array(share) * extent + margin_px
    size = np.array([camera.width, camera.height])
    low = np.clip(np.floor(seen.min(axis=0) - added), 0, size).astype(int)
    high = np.clip(np.ceil(seen.max(axis=0) + added) + 1, 0, size).astype(int)
    if (high - low < 2).any():
        return None
    return Region(int(low[1]), int(high[1]), int(low[0]), int(high[0]))
