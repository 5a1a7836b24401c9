from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.motion.attitude_wobble import AttitudeWobble

ACCURACY_DEG, MAX_RATE_DEG_S = 2.0, 0.02  # Opromolla et al. 2022, section 4.1; the issue of pairs
STEP_S = 0.5
ROUNDING = 1e-9
SEEDS = st.integers(0, 2**32 - 1)


def turns(wobble: AttitudeWobble, times: np.ndarray) -> Rotation:
    return Rotation.from_matrix([wobble.nominal_from_target(time_s) for time_s in times])


@given(SEEDS, st.floats(-1e5, 1e5))
def test_no_axis_ever_leaves_the_pointing_accuracy(seed: int, time_s: float) -> None:
    wobble = AttitudeWobble.drawn(ACCURACY_DEG, MAX_RATE_DEG_S, seed)
    assert np.abs(wobble.rotation_vector_deg(time_s)).max() <= ACCURACY_DEG
    reach = np.abs(wobble.bias_deg) + np.abs(wobble.amplitude_deg).sum(axis=1)
    assert reach.max() <= ACCURACY_DEG + ROUNDING


@given(SEEDS, st.floats(-1e4, 1e4))
def test_the_angular_rate_never_exceeds_its_bound(seed: int, time_s: float) -> None:
    """Measured as the angle between attitudes half a second apart, not as the derivative."""
    wobble = AttitudeWobble.drawn(ACCURACY_DEG, MAX_RATE_DEG_S, seed)
    before, after = turns(wobble, np.array([time_s, time_s + STEP_S]))
    rate_deg_s = np.rad2deg((after * before.inv()).magnitude()) / STEP_S
    assert rate_deg_s <= MAX_RATE_DEG_S * (1.0 + ROUNDING)


@pytest.mark.parametrize("seed", range(5))
def test_it_does_sway(seed: int) -> None:
    """Within one approach it moves by a fair part of what its rate allows."""
    wobble = AttitudeWobble.drawn(ACCURACY_DEG, MAX_RATE_DEG_S, seed)
    path = np.array([wobble.rotation_vector_deg(time_s) for time_s in np.arange(0, 330, 10.0)])
    assert np.linalg.norm(np.ptp(path, axis=0)) > 0.3
    rates = np.linalg.norm(np.diff(path, axis=0), axis=1) / 10.0
    assert rates.max() > 0.25 * MAX_RATE_DEG_S


def test_one_seed_gives_one_sway_and_another_another() -> None:
    first, again, other = (AttitudeWobble.drawn(2.0, 0.02, seed) for seed in (3, 3, 4))
    np.testing.assert_array_equal(first.rotation_vector_deg(77.0), again.rotation_vector_deg(77.0))
    assert np.abs(first.rotation_vector_deg(77.0) - other.rotation_vector_deg(77.0)).max() > 0.01


def test_a_tight_bound_on_the_angle_bounds_the_sway() -> None:
    wobble = AttitudeWobble.drawn(0.01, 1.0, 0)
    path = np.array([wobble.rotation_vector_deg(time_s) for time_s in np.arange(0, 5000, 10.0)])
    assert 0.005 < np.abs(path).max() <= 0.01


def test_no_accuracy_to_miss_or_no_rate_is_no_sway() -> None:
    still = AttitudeWobble.drawn(0.0, 0.02, 0)
    np.testing.assert_array_equal(still.nominal_from_target(123.0), np.eye(3))
    stuck = AttitudeWobble.drawn(2.0, 0.0, 0)
    np.testing.assert_array_equal(stuck.rotation_vector_deg(0.0), stuck.rotation_vector_deg(99.0))


@pytest.mark.parametrize("bad", [-1.0, float("nan"), float("inf")])
def test_impossible_bounds_are_refused(bad: float) -> None:
    with pytest.raises(ValueError, match="accuracy_deg of at least zero"):
        AttitudeWobble.drawn(bad, 0.02, 0)
    with pytest.raises(ValueError, match="max_rate_deg_s of at least zero"):
        AttitudeWobble.drawn(2.0, bad, 0)
