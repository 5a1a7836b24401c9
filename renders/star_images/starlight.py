"""Starlight on the chip of a star camera that turns while its shutter is open."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Indices
from models.sensors.star_camera import StarCamera
from models.sky.aberration import aberrated
from models.sky.hipparcos import hipparcos_stars
from renders.detector.point_lights import add_points
from renders.star_images.star_view import StarView

STEP_PX = 0.2  # from one instant of a moving star to the next
MARGIN_PX = 12.0  # beside the chip, from which spread and motion bring light onto it


def stars_in_view(
    view: StarView, sensor: StarCamera, margin_px: float = 0.0
) -> tuple[Floats, Floats, Indices]:
    """Return the stars before the camera at the middle of the exposure.

    Parameters
    ----------
    view : StarView
    sensor : StarCamera
    margin_px : float, px
        Beside the chip that counts, too.

    Returns
    -------
    in_cam : (n, 3) array
        Unit vectors, as the stars seem to stand.
    magnitude : (n,) array
    row : (n,) int array
        In the catalogue.
    """
    stars, camera = hipparcos_stars(), sensor.camera
    in_cam = aberrated(stars.directions_in_icrs, view.velocity_m_s) @ view.cam_from_icrs.T
    corner = camera.rays(camera.spread_px(1))[:, 2].min() - 0.1
    near = np.flatnonzero(in_cam[:, 2] > corner)
    pixels = camera.project(in_cam[near])
    row = near[camera.contains(pixels, -margin_px)]
    return in_cam[row], stars.magnitude[row], row


def add_starlight(charge: Floats, view: StarView, sensor: StarCamera) -> None:
    """Add the stars' charge, and that of what looks like stars, to the chip's.

    A star is drawn at instants evenly within the exposure, as many as the fastest needs.

    Parameters
    ----------
    charge : (height, width) array, e
        Is changed.
    view : StarView
    sensor : StarCamera
    """
    in_cam, magnitude, _ = stars_in_view(view, sensor, MARGIN_PX)
    electrons, sigma = sensor.electrons(magnitude), sensor.optics.psf_sigma_px
    places = places_of(in_cam, view, sensor)
    for pixels in places:
        add_points(charge, pixels, electrons / len(places), sigma)
    add_points(charge, view.false_px, sensor.electrons(view.false_mag), sigma)


def places_of(in_cam: Floats, view: StarView, sensor: StarCamera) -> Floats:
    """Return where stars stand at instants of the exposure, (instants, n, 2), px.

    Parameters
    ----------
    in_cam : (n, 3) array
        In the middle of it.
    view : StarView
    sensor : StarCamera
    """
    camera = sensor.camera
    angle = float(np.linalg.norm(view.rate_in_cam_rad_s)) * sensor.exposure_s
    count = 1 + int(np.ceil(angle * max(camera.fx, camera.fy) / STEP_PX))
    instants_s = ((np.arange(count) + 0.5) / count - 0.5) * sensor.exposure_s
    # A star that stands still in space turns backwards in the camera.
    turns = np.cross(view.rate_in_cam_rad_s, in_cam)
    return np.stack([camera.project(in_cam - each * turns) for each in instants_s.tolist()])
