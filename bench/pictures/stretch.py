"""Detector numbers to grey levels, so that dim structure and bright markers both show."""

from __future__ import annotations

import numpy as np

from models.arrays import AnyArray, Floats
from models.sensors.camera_chip import Detector

SOFTENING = 0.005
STRETCH = "asinh stretch: linear below 0.5 % of full well, logarithmic above, black at the bias"


def stretch(signal_dn: AnyArray, detector: Detector) -> Floats:
    """Return grey levels in [0, 1] of a signal in DN above the bias.

    ``asinh(x / 0.005) / asinh(1 / 0.005)``, x being the share of full well; below zero is black.
    """
    full_dn = detector.saturation_dn - detector.bias_dn
    share = np.clip(np.asarray(signal_dn, dtype=np.float64) / full_dn, 0.0, 1.0)
    return np.asarray(np.arcsinh(share / SOFTENING) / np.arcsinh(1.0 / SOFTENING))
