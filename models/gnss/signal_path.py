"""What lies on a signal's way: the Earth, and electrons.

The ionosphere is a Chapman layer, the same everywhere: what grazes it comes tens of metres late.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats
from models.gnss.tracking_noise import L1_HZ

EARTH_RADIUS_M = 6_371_000.0
OPAQUE_HEIGHT_M = 50_000.0  # below it: ground, troposphere
IONOSPHERE_TOP_M = 1_000_000.0
PEAK_HEIGHT_M, SCALE_HEIGHT_M = 350_000.0, 70_000.0
VERTICAL_ELECTRONS_M2 = 20e16  # 20 TEC units
DELAY_M3_S2 = 40.308  # of the refractive index: metres times Hz squared, by electrons
STEPS = 200


def lowest_height_m(receiver: Floats, sender: Floats) -> Floats:
    """Return the least height of the way from a sender to a receiver, (...,), m.

    Parameters
    ----------
    receiver, sender : (..., 3) array, m
        From the Earth's centre.
    """
    way = sender - receiver
    part = -np.sum(receiver * way, axis=-1) / np.sum(way * way, axis=-1)
    nearest = receiver + np.clip(part, 0.0, 1.0)[..., None] * way
    return np.sqrt(np.sum(nearest * nearest, axis=-1)) - EARTH_RADIUS_M


def ionospheric_delay_m(receiver: Floats, sender: Floats) -> Floats:
    """Return by how much electrons delay the code, (n,), m: an integral along the straight way.

    Parameters
    ----------
    receiver, sender : (n, 3) array, m
        From the Earth's centre.

    References
    ----------
    S. Chapman, Proceedings of the Physical Society 43 (1931): the layer's profile.
    """
    way = sender - receiver
    length = np.sqrt(np.sum(way * way, axis=-1))
    direction = way / length[:, None]
    at_nearest = -np.sum(receiver * direction, axis=-1)
    nearest_m = np.sqrt(np.maximum(0.0, np.sum(receiver**2, axis=-1) - at_nearest**2))
    top = EARTH_RADIUS_M + IONOSPHERE_TOP_M
    half = np.sqrt(np.maximum(0.0, top**2 - nearest_m**2))
    start = np.clip(at_nearest - half, 0.0, length)
    end = np.clip(at_nearest + half, 0.0, length)
    places = start[:, None] + (end - start)[:, None] * (np.arange(STEPS) + 0.5) / STEPS
    radius = np.sqrt(nearest_m[:, None] ** 2 + (places - at_nearest[:, None]) ** 2)
    depth = (radius - EARTH_RADIUS_M - PEAK_HEIGHT_M) / SCALE_HEIGHT_M
    profile = np.exp(0.5 * (1.0 - depth - np.exp(-np.maximum(depth, -50.0))))
    peak_m3 = VERTICAL_ELECTRONS_M2 / (SCALE_HEIGHT_M * np.sqrt(2.0 * np.pi * np.e))
    electrons = peak_m3 * profile.mean(axis=1) * (end - start)
    return DELAY_M3_S2 / L1_HZ**2 * electrons
