"""Starts are as wrong as the paper's acquisitions, and know no rates."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bench.suites.pesce2019.cases import case, tumble_of
from bench.suites.pesce2019.plan import start_errors
from bench.suites.pesce2019.start_errors import StartErrors, drawn_start

TRUTH = tumble_of(case("2"), 60.0).state(30.0)
ERRORS = StartErrors(0.2, 0.15, 1.0, 0.6)
RUNS = 2000


@pytest.fixture(scope="module")
def drawn():
    starts = [drawn_start(TRUTH, ERRORS, 0, run) for run in range(RUNS)]
    moved = np.array([start.rho_in_lvlh - TRUTH.rho_in_lvlh for start in starts])
    turned = Rotation.from_matrix(
        np.array([TRUTH.R_lvlh_from_target.T @ start.R_lvlh_from_target for start in starts])
    ).as_rotvec()
    return moved, turned


def test_second_moments_are_those_of_the_table(drawn):
    """|N(m, s)| has the second moment m^2 + s^2, whatever the sign it lost."""
    moved, turned = drawn
    for sample, sigma in ((moved, ERRORS.sigma_m), (turned, ERRORS.sigma_rad)):
        squares = sample**2
        spread = squares.std(axis=0) / np.sqrt(RUNS)
        assert (np.abs(squares.mean(axis=0) - sigma**2) < 4.0 * spread).all()


def test_directions_are_uniform(drawn):
    for sample in drawn:
        directions = sample / np.linalg.norm(sample, axis=1)[:, None]
        # Archimedes: one coordinate of a uniform direction is uniform in [-1, 1].
        assert np.abs(directions.mean(axis=0)).max() < 4.0 / np.sqrt(3.0 * RUNS)
        assert np.abs((directions**2).mean(axis=0) - 1.0 / 3.0).max() < 4.0 * np.sqrt(
            4.0 / 45.0 / RUNS
        )


def test_rates_are_unknown():
    start = drawn_start(TRUTH, ERRORS, 0, 0)
    assert not start.rho_dot_in_lvlh.any()
    assert not start.omega_target_wrt_lvlh_in_target.any()
    assert start.time_s == TRUTH.time_s


def test_cases_take_the_statistics_that_the_paper_says():
    assert start_errors(case("4")) == start_errors(case("5")) == start_errors(case("1"))
    assert start_errors(case("2")).attitude_mean_deg == 1.007
    assert start_errors(case("3")).position_mean_m == 0.3767
