"""Detector numbers to grey levels, so that dim structure and bright markers both show."""

from __future__ import annotations

import numpy as np

from models.arrays import AnyArray, Floats
from models.sensors.camera_chip import Detector

SOFTENING = 0.005
STRETCH = "asinh stretch: linear below 0.5 % of full well, logarithmic above, black at the bias"


def stretch(signal_dn: AnyArray, detector: Detector) -> Floats:
    """Return the grey levels of a signal.

    ``asinh(x / 0.005) / asinh(1 / 0.005)``, x being the share of full well; below zero is black.

    Parameters
    ----------
    signal_dn : (...,) array, DN
        Above the bias.
    detector : Detector

    Returns
    -------
    (...,) array
        Grey levels in [0, 1], of the same shape.
    """
    full_dn = detector.saturation_dn - detector.bias_dn
    share = np.clip(np.asarray(signal_dn, dtype=np.float64) / full_dn, 0.0, 1.0)
    return np.asarray(np.arcsinh(share / SOFTENING) / np.arcsinh(1.0 / SOFTENING))
