"""Quantiles are those of scipy.stats, to the bit: scores must not depend on which is loaded."""

from __future__ import annotations

import pytest
from scipy.stats import chi2, f

from models.quantiles import chi_square_quantile, f_quantile

PROBABILITIES = (1e-6, 0.025, 0.5, 0.95, 0.975, 0.9999, 1.0 - 1e-5)


@pytest.mark.parametrize("freedom", [1, 2, 3, 6, 12, 60, 6000, 600_000])
@pytest.mark.parametrize("probability", PROBABILITIES)
def test_of_chi_square(probability: float, freedom: int) -> None:
    assert chi_square_quantile(probability, freedom) == chi2.ppf(probability, freedom)


@pytest.mark.parametrize("freedom", [2, 4])
@pytest.mark.parametrize("freedom_below", [1, 8, 12, 34])
@pytest.mark.parametrize("tail", [1e-5, 0.05, 0.5])
def test_of_f(tail: float, freedom: int, freedom_below: int) -> None:
    assert f_quantile(1.0 - tail, freedom, freedom_below) == f.isf(tail, freedom, freedom_below)
