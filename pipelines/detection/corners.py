"""Corners of a target in an image: Shi and Tomasi's, refined below the pixel.

A corner's sigma is what the image's noise leaves of it, and what the light adds: shadows and
rounded shapes move a corner whatever the noise.

Source: Shi and Tomasi 1994, CVPR, "Good features to track"; Foerstner and Guelch 1987 for the
refinement and its covariance.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from models.arrays import Floats, Image
from models.sensors.camera_chip import Detector
from pipelines.detection.target_region import TargetRegion, find_target

BLOCK_PX = 5
WINDOW_PX = 4  # half of the refinement's
MOST_CORNERS = 150
QUALITY = 0.02  # of the strongest corner's smaller eigenvalue
APART_PX = 5.0
NOISE_GATE = 8.0  # the eigenvalue must be this many times what noise alone makes
FLOOR_PX = 0.1  # below it Shi-Tomasi corners are not repeatable, whatever the noise
FARTHEST_MOVE_PX = 3.0  # a refinement that goes further has found something else


@dataclass(frozen=True, eq=False)
class Corners:
    """Corners of one image.

    Attributes
    ----------
    points_px : (n, 2) array, px
        Pixel centres are integers.
    sigma_px : (n, 2) array, px
        1-sigma per axis.
    """

    points_px: Floats
    sigma_px: Floats

    def __len__(self) -> int:
        return len(self.points_px)

    @classmethod
    def none(cls) -> Corners:
        """Return no corner."""
        return cls(np.zeros((0, 2)), np.zeros((0, 2)))


def find_corners(image: Image, detector: Detector | None = None) -> Corners:
    """Find the corners of what is lit in an image.

    Parameters
    ----------
    image : (height, width) uint16 array, DN
    detector : Detector, optional
        As calibrated.
    """
    return corners_of(find_target(image, detector), detector)


def corners_of(target: TargetRegion, detector: Detector | None = None) -> Corners:
    """Find the corners of a target; see ``find_corners``."""
    if not target:
        return Corners.none()
    row, column = np.nonzero(target.lit)
    margin = 3 * BLOCK_PX
    top, left = max(int(row.min()) - margin, 0), max(int(column.min()) - margin, 0)
    part = np.s_[top : int(row.max()) + margin + 1, left : int(column.max()) + margin + 1]
    smooth = cv2.GaussianBlur(target.stretched[part], (0, 0), 0.8)
    near = cv2.dilate(target.lit[part].astype(np.uint8), np.ones((7, 7), np.uint8))
    found = cv2.goodFeaturesToTrack(
        smooth, MOST_CORNERS, QUALITY, APART_PX, mask=near, blockSize=BLOCK_PX
    )
    if found is None or min(smooth.shape) < 2 * WINDOW_PX + 5:
        return Corners.none()
    rough = found.reshape(-1, 2).astype(np.float32)
    window = (WINDOW_PX, WINDOW_PX)
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 40, 0.01)
    # The light itself, since its logarithm is steepest outside of a bright edge.
    light = cv2.GaussianBlur(target.signal[part], (0, 0), 0.5)
    fine = cv2.cornerSubPix(light, rough.copy().reshape(-1, 1, 2), window, (-1, -1), stop)
    points = fine.reshape(-1, 2).astype(np.float64)
    moved = np.linalg.norm(points - rough, axis=1)
    sigma, clear = _noise_sigma(smooth, target, part, points, detector)
    keep = (moved < FARTHEST_MOVE_PX) & clear
    return Corners(points[keep] + [left, top], sigma[keep])


def _noise_sigma(
    smooth: np.ndarray[tuple[int, ...], np.dtype[np.float32]],
    target: TargetRegion,
    part: tuple[slice, slice],
    points: Floats,
    detector: Detector | None,
) -> tuple[Floats, np.ndarray[tuple[int, ...], np.dtype[np.bool_]]]:
    """Return the corners' sigmas from their structure tensors, and which stand out of the noise."""
    gx = cv2.Scharr(smooth, cv2.CV_32F, 1, 0, scale=1.0 / 32.0)
    gy = cv2.Scharr(smooth, cv2.CV_32F, 0, 1, scale=1.0 / 32.0)
    size = (2 * WINDOW_PX + 1, 2 * WINDOW_PX + 1)
    xx, yy, xy = (
        cv2.boxFilter(product, cv2.CV_32F, size, normalize=False)
        for product in (gx * gx, gy * gy, gx * gy)
    )
    level = np.maximum(target.signal[part], 0.0)
    noise_dn = (
        np.full(level.shape, target.sky_sigma_dn)
        if detector is None
        else np.maximum(detector.noise_dn(level + detector.bias_dn), target.sky_sigma_dn)
    )
    noise = (0.2 * noise_dn / np.hypot(level, target.knee_dn)).astype(np.float32)
    noise = cv2.blur(noise, size)
    column, row = np.clip(np.rint(points).astype(int), 0, np.array(smooth.shape[::-1]) - 1).T
    a, b, c = xx[row, column], xy[row, column], yy[row, column]
    local = noise[row, column]
    determinant = np.maximum(a * c - b * b, 1e-12)
    smaller = 0.5 * (a + c - np.sqrt((a - c) ** 2 + 4.0 * b * b))
    of_noise = np.stack([np.sqrt(c / determinant), np.sqrt(a / determinant)], axis=1)
    # Each gradient errs at its own distance from the corner, half a window on average.
    sigma = np.hypot(of_noise * local[:, None] * 0.5 * WINDOW_PX, FLOOR_PX)
    clear = smaller > NOISE_GATE * local**2 * size[0] * size[1]
    return sigma.astype(np.float64), np.asarray(clear)
