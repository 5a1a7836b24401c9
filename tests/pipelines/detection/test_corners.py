"""Corners of drawings whose corners are known."""

from __future__ import annotations

import cv2
import numpy as np

from models.arrays import Floats, Image
from pipelines.detection.corners import corners_of, find_corners
from pipelines.detection.target_region import find_target
from tests.support.drawn_targets import DETECTOR

SIZE = 256
BIAS_PX = 0.03  # of the mean over 64 corners of 0.08 px each; half a pixel would be far outside
RMS_PX = 0.12  # per axis; measured 0.08, unrefined it is 0.9
NOISE_DN = 0.5
REACH_PX = 6.0  # how far a bright corner's smoothed light stands out of the noise: 4 sigma and 1 px


def quadrangle(turn_deg: float, centre: tuple[float, float], side: float) -> Floats:
    angle = np.deg2rad(turn_deg) + np.pi / 2.0 * np.arange(4) + np.pi / 4.0
    return np.array(centre) + side / np.sqrt(2.0) * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def picture(corners: Floats, seed: int) -> Image:
    """Draw a bright polygon on black, each pixel the mean of 64 places, blurred as by a lens."""
    fine = np.zeros((8 * SIZE, 8 * SIZE), np.uint8)
    at = np.rint(((corners + 0.5) * 8.0 - 0.5) * 16.0).astype(np.int32)
    cv2.fillConvexPoly(fine, at, 255, lineType=cv2.LINE_8, shift=4)
    mean = cv2.resize(fine.astype(np.float32), (SIZE, SIZE), interpolation=cv2.INTER_AREA) / 255.0
    mean = cv2.GaussianBlur(mean, (0, 0), 0.5) * 1500.0 + 100.0
    noise = np.random.default_rng([46, seed]).normal(0.0, NOISE_DN, mean.shape)
    return np.asarray(np.clip(np.rint(mean + noise), 0, 4095).astype(np.uint16))


def misses(found: Floats, corners: Floats) -> Floats:
    """Return found minus drawn, for each drawn corner that was found within 3 px."""
    if len(found) == 0:
        return np.zeros((0, 2))
    away = found[:, None] - corners[None]
    nearest = np.linalg.norm(away, axis=2).argmin(axis=0)
    gap = away[nearest, np.arange(len(corners))]
    return gap[np.linalg.norm(gap, axis=1) < 3.0]


def test_drawn_corners_are_found_without_bias() -> None:
    parts = []
    for seed in range(16):
        rng = np.random.default_rng([47, seed])
        centre = (float(rng.uniform(110, 145)), float(rng.uniform(110, 145)))
        corners = quadrangle(float(rng.uniform(8, 82)), centre, 90.0)
        target = find_target(picture(corners, seed), DETECTOR)
        parts.append(misses(corners_of(target, DETECTOR).points_px, corners))
    found = np.concatenate(parts)
    assert len(found) >= 0.9 * 64
    assert np.abs(found.mean(axis=0)).max() < BIAS_PX
    assert np.sqrt((found**2).mean()) < RMS_PX


def test_nothing_is_found_where_nothing_shines() -> None:
    noise = np.random.default_rng(48).normal(100.0, NOISE_DN, (SIZE, SIZE))
    sky = np.clip(np.rint(noise), 0, 4095).astype(np.uint16)
    assert not find_target(sky, DETECTOR)
    assert len(find_corners(sky, DETECTOR)) == 0


def test_stars_are_no_target() -> None:
    rng = np.random.default_rng(49)
    sky = np.rint(rng.normal(100.0, NOISE_DN, (SIZE, SIZE))).astype(np.uint16)
    for row, column in rng.integers(5, SIZE - 5, (25, 2)):
        sky[row, column] += rng.integers(50, 1500)
    corners = quadrangle(30.0, (128.0, 128.0), 60.0)
    both = np.maximum(sky, picture(corners, 1))
    assert not find_target(sky, DETECTOR)
    lit = find_target(both, DETECTOR).lit
    row, column = np.nonzero(lit)
    assert np.hypot(row - 128.0, column - 128.0).max() < 60.0 / np.sqrt(2.0) + REACH_PX


def test_sigma_tells_noise() -> None:
    corners = quadrangle(30.0, (128.0, 128.0), 90.0)
    bright = picture(corners, 3)
    dim = np.rint(100.0 + (bright.astype(float) - 100.0) / 100.0).astype(np.uint16)
    at_bright = find_corners(bright, DETECTOR)
    at_dim = find_corners(dim, DETECTOR)
    assert len(at_bright)
    assert len(at_dim)
    assert at_dim.sigma_px.min() > at_bright.sigma_px.min()
