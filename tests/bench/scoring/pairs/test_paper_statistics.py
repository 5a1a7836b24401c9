"""Equations 17 and 18 against a calculation by hand."""

import numpy as np
import pytest

from bench.scoring.pairs.paper_statistics import paper_statistics, temporal_statistics
from models.pose import PoseError


def error(x_m: float, alpha_deg: float = 0.0) -> PoseError:
    euler = np.array([alpha_deg, 0.0, 0.0])
    return PoseError(np.array([x_m, 0.0, 0.0]), euler, euler, abs(alpha_deg))


def test_hand_calculation():
    """Two runs, three instants: h = [1 2 6; 3 4 2] gives mu(t) = [2 3 4], mean 3, std 1.

    The printed form, a sum over the two runs divided by n_s - 1 = 1, could not give it: at t = 1
    it would be sqrt(2), at t = 2 zero.
    """
    mean, std = temporal_statistics(np.array([[1.0, 2.0, 6.0], [3.0, 4.0, 2.0]]))
    assert mean == pytest.approx(3.0)
    assert std == pytest.approx(1.0)


def test_units_are_those_of_the_papers_tables():
    runs = [
        {0: error(0.01, 1.0), 1: error(0.02, 2.0), 2: error(0.06, 3.0)},
        {0: error(0.03, 1.0), 1: error(0.04, 2.0), 2: error(0.02, 3.0)},
    ]
    statistics = paper_statistics(runs)
    assert (statistics.runs, statistics.instants) == (2, 3)
    assert statistics.mean.t_cm == pytest.approx([3.0, 0.0, 0.0])
    assert statistics.std.t_cm == pytest.approx([1.0, 0.0, 0.0])
    assert statistics.mean.euler_deg == pytest.approx([2.0, 0.0, 0.0])
    assert statistics.std.euler_deg == pytest.approx([1.0, 0.0, 0.0])


def test_an_instant_without_a_pose_in_one_run_is_the_mean_of_the_others():
    statistics = paper_statistics([{0: error(0.01)}, {0: error(0.03), 1: error(0.05)}])
    assert statistics.instants == 2
    assert statistics.mean.t_cm[0] == pytest.approx((2.0 + 5.0) / 2.0)


def test_one_instant_has_no_spread_and_none_has_no_mean():
    assert paper_statistics([{0: error(0.01)}]).std is None
    assert paper_statistics([{}, {}]).mean is None
    assert paper_statistics([]).instants == 0


def test_averaging_runs_shrinks_sigma_n():
    """With 100 runs of independent noise sigma_N is a tenth of one run's: it is no frame's error.

    Relative sd of a standard deviation over 400 instants is 3.5 %; four of them are allowed.
    """
    noise = np.random.default_rng(3).normal(0.0, 1.0, (100, 400))
    _, one = temporal_statistics(noise[:1])
    _, hundred = temporal_statistics(noise)
    assert float(one / hundred) == pytest.approx(10.0, rel=0.2)
