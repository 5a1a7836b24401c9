"""Blooming against a slow reference that walks every spill from well to well, and by its laws."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.arrays import Floats
from models.sensors.camera_chip import Detector
from renders.detector.blooming import bloom
from renders.detector.expose import expose_electrons, exposure_rng

WELL = 100.0
charges = st.lists(
    st.lists(st.floats(0.0, 140.0), min_size=3, max_size=3), min_size=9, max_size=9
).map(np.array)


def spot(excess: float, row: int = 20, rows: int = 41) -> Floats:
    charge = np.zeros((rows, 3))
    charge[row, 1] = WELL + excess
    return charge


def test_without_blooming_the_excess_is_gone() -> None:
    charge = bloom(spot(500.0), WELL, 0.0)
    assert charge.sum() == pytest.approx(WELL)


def test_blooming_runs_along_the_column_half_each_way_and_keeps_all_charge() -> None:
    charge = bloom(spot(500.0), WELL, 1.0)
    assert charge.sum() == pytest.approx(WELL + 500.0)
    assert (charge[:, [0, 2]] == 0.0).all()
    np.testing.assert_allclose(charge[:, 1], charge[::-1, 1])
    np.testing.assert_allclose(charge[18:23, 1], WELL)
    np.testing.assert_allclose(charge[[17, 23], 1], 50.0)


@pytest.mark.parametrize("share", [0.25, 0.5, 1.0])
def test_a_share_of_the_excess_blooms(share: float) -> None:
    charge = bloom(spot(500.0), WELL, share)
    assert charge.sum() == pytest.approx(WELL + share * 500.0)


def test_what_reaches_the_end_of_a_column_is_drained() -> None:
    charge = bloom(spot(1000.0, row=1, rows=20), WELL, 1.0)
    np.testing.assert_allclose(charge[:7, 1], WELL)  # one above, five below
    assert charge.sum() == pytest.approx(WELL + 500.0 + WELL)


@settings(max_examples=60)
@given(charge=charges, share=st.floats(0.0, 1.0))
def test_blooming_makes_no_charge_and_overfills_no_pixel(charge: Floats, share: float) -> None:
    before = charge.copy()
    after = bloom(charge, WELL, share)
    excess = np.maximum(before - WELL, 0.0)
    np.testing.assert_array_equal(charge, before)
    assert (after <= WELL).all()
    assert (after >= np.minimum(before, WELL)).all()
    limit = np.minimum(before, WELL).sum(axis=0) + share * excess.sum(axis=0)
    assert (after.sum(axis=0) <= limit + 1e-9).all()


# Against a reference


def walked(column: list[float], well: float, share: float, ways: tuple[int, int]) -> list[float]:
    """Let each well's excess walk along one column, pixel by pixel, one way and then the other.

    Written as one would tell it; wells in the order in which a walk meets them, so that what is
    nearest to room takes it.
    """
    held = [min(charge, well) for charge in column]
    for way in ways:
        rows = range(len(column)) if way == 1 else range(len(column) - 1, -1, -1)
        for start in reversed(rows):  # the foremost first: it is nearest to the room ahead
            left = 0.5 * share * max(column[start] - well, 0.0)
            row = start + way
            while 0 <= row < len(column) and left > 0.0:
                taken = min(left, well - held[row])
                held[row] += taken
                left -= taken
                row += way
    return held


@settings(max_examples=80)
@given(
    charge=st.lists(st.floats(0.0, 400.0), min_size=2, max_size=24),
    share=st.sampled_from([0.0, 0.3, 1.0]),
)
def test_it_is_the_reference_to_rounding(charge: list[float], share: float) -> None:
    expected = np.mean([walked(charge, WELL, share, ways) for ways in ((1, -1), (-1, 1))], axis=0)
    found = bloom(np.array(charge)[:, None], WELL, share)[:, 0]
    np.testing.assert_allclose(found, expected, atol=1e-9 * WELL)


@settings(max_examples=60)
@given(charge=charges, share=st.floats(0.0, 1.0))
def test_upside_down_it_blooms_upside_down(charge: Floats, share: float) -> None:
    after = bloom(charge, WELL, share)
    np.testing.assert_allclose(bloom(charge[::-1], WELL, share), after[::-1], atol=1e-9 * WELL)
    np.testing.assert_allclose(bloom(charge[:, ::-1], WELL, share), after[:, ::-1])


def disc(radius: float, level: float, size: int = 129) -> Floats:
    """Return a disc of ``level`` full wells in the middle of an empty frame."""
    v, u = np.mgrid[0:size, 0:size] - size // 2
    return np.where(u**2 + v**2 <= radius**2, level * WELL, 0.0)


def test_a_saturated_disc_is_a_streak_as_long_as_its_charge() -> None:
    """Each column keeps its charge as full wells in a row: its chord times the level."""
    charge = disc(8.0, 3.5)
    after = bloom(charge, WELL, 1.0)
    assert after.sum() == pytest.approx(charge.sum(), rel=1e-12)
    chords = (charge > 0.0).sum(axis=0)
    full = (after >= WELL * (1.0 - 1e-12)).sum(axis=0)
    ends = 3.5 * chords - full  # two, filled in part
    assert ((ends >= 0.0) & (ends < 2.0)).all()
    lit = after[:, chords > 0] > 0.0
    assert (np.diff(lit.astype(int), axis=0) != 0).sum(axis=0).tolist() == [2] * lit.shape[1]
    np.testing.assert_allclose(after, after[::-1], atol=1e-9 * WELL)


def test_a_streak_in_a_frame_is_saturated_and_one_column_wide() -> None:
    """Through the converter: a point of 40 full wells on a chip without a drain."""
    detector = Detector(blooming=1.0, prnu=0.0, dark_current_e_s=0.0)
    mean = np.full((101, 31), 200.0)
    mean[50, 15] = 40.0 * detector.full_well_e
    image = expose_electrons(mean, detector, exposure_rng(0, 0, 850)).astype(float)
    streak = image[:, 15] > detector.saturation_dn - 5.0
    noise = 4.0 * detector.noise_dn(np.array([detector.saturation_dn]))[0]
    # 39 wells of excess fill the room of 39.1 that others leave with 200 e in each.
    assert abs(streak.sum() - 40) <= 1
    assert abs(int(np.flatnonzero(streak).mean() * 2) - 100) <= 1
    beside = np.delete(image, 15, axis=1)
    assert beside.max() < detector.bias_dn + 200.0 / detector.gain_e_dn + noise
