"""Where spots are: each fitted by a star's image, with its brightness and the light about it.

Weighted least squares with the model's own variances is maximum likelihood but for the tails of
Poisson's law, so errors are at the Cramér-Rao bound where noise is what it is thought to be. All
spots are fitted at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Indices, Mask
from models.sensors.star_camera import StarCamera
from pipelines.star_attitude.options import StarAttitudeOptions
from pipelines.star_attitude.spot_detection import SpotImage
from pipelines.star_attitude.spot_model import spot_shares

HALF_PX = 4  # of a window, beside what motion adds
ITERATIONS = 7
LONGEST_STEP_PX = 0.7
FARTHEST_PX = 1.5  # from the peak: a spot that runs further away is none
FEWEST_PIXELS = 12


@dataclass(frozen=True, eq=False)
class Spots:
    """Spots that look like stars, brightest first.

    Attributes
    ----------
    pixels : (n, 2) array, px
        In the middle of the exposure.
    covariance_px2 : (n, 2, 2) array, px2
    electrons : (n,) array, e
    misfit : (n,) array
        Chi-square over its degrees of freedom.
    """

    pixels: Floats
    covariance_px2: Floats
    electrons: Floats
    misfit: Floats

    def __len__(self) -> int:
        return len(self.pixels)

    def kept(self, which: Mask | Indices) -> Spots:
        """Return some of them, by (n,) bool array or (k,) rows in order."""
        return Spots(
            self.pixels[which],
            self.covariance_px2[which],
            self.electrons[which],
            self.misfit[which],
        )


def fit_spots(
    seen: SpotImage,
    peaks: Indices,
    smears_px: Floats,
    sensor: StarCamera,
    options: StarAttitudeOptions,
) -> Spots:
    """Fit spots, and leave out what does not look like a star.

    Parameters
    ----------
    seen : SpotImage
    peaks : (n, 2) int array, px
    smears_px : (n, 2) array, px
        By which a star there moves during the exposure.
    sensor : StarCamera
    options : StarAttitudeOptions
    """
    spots = fitted(seen, peaks, smears_px, sensor)
    sigma = np.sqrt(np.trace(spots.covariance_px2, axis1=1, axis2=2))
    sound = np.isfinite(sigma) & (sigma < FARTHEST_PX) & (spots.misfit < options.most_misfit)
    sound &= (np.abs(spots.pixels - peaks) < FARTHEST_PX).all(axis=1) & (spots.electrons > 0.0)
    order = np.flatnonzero(sound)
    return spots.kept(order[np.argsort(-spots.electrons[order], kind="stable")])


def fitted(seen: SpotImage, peaks: Indices, smears_px: Floats, sensor: StarCamera) -> Spots:
    """Fit spots, whatever they look like.

    Parameters
    ----------
    seen : SpotImage
    peaks : (n, 2) int array, px
    smears_px : (n, 2) array, px
    sensor : StarCamera
    """
    if not len(peaks):
        return Spots(np.zeros((0, 2)), np.zeros((0, 2, 2)), np.zeros(0), np.zeros(0))
    detector, sigma_px = sensor.detector, sensor.optics.psf_sigma_px
    half = HALF_PX + int(np.ceil(0.5 * np.abs(smears_px).max()))
    charge, background, usable = _windows(seen, peaks, half)
    floor_e2 = detector.read_noise_e**2 + detector.gain_e_dn**2 / 12.0
    offset = np.zeros((len(peaks), 2))
    level = background[:, half, half].copy()
    shares, slopes = spot_shares(offset, smears_px, sigma_px, half)
    light = np.sum((charge - level[:, None, None]) * shares, axis=(1, 2))
    light = np.maximum(light / np.sum(shares**2, axis=(1, 2)), 1.0)
    for _ in range(ITERATIONS):
        model = light[:, None, None] * shares + level[:, None, None]
        variance = floor_e2 + np.maximum(model, 0.0)
        variance += (detector.prnu * light[:, None, None] * shares) ** 2
        weight = usable / variance
        rows = np.stack(
            [
                light[:, None, None] * slopes[:, 0],
                light[:, None, None] * slopes[:, 1],
                shares,
                np.ones_like(shares),
            ],
            axis=1,
        ).reshape(len(peaks), 4, -1)
        weighted = rows * weight.reshape(len(peaks), 1, -1)
        normal = weighted @ rows.swapaxes(1, 2)
        scale = np.sqrt(np.maximum(np.diagonal(normal, axis1=1, axis2=2), 1e-30))
        scaled = normal / (scale[:, :, None] * scale[:, None, :]) + 1e-12 * np.eye(4)
        residual = (charge - model).reshape(len(peaks), -1, 1)
        inverse = np.linalg.inv(scaled) / (scale[:, :, None] * scale[:, None, :])
        step = (inverse @ (weighted @ residual))[..., 0]
        offset += np.clip(step[:, :2], -LONGEST_STEP_PX, LONGEST_STEP_PX)
        offset = np.clip(offset, -2.0 * FARTHEST_PX, 2.0 * FARTHEST_PX)
        light = np.maximum(light + step[:, 2], 1.0)
        level = level + step[:, 3]
        shares, slopes = spot_shares(offset, smears_px, sigma_px, half)
    final = charge - light[:, None, None] * shares - level[:, None, None]
    freedom = np.maximum(usable.sum(axis=(1, 2)) - 4, 1)
    misfit = np.sum(weight * final**2, axis=(1, 2)) / freedom
    misfit = np.where(usable.sum(axis=(1, 2)) < FEWEST_PIXELS, np.inf, misfit)
    return Spots(peaks + offset, inverse[:, :2, :2], light, misfit)


def _windows(seen: SpotImage, peaks: Indices, half: int) -> tuple[Floats, Floats, Mask]:
    """Return charge, background and which pixels count, (n, rows, columns) each."""
    height, width = seen.charge_e.shape
    around = np.arange(-half, half + 1)
    rows = (peaks[:, 1, None] + around)[:, :, None]
    columns = (peaks[:, 0, None] + around)[:, None, :]
    inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
    place = np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)
    return (
        seen.charge_e[place].astype(np.float64),
        seen.background_e[place].astype(np.float64),
        inside & ~seen.saturated[place],
    )
