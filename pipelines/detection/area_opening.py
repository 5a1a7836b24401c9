"""Area opening: blobs smaller than a share of the expected marker are noise.

Opromolla et al. 2022, equations 3 and 4.
"""

from __future__ import annotations

import numpy as np

from pipelines.detection.blobs import Blobs


def expected_radius_px(marker_radius_m: float, range_m: float, focal_px: float) -> float:
    """Return r_p, the radius of a marker's image (equation 4), px.

    Parameters
    ----------
    marker_radius_m : float, m
    range_m : float, m
    focal_px : float, px
    """
    return marker_radius_m / range_m * focal_px


def area_threshold_px(radius_px: float, s_ao: float) -> int:
    """Return tau_ao, the smallest area that may be a marker (equation 3), px."""
    return round(np.pi * radius_px**2 * s_ao)


def open_areas(blobs: Blobs, tau_ao: float) -> Blobs:
    """Discard the blobs that occupy less than ``tau_ao`` pixels."""
    return blobs.kept(blobs.area_px >= tau_ao)
