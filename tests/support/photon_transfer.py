"""The photon-transfer curve: a detector's gain, read noise and pixel response from flat fields.

What a laboratory does with a camera whose data sheet it does not trust (Janesick 2007, Photon
Transfer, chapters 5 and 6): pairs of evenly lit frames at rising levels. The difference of a pair
knows no fixed pattern, so half its variance is noise alone and grows with the mean as

    variance = mean / gain + (read noise / gain)^2 + 1/12        all in DN

and what the two frames of a pair share beyond their mean is the pattern, (PRNU x mean)^2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from models.arrays import AnyArray, Floats

ROUNDING_DN2 = 1.0 / 12.0  # variance of rounding to whole numbers
LEVELS = 3  # fewest that show whether the curve is a line


@dataclass(frozen=True)
class Measured:
    """A number with the 1-sigma that statistics leave to it."""

    value: float
    sigma: float


@dataclass(frozen=True, eq=False)
class PhotonTransfer:
    """What flat fields say of a detector.

    Attributes
    ----------
    gain_e_dn : Measured, e/DN
    read_noise_e : Measured, e
    prnu : Measured
        1 sigma, relative.
    mean_dn, variance_dn2 : (n,) arrays, DN and DN^2
        The curve: signal above the bias, and temporal variance, at each level.
    pattern_dn2 : (n,) array, DN^2
        What the two frames of a pair share.
    """

    gain_e_dn: Measured
    read_noise_e: Measured
    prnu: Measured
    mean_dn: Floats
    variance_dn2: Floats
    pattern_dn2: Floats


def photon_transfer(pairs: Sequence[tuple[AnyArray, AnyArray]], bias_dn: float) -> PhotonTransfer:
    """Measure a detector from pairs of flat fields, one pair a level, all below saturation.

    The line is fitted by weighted least squares; a variance from ``n`` pixels is known to
    ``sqrt(2 / n)`` of itself, and a covariance of two frames to ``sqrt((v1 v2 + c^2) / n)``.

    Parameters
    ----------
    pairs : sequence of pairs of (height, width) arrays, DN
        Two frames of the same exposure; levels from dark to bright.
    bias_dn : float, DN

    Raises
    ------
    ValueError
        If there are fewer than three levels, a level has no noise, or the variance does not grow
        with the mean: at saturation.
    """
    if len(pairs) < LEVELS:
        raise ValueError(f"expected flat fields at {LEVELS} levels or more, got {len(pairs)}")
    frames = [
        tuple(np.asarray(frame, dtype=np.float64).ravel() for frame in pair) for pair in pairs
    ]
    pixels = np.array([first.size for first, _ in frames])
    mean = np.array([0.5 * (first.mean() + second.mean()) for first, second in frames]) - bias_dn
    temporal = np.array([0.5 * (first - second).var(ddof=1) for first, second in frames])
    single = np.array([0.5 * (one.var(ddof=1) + two.var(ddof=1)) for one, two in frames])
    pattern = single - temporal

    if (temporal <= 0.0).any():
        raise ValueError(
            "expected noise at every level, got frames that are equal at "
            f"{mean[temporal <= 0.0][0]:.0f} DN; leave out the levels at saturation"
        )
    design = np.stack([mean, np.ones_like(mean)], axis=1)
    values, covariance = _fitted(design, temporal - ROUNDING_DN2, temporal * np.sqrt(2.0 / pixels))
    slope, offset = values
    if slope <= 0.0:
        raise ValueError(
            "expected the variance of flat fields to grow with their mean, it falls by "
            f"{-slope:.3g} DN a DN; leave out the levels at saturation"
        )
    gain = 1.0 / slope
    read_dn = np.sqrt(max(float(offset), 0.0))
    # read = sqrt(offset) / slope: its derivatives by slope and offset carry the fit's covariance.
    by_fit = np.array([-read_dn / slope**2, 0.5 / (max(read_dn, 1e-9) * slope)])

    noise = np.sqrt((single**2 + pattern**2) / pixels)
    (square,), ((spread,),) = _fitted(mean[:, None] ** 2, pattern, noise)
    prnu = np.sqrt(max(float(square), 0.0))
    return PhotonTransfer(
        gain_e_dn=Measured(float(gain), float(gain**2 * np.sqrt(covariance[0, 0]))),
        read_noise_e=Measured(float(read_dn * gain), float(np.sqrt(by_fit @ covariance @ by_fit))),
        prnu=Measured(float(prnu), float(np.sqrt(spread) / (2.0 * max(prnu, spread**0.25)))),
        mean_dn=mean,
        variance_dn2=temporal,
        pattern_dn2=pattern,
    )


def _fitted(design: Floats, values: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """Return the weighted least-squares solution and its covariance."""
    weighted = design / sigma[:, None]
    covariance = np.asarray(np.linalg.inv(weighted.T @ weighted), dtype=np.float64)
    return covariance @ (weighted.T @ (values / sigma)), covariance
