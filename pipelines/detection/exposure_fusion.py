"""Several exposures of one view as one linear image, its noise and what saturates in all of them.

Each exposure tells a pixel's rate of light; where it is not saturated its rate is weighted by the
inverse of its variance, that of the light itself, of reading out and of rounding (Robertson, Borman
and Stevenson 2003, Journal of Electronic Imaging 12, whose weights are of the camera's response).
The image is in the numbers of the longest exposure, which a converter of more bits would have
given: what was dark keeps its digits, and what was bright does not end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from models.arrays import Floats, Image, Mask
from models.errors import DatasetError
from models.frame import ImageReading
from models.sensors.camera_chip import Detector

FUSED_BITS = 16
NEARLY_SATURATED = 0.98  # of the saturation: above it a pixel is not linear


@dataclass(frozen=True, eq=False)
class FusedExposures:
    """Exposures made one.

    Attributes
    ----------
    image : (height, width) uint16 array, DN
        Of the longest exposure, beyond its end where a shorter one tells.
    sigma_dn : (height, width) array, DN
        1-sigma noise of it.
    saturated : (height, width) array of bool
        Where all of them are.
    exposure_ms : float, ms
        The longest.
    detector : Detector
        As which the image may be taken.
    """

    image: Image
    sigma_dn: Floats
    saturated: Mask
    exposure_ms: float
    detector: Detector


def fused_detector(detector: Detector, ratio: float) -> Detector:
    """Return a detector that would have taken the longest exposure whole.

    Parameters
    ----------
    detector : Detector
    ratio : float
        Of the longest exposure to the shortest.

    Raises
    ------
    DatasetError
        If sixteen bits do not hold it.
    """
    span_dn = detector.saturation_dn - detector.bias_dn
    if not ratio >= 1.0 or detector.bias_dn + ratio * span_dn > 2**FUSED_BITS - 1:
        most = (2**FUSED_BITS - 1 - detector.bias_dn) / span_dn
        raise DatasetError(
            f"expected exposures of one view within a ratio of {most:.3g}, which {FUSED_BITS} bits "
            f"hold, got {ratio:.3g}; take them nearer together"
        )
    return replace(detector, bits=FUSED_BITS, full_well_e=ratio * span_dn * detector.gain_e_dn)


def fused_exposures(readings: Sequence[ImageReading], detector: Detector) -> FusedExposures:
    """Make exposures of one view one.

    Parameters
    ----------
    readings : sequence of ImageReading
        In any order, of one size.
    detector : Detector
        As calibrated.

    Raises
    ------
    DatasetError
        If there are none, sizes differ, one lasts no time, or their ratio is too large.
    """
    sizes = {reading.image.shape for reading in readings}
    if len(sizes) != 1 or not all(reading.exposure_ms > 0.0 for reading in readings):
        raise DatasetError(
            "expected exposures of one view of one size, each above 0 ms, got "
            + (", ".join(f"{r.image.shape} of {r.exposure_ms:g} ms" for r in readings) or "none")
        )
    ordered = sorted(readings, key=lambda reading: reading.exposure_ms)
    longest_ms = ordered[-1].exposure_ms
    as_one = fused_detector(detector, longest_ms / ordered[0].exposure_ms)
    top = detector.bias_dn + NEARLY_SATURATED * (detector.saturation_dn - detector.bias_dn)
    shape = ordered[0].image.shape
    signal = np.zeros(shape)
    # The best of a pixel's rates tells each exposure's noise: its own number would favour the low.
    for reading in ordered:
        level = reading.image - detector.bias_dn
        own = longest_ms / reading.exposure_ms * level
        signal = np.where(reading.image < top, own, signal)
    weighted, weights = np.zeros(shape), np.zeros(shape)
    for reading in ordered:
        times = longest_ms / reading.exposure_ms
        noise = times * detector.noise_dn(detector.bias_dn + np.maximum(signal, 0.0) / times)
        weight = np.where(reading.image < top, 1.0 / noise**2, 0.0)
        weighted += weight * times * (reading.image - detector.bias_dn)
        weights += weight
    saturated = weights == 0.0
    safe = np.where(saturated, 1.0, weights)
    fused = np.where(saturated, as_one.saturation_dn, detector.bias_dn + weighted / safe)
    image = np.clip(np.rint(fused), 0.0, as_one.max_dn).astype(np.uint16)
    shortest = longest_ms / ordered[0].exposure_ms
    blind = shortest * detector.noise_dn(np.array(detector.saturation_dn))
    sigma = np.where(saturated, blind, np.sqrt(1.0 / safe))
    return FusedExposures(image, sigma, saturated, longest_ms, as_one)
