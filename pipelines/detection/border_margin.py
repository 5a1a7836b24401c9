"""The border margin: a marker cut by the image's edge has its centroid in the wrong place."""

from __future__ import annotations

from models.arrays import Floats, Mask
from models.camera import Camera


def border_margin_px(radius_px: float, s_bord: float) -> float:
    """Return tau_bord (Opromolla et al. 2022, equation 7), px."""
    return round(radius_px) * s_bord


def inside_margin(points_px: Floats, camera: Camera, margin_px: float) -> Mask:
    """Tell which points lie at least ``margin_px`` from the image's edge, (n,).

    Parameters
    ----------
    points_px : (n, 2) array, px
    camera : Camera
    margin_px : float, px
    """
    return camera.contains(points_px.reshape(-1, 2), margin_px)
