"""How wide errors are, and what counts of them: against Gaussian draws of a known sigma."""

import numpy as np
import pytest

from pipelines.unknown_target.robust_weights import of_most, spread, weights

GATE = 3.0


@pytest.mark.parametrize("numbers", [1, 2])
@pytest.mark.parametrize("sigma", [0.3, 1.0, 4.0])
def test_errors_are_as_wide_as_they_were_drawn_and_one_sigma_at_least(
    numbers: int, sigma: float
) -> None:
    draws = sigma * np.random.default_rng(4).standard_normal((20_000, numbers))
    sizes = np.append(np.linalg.norm(draws, axis=1), [np.inf, np.inf])
    assert spread(sizes, numbers) == pytest.approx(max(1.0, sigma), rel=0.03)


def test_nothing_to_go_by_is_one_sigma() -> None:
    assert spread(np.array([]), 2) == 1.0
    assert spread(np.array([np.inf]), 2) == 1.0


def test_beyond_the_gate_weights_fall_with_the_fourth_power() -> None:
    found = weights(np.array([0.0, GATE, 2.0 * GATE, np.inf]), GATE)
    np.testing.assert_allclose(found, [1.0, 1.0, 1.0 / 16.0, 0.0])


def test_where_most_are_far_off_none_is_left_out_and_all_count_for_less() -> None:
    """Ten times as wide as told, gates opened to twice: as if sigma had been ten times as large."""
    sizes = np.abs(10.0 * np.random.default_rng(5).standard_normal(2000))
    wide = spread(sizes, 1)
    inside = sizes < GATE * wide
    found = of_most(sizes, 1, GATE, 2.0)
    np.testing.assert_allclose(found[inside], 1.0 / wide**2)
    usual = of_most(0.1 * sizes, 1, GATE, 2.0)
    assert usual[0.1 * sizes < GATE].min() == 1.0
