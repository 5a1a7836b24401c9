"""Colours of stars: tables that rise as smoothly as stars redden."""

from __future__ import annotations

import numpy as np
import pytest

from models.sky.star_light import irradiance_w_m2, visual_minus_infrared


def test_redder_stars_are_redder_and_the_slope_of_their_colours_changes_little() -> None:
    """V - I rises by 0.5 to 2.3 a magnitude of B - V (dwarfs and giants of every class to K)."""
    b_v = np.linspace(-0.3, 1.93, 224)
    slopes = np.diff([visual_minus_infrared(each, "") for each in b_v]) / np.diff(b_v)
    assert slopes.min() > 0.5
    assert slopes.max() < 2.3
    classes = [visual_minus_infrared(2.0, f"M{each:.1f}") for each in np.arange(0.0, 8.1, 0.5)]
    steps = np.diff(classes)
    assert steps.min() > 0.05
    assert steps.max() < 0.35


def test_ends_of_the_tables_hold_beyond_them_and_s_is_read_as_m() -> None:
    assert visual_minus_infrared(-0.5, "") == visual_minus_infrared(-0.3, "")
    assert visual_minus_infrared(2.5, "") == visual_minus_infrared(1.93, "")
    assert visual_minus_infrared(1.0, "S3.5") == visual_minus_infrared(2.0, "M3.5")
    assert visual_minus_infrared(0.0, "") == 0.0


@pytest.mark.parametrize("b_v", [0.0, 0.65, 1.5])
def test_five_magnitudes_are_a_hundredfold_and_red_light_comes_through(b_v: float) -> None:
    """Vega's colour gives the zero point: 1.126e-8 (798/825)^3 W m-2 um-1 over 70 nm."""
    ratio = irradiance_w_m2(1.0, b_v) / irradiance_w_m2(6.0, b_v)
    assert ratio == pytest.approx(100.0)
    white = irradiance_w_m2(0.0, 0.0)
    assert white == pytest.approx(1.126e-8 * (798.0 / 825.0) ** 3 * 0.070)
    redder = 10.0 ** (0.4 * 1.06 * visual_minus_infrared(b_v, ""))
    assert irradiance_w_m2(0.0, b_v) / white == pytest.approx(redder)
