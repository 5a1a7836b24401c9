"""The Earth's sizes: a geostationary orbit turns with it."""

from __future__ import annotations

import numpy as np
import pytest

from models.gravity.field import MU_M3_S2
from models.lights.earth import GEO_RADIUS_KM

SIDEREAL_DAY_S = 86_164.0905
PRINTED_KM = 0.05  # half of the last digit


def test_a_geostationary_orbit_turns_once_in_a_sidereal_day() -> None:
    """Kepler's third law."""
    turned_km = 1e-3 * np.cbrt(MU_M3_S2 * (SIDEREAL_DAY_S / (2.0 * np.pi)) ** 2)
    assert pytest.approx(turned_km, abs=PRINTED_KM) == GEO_RADIUS_KM
