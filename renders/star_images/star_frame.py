"""One frame of a star camera: light, chip, particles. No Mitsuba: points and closed forms alone."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from models.arrays import Floats, Image, Indices
from models.sensors.star_camera import StarCamera
from renders.detector.expose import CHIP_SEED, expose_electrons, exposure_rng, pixel_response
from renders.detector.radiation_hits import radiation_hits
from renders.star_images.star_view import StarView
from renders.star_images.starlight import add_starlight
from renders.star_images.stray_light import add_stray_light


def star_frame(view: StarView, sensor: StarCamera, key: tuple[int, ...]) -> Image:
    """Expose one frame.

    Parameters
    ----------
    view : StarView
    sensor : StarCamera
    key : tuple of at least 3 int
        Of its random numbers.

    Returns
    -------
    (height, width) uint16 array, DN
    """
    return exposed(mean_charge(view, sensor), sensor, key)


def exposed(mean_e: Floats, sensor: StarCamera, key: tuple[int, ...]) -> Image:
    """Return a frame of the expected charge, (height, width) uint16, DN; see ``star_frame``.

    Parameters
    ----------
    mean_e : (height, width) array, e
    sensor : StarCamera
    key : tuple of at least 3 int
    """
    detector = sensor.detector
    particles = radiation_hits(sensor.radiation, detector, mean_e.shape, sensor.exposure_ms, key)
    return expose_electrons(mean_e, detector, exposure_rng(*key), particles)


def mean_charge(view: StarView, sensor: StarCamera) -> Floats:
    """Return the expected charge of each pixel, (height, width), e.

    Parameters
    ----------
    view : StarView
    sensor : StarCamera
    """
    detector, shape = sensor.detector, (sensor.camera.height, sensor.camera.width)
    charge = np.zeros(shape)
    add_starlight(charge, view, sensor)
    add_stray_light(charge, view, sensor)
    if detector.prnu > 0.0:
        charge *= pixel_response(*shape, detector.prnu)
    charge += detector.dark_current_e_s * sensor.exposure_s
    rows, columns, rate_e_s = _hot_pixels(*shape, sensor.hot_share, sensor.hot_e_s)
    charge[rows, columns] += rate_e_s * sensor.exposure_s
    return charge


@lru_cache(maxsize=4)
def _hot_pixels(
    height: int, width: int, share: float, median_e_s: float
) -> tuple[Indices, Indices, Floats]:
    """Return rows, columns and dark currents of the pixels of one chip that are hot."""
    rng = np.random.default_rng([CHIP_SEED, height, width])
    count = round(share * height * width)
    place = rng.choice(height * width, count, replace=False)
    rate = median_e_s * np.exp(rng.standard_normal(count))
    return place // width, place % width, rate
