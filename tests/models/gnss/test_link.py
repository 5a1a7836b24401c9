"""Signals: the formulas' own numbers, and a second computation of who is received in GEO."""

import numpy as np
import pytest

from models.gnss.constellation import gps_and_galileo
from models.gnss.link_budget import LinkBudget, ReceiveAntenna
from models.gnss.reception import Receiver, reception
from models.gnss.signal_path import (
    EARTH_RADIUS_M,
    VERTICAL_ELECTRONS_M2,
    ionospheric_delay_m,
    lowest_height_m,
)
from models.gnss.tracking_noise import CHIP_M, L1_HZ, TrackingLoops
from models.gnss.transmit_pattern import azimuth_averaged_gain_db, transmit_gain_db

GEO_M, DAY_S = 42_164_000.0, 86_164.1
MASK_M = 1_000_000.0


def test_code_noise_is_the_formula_s():
    """Kaplan and Hegarty 5.23, worked by hand at 30 dB-Hz: D 0.3, B 0.2 Hz, T 20 ms."""
    wide = TrackingLoops(front_end_hz=26e6)
    by_hand = CHIP_M * np.sqrt(0.2 * 0.3 / 2000.0 * (1.0 + 2.0 / (0.02 * 1000.0 * 1.7)))
    assert wide.code_sigma_m(np.array([30.0])) == pytest.approx([by_hand], rel=1e-12)
    levels = np.array([22.0, 25.0, 28.0, 30.0, 35.0, 40.0, 45.0])
    expected = [4.7, 3.1, 2.1, 1.65, 0.91, 0.51, 0.29]
    assert wide.code_sigma_m(levels) == pytest.approx(expected, rel=0.02)


def test_a_narrow_correlator_meets_the_front_end():
    """Equation 5.22's three branches join, and none is below what the bandwidth allows."""
    spacings = np.linspace(0.02, 1.0, 400)
    noise = [
        TrackingLoops(spacing_chips=float(d), front_end_hz=5e6).code_sigma_m(np.array([40.0]))[0]
        for d in spacings
    ]
    assert np.abs(np.diff(noise)).max() < 0.02 * max(noise)
    assert noise[0] == pytest.approx(CHIP_M * np.sqrt(0.2 / 2e4 * 1.023 / 5.0), rel=0.02)


def test_rate_noise_is_the_formula_s():
    levels = np.array([22.0, 25.0, 28.0, 30.0, 35.0, 40.0, 45.0])
    expected = [0.39, 0.26, 0.18, 0.14, 0.077, 0.043, 0.024]
    assert TrackingLoops().rate_sigma_m_s(levels) == pytest.approx(expected, rel=0.02)


def test_a_zenith_satellite_is_as_strong_as_the_standard_promises():
    """GPS L1 C/A on the ground: at least -158.5 dBW into 0 dBic; some 45 dB-Hz at 290 K."""
    link = LinkBudget(losses_db=0.0, azimuth_averaged=True)
    cn0 = link.cn0_dbhz(
        np.array([6.371e6, 0.0, 0.0]),
        np.array([1.0, 0.0, 0.0]),
        np.array([[2.656e7, 0.0, 0.0]]),
        np.array([0.0, 1.0, 0.0]),
        ReceiveAntenna(0.0),
    )
    power_dbw = cn0[0] - 228.6 + 10.0 * np.log10(290.0)
    assert -158.5 < power_dbw < -150.0


def test_the_pattern_is_the_table_s():
    angle = np.deg2rad
    assert transmit_gain_db(angle([0.0]), angle([123.0])) == pytest.approx([15.01])
    assert transmit_gain_db(angle([10.0]), angle([0.0])) == pytest.approx([16.27])
    assert transmit_gain_db(angle([10.0]), angle([355.0])) == pytest.approx([(16.32 + 16.27) / 2])
    assert azimuth_averaged_gain_db(angle([0.0])) == pytest.approx([15.01])
    assert azimuth_averaged_gain_db(angle([30.0])) == pytest.approx([-1.6], abs=0.05)
    assert transmit_gain_db(angle([95.0]), angle([0.0]))[0] < -90.0


def test_a_signal_grazes_the_earth_where_geometry_says():
    receiver = np.array([[GEO_M, 0.0, 0.0]])
    behind = np.array([[-2e7, 0.0, 0.0]])
    beside = np.array([[3e7, 1e7, 0.0]])
    assert lowest_height_m(receiver, behind) == pytest.approx([-EARTH_RADIUS_M])
    assert lowest_height_m(receiver, beside)[0] == pytest.approx(
        np.hypot(3e7, 1e7) - EARTH_RADIUS_M
    )


def test_the_ionosphere_delays_by_its_electrons():
    """Straight up 40.3 TEC / f2; a ray that grazes the layer's peak comes tens of metres late."""
    up = ionospheric_delay_m(np.array([[EARTH_RADIUS_M, 0, 0]]), np.array([[2.6e7, 0.0, 0.0]]))
    assert up == pytest.approx([40.308 * VERTICAL_ELECTRONS_M2 / L1_HZ**2], rel=0.02)
    receiver = np.array([[GEO_M, 0.0, 0.0]] * 2)
    sender = np.array([[-2e7, 1.48 * (EARTH_RADIUS_M + 3e5), 0], [-2e7, 1.5e7, 0]])
    grazing, above = ionospheric_delay_m(receiver, sender)
    assert 20.0 < grazing < 100.0
    assert above == 0.0


def second_computation(gain_dbi: float, times_s: np.ndarray) -> np.ndarray:
    """Count satellites of a GEO one by one, with plain loops and the mean pattern."""
    rows = np.rad2deg(np.linspace(0.0, np.deg2rad(78.0), 400))
    pattern = azimuth_averaged_gain_db(np.deg2rad(rows))
    counts = []
    for now_s in times_s.tolist():
        angle = 2.0 * np.pi * now_s / DAY_S
        here = GEO_M * np.array([np.cos(angle), np.sin(angle), 0.0])
        heard = 0
        for sender in gps_and_galileo().states(np.array([now_s]))[0, :, :3]:
            way = here - sender
            length = np.sqrt(way @ way)
            off = np.degrees(np.arccos(-(sender @ way) / (np.sqrt(sender @ sender) * length)))
            gain = np.interp(off, rows, pattern, right=-100.0)
            free_space = 20.0 * np.log10(4.0 * np.pi * length * L1_HZ / 299_792_458.0)
            level = 14.3 + gain + gain_dbi - 1.0 - free_space - 10 * np.log10(290.0) + 228.6
            along = -(here @ -way) / length
            nearest = np.sqrt(here @ here - along**2) if 0 < along < length else GEO_M
            heard += level >= 28.0 and nearest > EARTH_RADIUS_M + MASK_M
        counts.append(heard)
    return np.array(counts)


@pytest.mark.parametrize("gain_dbi", [0.0, 3.0, 6.0, 9.0])
def test_geo_availability_agrees_with_a_second_computation(gain_dbi):
    """Mean number and share of time with four or more, within a tenth."""
    times_s = np.arange(0.0, DAY_S, 1800.0)
    angle = 2.0 * np.pi * times_s / DAY_S
    up = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=1)
    receiver = Receiver(
        ReceiveAntenna(gain_dbi, 60.0), 28.0, link=LinkBudget(azimuth_averaged=True)
    )
    sun = np.broadcast_to([0.0, 0.9, 0.4], up.shape)
    found = reception(receiver, gps_and_galileo(), times_s, GEO_M * up, -up, sun)
    ours = (found.tracked & (found.lowest_height_m > MASK_M)).sum(axis=1)
    theirs = second_computation(gain_dbi, times_s)
    assert ours.mean() == pytest.approx(theirs.mean(), rel=0.1)
    assert (ours >= 4).mean() == pytest.approx((theirs >= 4).mean(), rel=0.1)


def test_channels_go_to_the_strongest():
    up = np.array([[1.0, 0.0, 0.0]])
    few = Receiver(ReceiveAntenna(3.0), 35.0, channels=5)
    all_of_them = Receiver(ReceiveAntenna(3.0), 35.0, channels=60)
    arguments = (gps_and_galileo(), np.zeros(1), 7.158e6 * up, up, np.array([[0.0, 1.0, 0.0]]))
    some, whole = (reception(each, *arguments) for each in (few, all_of_them))
    assert some.tracked.sum() == 5
    assert 15 <= whole.tracked.sum() <= 30
    weakest = some.cn0_dbhz[some.tracked].min()
    assert weakest >= whole.cn0_dbhz[whole.tracked & ~some.tracked].max()
