"""The Cramér-Rao bound of an attitude from a star frame: of every star's place, then of all.

Each star's image has four unknowns, its place, its light and the light about it. What noise leaves
to be known of the place, by the mean charge that the renderer made and by finite differences of its
own spots, is summed over the stars as information on three small turns.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Mask
from models.sensors.star_camera import StarCamera
from pipelines.star_attitude.onboard_catalogue import OnboardCatalogue
from renders.detector.point_lights import add_points
from renders.star_images.star_view import StarView
from renders.star_images.starlight import places_of, stars_in_view

HALF_PX = 7
STEP_PX, STEP_RAD = 1e-3, 1e-6


def attitude_bound(
    view: StarView, mean_e: Floats, sensor: StarCamera, catalogue: OnboardCatalogue
) -> Floats:
    """Return the least covariance of an attitude, (3, 3), rad2, camera axes.

    Parameters
    ----------
    view : StarView
    mean_e : (height, width) array, e
        Expected charge, as rendered.
    sensor : StarCamera
    catalogue : OnboardCatalogue
        Of its stars all count that are before the camera and have no neighbour.
    """
    in_cam, magnitude, row = stars_in_view(view, sensor)
    known = np.flatnonzero(row < len(catalogue.magnitude))  # both are sorted by magnitude
    known = known[~catalogue.crowded[row[known]]]
    information = place_information(
        in_cam[known], sensor.electrons(magnitude[known]), mean_e, view, sensor
    )
    turned = [
        sensor.camera.project(in_cam[known] + np.cross(STEP_RAD * axis, in_cam[known]))
        for axis in np.eye(3)
    ]
    still = sensor.camera.project(in_cam[known])
    slopes = (np.stack(turned, axis=-1) - still[..., None]) / STEP_RAD
    return np.linalg.inv(np.einsum("nik,nij,njl->kl", slopes, information, slopes))


def place_information(
    in_cam: Floats, electrons: Floats, mean_e: Floats, view: StarView, sensor: StarCamera
) -> Floats:
    """Return the information on stars' places, (n, 2, 2), 1/px2, whatever their light is.

    Parameters
    ----------
    in_cam : (n, 3) array
    electrons : (n,) array, e
    mean_e : (height, width) array, e
    view : StarView
    sensor : StarCamera
    """
    places = places_of(in_cam, view, sensor)
    middle = np.rint(places.mean(axis=0)).astype(np.int64)
    spots = [
        _windows(places - middle + shift, sensor.optics.psf_sigma_px)
        for shift in STEP_PX * np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]])
    ]
    light = electrons[:, None, None]
    rows = np.stack(
        [
            light * (spots[1] - spots[2]) / (2.0 * STEP_PX),
            light * (spots[3] - spots[4]) / (2.0 * STEP_PX),
            spots[0],
            np.ones_like(spots[0]),
        ],
        axis=1,
    )
    charge, there = _around(mean_e, middle)
    detector = sensor.detector
    variance = charge + detector.read_noise_e**2 + detector.gain_e_dn**2 / 12.0
    weight = there * (charge < detector.full_well_e) / variance
    whole = np.einsum("nipq,npq,njpq->nij", rows, weight, rows)
    nuisance = whole[:, 2:, 2:] + 1e-12 * np.eye(2)
    across = whole[:, :2, 2:]
    return whole[:, :2, :2] - across @ np.linalg.solve(nuisance, across.swapaxes(1, 2))


def _windows(places: Floats, sigma_px: float) -> Floats:
    """Draw spots of one electron in windows of their own, (n, rows, columns)."""
    count, side = places.shape[1], 2 * HALF_PX + 1
    strip = np.zeros((side, side * count))
    own = HALF_PX + side * np.arange(count)
    for each in places:
        pixels = np.stack([each[:, 0] + own, each[:, 1] + HALF_PX], axis=1)
        add_points(strip, pixels, np.full(count, 1.0 / len(places)), sigma_px)
    return strip.reshape(side, count, side).swapaxes(0, 1)


def _around(mean_e: Floats, middle: Floats) -> tuple[Floats, Mask]:
    around = np.arange(-HALF_PX, HALF_PX + 1)
    rows = (middle[:, 1, None] + around)[:, :, None]
    columns = (middle[:, 0, None] + around)[:, None, :]
    height, width = mean_e.shape
    there = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
    return mean_e[np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)], there
