"""Star frames of a small camera, drawn by a seed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from bench.suites.vinag2018.star_survey import Sky, drawn_view
from models.arrays import Floats, Image
from models.sensors.star_camera import StarCamera, star_camera
from pipelines.star_attitude.star_sensor import StarFix
from renders.star_images.star_frame import star_frame
from renders.star_images.star_view import StarView

SMALL = star_camera(512)
"""As wide a field and lens as the full one, a quarter of the pixels: four times as quick."""


def frame_of(sky: Sky, number: int, sensor: StarCamera = SMALL) -> tuple[StarView, Image]:
    """Return what a camera looks at, and the frame."""
    view = drawn_view(sky, sensor, 7, number)
    return view, star_frame(view, sensor, (7, number, 0))


def starless(view: StarView, false_px: Floats, false_mag: Floats) -> Image:
    """Return a frame of spots alone: the lens is turned to where no star of the table shines."""
    blind = replace(SMALL, band_nm=(400.0, 400.0))
    image = star_frame(replace(view, discs=()), blind, (7, 0, 1)).astype(np.float64)
    own = StarView(view.cam_from_icrs, false_px=false_px, false_mag=false_mag)
    return np.clip(image + _spots_dn(own), 0, SMALL.detector.max_dn).astype(np.uint16)


def _spots_dn(view: StarView) -> Floats:
    from renders.detector.point_lights import add_points

    charge = np.zeros((SMALL.camera.height, SMALL.camera.width))
    add_points(charge, view.false_px, SMALL.electrons(view.false_mag), SMALL.optics.psf_sigma_px)
    return np.rint(charge / SMALL.detector.gain_e_dn)


def off_arcsec(fix: StarFix, view: StarView) -> Floats:
    """Return the rotation vector from the truth to what was found, (3,), arcsec."""
    assert fix.cam_from_icrs is not None
    turn = Rotation.from_matrix(fix.cam_from_icrs @ view.cam_from_icrs.T)
    return np.rad2deg(turn.as_rotvec()) * 3600.0
