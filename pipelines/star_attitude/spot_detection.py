"""Spots in a star image: a background of medians, a matched filter, and its peaks."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from models.arrays import Floats, Image, Indices, Mask, Radiance
from models.sensors.star_camera import StarCamera
from pipelines.star_attitude.options import StarAttitudeOptions
from pipelines.star_attitude.spot_model import spot_shares

CELL_PX = 4  # averaged before medians of 5 x 5 cells are taken: no star fills a third of 20 px
BORDER_PX = 4  # beside which a spot is not whole
LARGE_PX = 60  # saturated in one piece: no star, but the Moon or the Earth
GLARE_PX = 15  # about such a piece nothing is believed
STILL_PX = 0.3  # less smear than this leaves the filter as it is


@dataclass(frozen=True, eq=False)
class SpotImage:
    """A frame in electrons, with what is known of each pixel.

    Attributes
    ----------
    charge_e, background_e : (height, width) arrays, e
    saturated : (height, width) bool array
        Beyond the full well.
    glaring : (height, width) bool array
        In or beside the Moon, the Earth or the Sun.
    """

    charge_e: Radiance
    background_e: Radiance
    saturated: Mask
    glaring: Mask

    @property
    def saturated_share(self) -> float:
        """Share of the chip that is saturated."""
        return float(self.saturated.mean())


def spot_image(image: Image, sensor: StarCamera) -> SpotImage:
    """Return a frame in electrons, and its background.

    Parameters
    ----------
    image : (height, width) uint16 array, DN
    sensor : StarCamera
    """
    detector = sensor.detector
    charge = (image.astype(np.float32) - np.float32(detector.bias_dn)) * np.float32(
        detector.gain_e_dn
    )
    height, width = charge.shape
    size = max(width // CELL_PX, 5), max(height // CELL_PX, 5)
    small = cv2.medianBlur(cv2.resize(charge, size, interpolation=cv2.INTER_AREA), 5)
    background = cv2.resize(small, (width, height), interpolation=cv2.INTER_LINEAR)
    noise_dn = 5.0 * detector.read_noise_e / detector.gain_e_dn
    saturated = image >= detector.saturation_dn - noise_dn
    return SpotImage(charge, background, saturated, _glaring(saturated))


def _glaring(saturated: Mask) -> Mask:
    if np.count_nonzero(saturated) < LARGE_PX:
        return np.zeros_like(saturated)
    _, labels, stats, _ = cv2.connectedComponentsWithStats(saturated.astype(np.uint8))
    large = stats[:, cv2.CC_STAT_AREA] >= LARGE_PX
    large[0] = False
    side = 2 * GLARE_PX + 1
    wide = cv2.dilate(large[labels].astype(np.uint8), np.ones((side, side), np.uint8))
    return np.asarray(wide > 0)


def spot_peaks(
    seen: SpotImage, sensor: StarCamera, smear_px: Floats, options: StarAttitudeOptions
) -> Indices:
    """Return columns and rows of spots, (n, 2), the clearest first.

    Parameters
    ----------
    seen : SpotImage
    sensor : StarCamera
    smear_px : (2,) array, px
        By which a star in the middle of the field moves during the exposure.
    options : StarAttitudeOptions
    """
    detector = sensor.detector
    residual = seen.charge_e - seen.background_e
    kernel = _kernel(sensor.optics.psf_sigma_px, smear_px)
    filtered = cv2.filter2D(residual, cv2.CV_32F, kernel, borderType=cv2.BORDER_REPLICATE)
    floor_e2 = detector.read_noise_e**2 + detector.gain_e_dn**2 / 12.0
    noise = np.sqrt(np.maximum(seen.background_e, 0.0) + np.float32(floor_e2))
    clear = filtered / (noise * np.float32(np.sqrt(np.sum(kernel**2))))
    clear[seen.glaring] = 0.0
    border = np.zeros(clear.shape, dtype=np.bool_)
    border[BORDER_PX:-BORDER_PX, BORDER_PX:-BORDER_PX] = True
    highest = clear >= cv2.dilate(clear, np.ones((5, 5), np.uint8))
    highest &= residual < options.sharpest * filtered / np.float32(np.sum(kernel**2))
    rows, columns = np.nonzero(highest & border & (clear > options.detection_snr))
    order = np.argsort(-clear[rows, columns], kind="stable")[: options.most_spots]
    return np.stack([columns[order], rows[order]], axis=1)


def _kernel(sigma_px: float, smear_px: Floats) -> Radiance:
    """Return the filter that matches a star in the middle of the field, its sum 1."""
    smear = smear_px if np.hypot(*smear_px) > STILL_PX else np.zeros(2)
    half = int(np.ceil(4.0 * sigma_px + 0.5 * np.abs(smear).max()))
    shares = spot_shares(np.zeros((1, 2)), smear[None], sigma_px, half)[0][0]
    return (shares / shares.sum()).astype(np.float32)
