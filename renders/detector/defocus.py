"""Defocus of a real lens: each pixel's light spreads over the circle that its depth gives it.

A thin lens of focal length ``f`` at ``f / N``, focused at ``s``, images a point at depth ``d`` as
an even disc of the diameter

    c = f^2 / N  |d - s| / (d (s - f))                                    on the chip

(Ray 2002, Applied Photographic Optics, chapter 22). Discs of whole pixels are made so that their
variance is the disc's own, ``c^2 / 16``, to the digit, down to none: light is averaged over square
pixels already. A pixel between two discs of the table is shared between them so that this holds
for any depth. Every pixel's light is on the chip afterwards, but nothing stands in its way: beside
a sharp edge in front of blurred things, their light runs a little over it. Diffraction and
aberrations are the point spread's, not this file's; a retroreflector is blurred as a surface is.
"""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np

from models.arrays import AnyArray, Floats
from models.camera import Camera
from models.sensors.camera_chip import Detector, Optics

MOST_RADIUS_PX = 128.0  # a wider disc is as even as this one, and takes gigabytes to draw
SUBPIXELS = 32  # a side; of the discs' rims
RIM_PX = 1.0 / 32.0
STEP_PX, STEP = 0.5, 1.15  # from one disc's radius to the next: at least, and as a factor


def circle_of_confusion_px(
    depth_m: AnyArray, optics: Optics, camera: Camera, detector: Detector
) -> Floats:
    """Return the diameter of each pixel's circle, (height, width), px; space is infinitely far.

    Parameters
    ----------
    depth_m : (height, width) array, m
        Along the boresight; 0 in space.
    optics : Optics
        Its ``focus_m`` and ``f_number``.
    camera, detector
        Their focal length is ``camera.fx`` pixels.
    """
    pitch_m = detector.pixel_pitch_um * 1e-6
    focal_m = camera.fx * pitch_m
    farthest = focal_m**2 / (optics.f_number * (optics.focus_m - focal_m)) / pitch_m
    depth = np.asarray(depth_m, dtype=np.float64)
    nearness = np.divide(optics.focus_m, depth, out=np.zeros_like(depth), where=depth > 0.0)
    return np.asarray(farthest * np.abs(1.0 - nearness))


@lru_cache(maxsize=64)
def disc(radius_px: float) -> Floats:
    """Return a disc, (2 n + 1, 2 n + 1), adding up to one, of the variance ``radius^2 / 4``.

    ``radius_px`` is at least one. The disc is averaged over pixels; since that adds the pixel's own
    twelfth, it is a little smaller than it says: between two that differ by a sixteenth.
    """
    shrunk = np.sqrt(radius_px**2 - 1.0 / 3.0)
    reach = int(np.ceil(shrunk + 1.0))
    small, large = (_averaged(shrunk + aside, reach) for aside in (-RIM_PX, RIM_PX))
    squares = np.arange(-reach, reach + 1) ** 2
    low, high = (float(kernel.sum(axis=0) @ squares) for kernel in (small, large))
    share = (0.25 * radius_px**2 - low) / (high - low)
    return np.asarray((1.0 - share) * small + share * large)


def _averaged(radius_px: float, reach: int) -> Floats:
    """Return how much of each pixel lies within a radius, as shares of all of it."""
    side = 2 * reach + 1
    places = (np.arange(side * SUBPIXELS) + 0.5) / SUBPIXELS - 0.5 * side
    covered = (places[:, None] ** 2 + places**2 <= radius_px**2).astype(np.float64)
    kernel = covered.reshape(side, SUBPIXELS, side, SUBPIXELS).sum(axis=(1, 3))
    return np.asarray(kernel / kernel.sum())


def defocused(image: AnyArray, circle_px: AnyArray) -> Floats:
    """Spread each pixel's light evenly over its circle.

    The image goes on beyond its border as in a mirror, so that no light is gained or lost.

    Parameters
    ----------
    image : (height, width) array
    circle_px : (height, width) array, px
        Diameters.

    Returns
    -------
    (height, width) float64 array.
    """
    sharp = np.asarray(image, dtype=np.float64)
    radius = np.minimum(0.5 * np.asarray(circle_px, dtype=np.float64), MOST_RADIUS_PX)
    table = [0.0, 1.0]
    while table[-1] < radius.max():
        table.append(max(table[-1] + STEP_PX, table[-1] * STEP))
    place = np.interp(radius**2, np.square(table), np.arange(len(table)))
    spread = np.zeros_like(sharp)
    for number, disc_radius in enumerate(table):
        layer = sharp * np.maximum(1.0 - np.abs(place - number), 0.0)
        if number > 0 and layer.any():
            layer = cv2.filter2D(
                layer, cv2.CV_64F, disc(disc_radius), borderType=cv2.BORDER_REFLECT
            )
        spread += layer
    return np.maximum(spread, 0.0)
