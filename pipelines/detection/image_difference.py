"""The difference of a pair: the markers shine at 850 nm and are dark at 800 nm.

Sunlight is in both images and cancels but for shot noise, 33 ms of motion, and saturation: a
glint that saturates has no difference, and beside it charge may have spilled. Such pixels must not
set a threshold; but a marker that saturates, or stands beside a glint, must stay whole.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np

from models.arrays import Floats, Image, Mask
from models.sensors.camera_chip import Detector
from pipelines.detection.image_pair import ImagePair

SWAPPED_TIMES = 2.0  # of noise alone, the largest steps up and down are about alike
SATURATION_SIGMAS = 5.0  # of read noise, below the full well's level


@dataclass(frozen=True)
class Region:
    """A rectangle of an image: rows [top, bottom), columns [left, right)."""

    top: int
    bottom: int
    left: int
    right: int

    @property
    def part(self) -> tuple[slice, slice]:
        """What to index an image with."""
        return slice(self.top, self.bottom), slice(self.left, self.right)

    @property
    def origin_px(self) -> Floats:
        """(2,) array, px: column and row of its first pixel."""
        return np.array([self.left, self.top], dtype=np.float64)

    @property
    def pixels(self) -> int:
        """How many there are."""
        return (self.bottom - self.top) * (self.right - self.left)

    @classmethod
    def whole(cls, image: Image) -> Region:
        """Return all of an image.

        Parameters
        ----------
        image : (height, width) array
        """
        return cls(0, image.shape[0], 0, image.shape[1])


def saturation_level_dn(detector: Detector) -> float:
    """Return the level, DN, from which on a pixel is taken as saturated."""
    read_noise_dn = detector.read_noise_e / detector.gain_e_dn
    return float(detector.saturation_dn - SATURATION_SIGMAS * read_noise_dn - 1.0)


def clipped_difference(pair: ImagePair) -> Image:
    """Return max(850 nm - 800 nm, 0), uint16: the paper's difference image."""
    return np.asarray(cv2.subtract(pair.image_850, pair.image_800))


def signed_difference(pair: ImagePair, region: Region) -> Floats:
    """Return 850 nm - 800 nm of a region, (height, width) DN."""
    difference = cv2.subtract(
        pair.image_850[region.part], pair.image_800[region.part], dtype=cv2.CV_32F
    )
    return np.asarray(difference)


def saturated(pair: ImagePair, detector: Detector, region: Region | None = None) -> Mask | None:
    """Tell which pixels of a region are saturated in either exposure, with a rim of one pixel.

    Parameters
    ----------
    pair : ImagePair
    detector : Detector
    region : Region, optional
        The whole image unless given.

    Returns
    -------
    (height, width) array of bool, or None if there is no such pixel.
    """
    part = (region or Region.whole(pair.image_850)).part
    brighter = cv2.max(pair.image_800[part], pair.image_850[part])
    level = saturation_level_dn(detector)
    if brighter.max() < level:
        return None
    mask = cv2.compare(brighter, level, cv2.CMP_GE)
    return np.asarray(cv2.dilate(mask, np.ones((3, 3), np.uint8)) > 0)


def shines_swapped(pair: ImagePair) -> bool:
    """Tell whether something outshines, at 800 nm, all that shines only at 850 nm.

    Markers do where the images are exchanged; noise does not, on either side of zero.

    Parameters
    ----------
    pair : ImagePair
    """
    step = pair.image_850.astype(np.int32) - pair.image_800
    return bool(-step.min() > SWAPPED_TIMES * max(step.max(), 0))


def swapped(pair: ImagePair) -> ImagePair:
    """Return the pair with its two images exchanged."""
    return replace(pair, image_800=pair.image_850, image_850=pair.image_800)
