"""Centroids at their bound: many frames of the same spots, by the renderer's own spots."""

from dataclasses import replace

import numpy as np
import pytest

from bench.suites.vinag2018.star_bound import place_information
from models.sensors.camera_chip import Radiation
from pipelines.star_attitude.options import StarAttitudeOptions
from pipelines.star_attitude.spot_detection import spot_image, spot_peaks
from pipelines.star_attitude.spot_fit import fit_spots, fitted
from renders.detector.expose import expose_electrons, exposure_rng
from renders.detector.point_lights import add_points
from renders.star_images.star_view import StarView
from renders.star_images.starlight import places_of
from tests.support.star_frames import SMALL

OPTIONS = StarAttitudeOptions()
SENSOR = replace(
    SMALL, detector=replace(SMALL.detector, prnu=0.0), hot_share=0.0, radiation=Radiation()
)
FRAMES = 40
MAGNITUDES = np.array([1.0, 3.0, 5.0, 5.8])
PIXELS = np.stack(np.meshgrid(np.arange(40.0, 480.0, 40.0), np.arange(40.0, 480.0, 40.0)), -1)


def spots(rate=(0.0, 0.0, 0.0)):
    """Spots anywhere in their pixels, 121 of four brightnesses, and the mean charge they leave."""
    rng = np.random.default_rng(5)
    pixels = PIXELS.reshape(-1, 2) + rng.uniform(-0.5, 0.5, (PIXELS.size // 2, 2))
    magnitude = MAGNITUDES[np.arange(len(pixels)) % 4]
    view = StarView(np.eye(3), rate_in_cam_rad_s=np.array(rate))
    in_cam = SENSOR.camera.rays(pixels)
    light = SENSOR.electrons(magnitude)
    charge = np.full((512, 512), 12.0)
    places = places_of(in_cam, view, SENSOR)
    for each in places:
        add_points(charge, each, light / len(places), SENSOR.optics.psf_sigma_px)
    information = place_information(in_cam, light, charge, view, SENSOR)
    return pixels, charge, information, places[-1] - places[0]


@pytest.mark.parametrize("rate", [(0.0, 0.0, 0.0), (0.004, 0.02, 0.0)])
def test_errors_are_at_the_bound_and_stated(rate):
    """Squares over the bound's: mean 1 of 40 x 121 x 2 numbers (1.4 % for 1 sigma), unbiased."""
    pixels, charge, information, _ = spots(rate)
    peaks = np.rint(pixels).astype(np.int64)
    rays = SENSOR.camera.rays(pixels)
    half = 0.5 * SENSOR.exposure_s * np.cross(rate, rays)
    smears = SENSOR.camera.project(rays - half) - SENSOR.camera.project(rays + half)
    over_bound, over_stated, errors = [], [], []
    for frame in range(FRAMES):
        image = expose_electrons(charge, SENSOR.detector, exposure_rng(9, frame, 0))
        found = fitted(spot_image(image, SENSOR), peaks, smears, SENSOR)
        error = found.pixels - pixels
        errors.append(error)
        over_bound.append(np.einsum("ni,nij,nj->n", error, information, error))
        stated = np.linalg.inv(found.covariance_px2)
        over_stated.append(np.einsum("ni,nij,nj->n", error, stated, error))
    assert 0.93 < np.mean(over_bound) / 2.0 < 1.12
    assert 0.9 < np.mean(over_stated) / 2.0 < 1.1
    faint = np.arange(len(pixels)) % 4 == 3
    assert 0.85 < np.mean(np.array(over_bound)[:, faint]) / 2.0 < 1.2
    bias = np.mean(errors, axis=0)
    sigma = np.sqrt(np.diagonal(np.linalg.inv(information), axis1=1, axis2=2) / FRAMES)
    assert np.mean((bias / sigma) ** 2) < 1.35


def test_spots_are_found_and_what_is_none_is_left_out():
    """A hot pixel, a streak and a close pair go; stars stay."""
    pixels, charge, _, _ = spots()
    charge[100, 62] += 4000.0
    charge[180, 300:312] += 900.0
    add_points(charge, np.array([[220.0, 62.0], [222.4, 62.9]]), np.array([9e3, 7e3]), 0.7)
    seen = spot_image(expose_electrons(charge, SENSOR.detector, exposure_rng(1, 2, 3)), SENSOR)
    peaks = spot_peaks(seen, SENSOR, np.zeros(2), replace(OPTIONS, most_spots=300))
    found = fit_spots(seen, peaks, np.zeros((len(peaks), 2)), SENSOR, OPTIONS)
    nearest = np.linalg.norm(found.pixels[:, None] - pixels, axis=2)
    assert np.mean(nearest.min(axis=0) < 0.5) > 0.97
    assert nearest.min(axis=1).max() < 0.5
    assert (np.diff(found.electrons) <= 0.0).all()
