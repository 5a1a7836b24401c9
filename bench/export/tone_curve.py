"""How detector numbers become eight bits: a stated curve, from black at the bias to saturation.

The curve is written beside the images, with its formula and both ends, so that it can be undone to
the half step of a level.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from models.arrays import AnyArray, Floats
from models.sensors.camera_chip import Detector

LEVELS = 255
SOFTENING = 0.005
CURVES: dict[str, tuple[str, Callable[[Floats], Floats]]] = {
    "linear": ("round(255 x)", lambda x: x),
    "sqrt": ("round(255 sqrt(x))", lambda x: np.asarray(np.sqrt(x))),
    "asinh": (
        "round(255 asinh(x / 0.005) / asinh(200))",
        lambda x: np.asarray(np.arcsinh(x / SOFTENING) / np.arcsinh(1.0 / SOFTENING)),
    ),
}
"""Formula and curve by name; x is the share of what lies between black and white."""


@dataclass(frozen=True)
class ToneCurve:
    """A curve with its ends.

    Attributes
    ----------
    name : str
        A key of ``CURVES``; in ``sqrt`` photon noise is as wide at every level.
    black_dn, white_dn : float, DN
        What becomes 0 and 255.
    """

    name: str
    black_dn: float
    white_dn: float

    def applied(self, image: AnyArray) -> AnyArray:
        """Return an image in eight bits.

        Parameters
        ----------
        image : (...,) array of uint8 or uint16, DN

        Returns
        -------
        (...,) uint8 array
        """
        levels = np.arange(np.iinfo(image.dtype).max + 1, dtype=np.float64)
        share = np.clip((levels - self.black_dn) / (self.white_dn - self.black_dn), 0.0, 1.0)
        table = np.rint(LEVELS * CURVES[self.name][1](share)).astype(np.uint8)
        return np.asarray(table[image])

    def to_json(self) -> str:
        """Return the text that says what was done."""
        told = {
            "curve": self.name,
            "formula": CURVES[self.name][0],
            "x": "(DN - black_dn) / (white_dn - black_dn), cut to 0 and 1",
            "black_dn": self.black_dn,
            "white_dn": self.white_dn,
        }
        return json.dumps(told, indent=2) + "\n"


def tone_curve(name: str, detector: Detector | None) -> ToneCurve:
    """Return a curve from a detector's bias to its saturation; of all 16 bits where there is none.

    Parameters
    ----------
    name : str
    detector : Detector or None
        As calibrated.
    """
    if detector is None:
        return ToneCurve(name, 0.0, 65535.0)
    return ToneCurve(name, float(detector.bias_dn), float(detector.saturation_dn))
