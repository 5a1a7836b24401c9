"""A range finder's noise, wrong echoes and missing ones are as many as it says."""

import numpy as np
import pytest

from models.errors import ScenarioError
from models.sensors.range_finder import RangeFinder

DRAWS = 4000


def readings(finder, true_m=20.0):
    return [finder.reading(true_m, np.random.default_rng([1, k])) for k in range(DRAWS)]


def test_a_right_echo_has_its_sigma():
    errors = np.array(readings(RangeFinder(sigma_m=0.02))) - 20.0
    assert errors.std() == pytest.approx(0.02, rel=4.0 / np.sqrt(2 * DRAWS))
    assert abs(errors.mean()) < 4.0 * 0.02 / np.sqrt(DRAWS)


def test_shares_are_kept_and_leave_other_draws_alone():
    plain = readings(RangeFinder())
    other = readings(RangeFinder(outlier_share=0.1, drop_out_share=0.2))
    lost = np.mean([each is None for each in other])
    assert lost == pytest.approx(0.2, abs=0.03)
    there = [(one, two) for one, two in zip(plain, other, strict=True) if two is not None]
    same = np.mean([one == two for one, two in there])
    assert same == pytest.approx(0.9, abs=0.03)


def test_where_the_beam_meets_nothing_there_is_no_reading():
    assert RangeFinder().reading(np.inf, np.random.default_rng(0)) is None


@pytest.mark.parametrize(("rate_hz", "share"), [(0.5, 0.5), (0.3, 0.3), (5.0, 1.0)])
def test_it_reads_at_its_rate(rate_hz, share):
    due = [RangeFinder(rate_hz=rate_hz).due(frame, 1.0) for frame in range(1000)]
    assert due[0]
    assert np.mean(due) == pytest.approx(share, abs=0.01)


@pytest.mark.parametrize(
    "wrong", [{"sigma_m": 0.0}, {"outlier_share": 1.5}, {"rate_hz": float("nan")}]
)
def test_what_cannot_be_is_refused(wrong):
    with pytest.raises(ScenarioError, match=f"range finder: expected {next(iter(wrong))}"):
        RangeFinder(**wrong)


def test_a_wrong_echo_is_anywhere_within_its_span_but_not_behind_the_lens():
    """Evenly about the truth: mean, 2 L / sqrt(12) of spread, and its ends; none below zero."""
    span_m = 6.0
    wrong = np.array(readings(RangeFinder(outlier_share=1.0, outlier_span_m=span_m)))
    assert wrong.mean() == pytest.approx(20.0, abs=4.0 * span_m / np.sqrt(3.0 * DRAWS))
    assert wrong.std() == pytest.approx(span_m / np.sqrt(3.0), rel=0.03)
    assert wrong.min() == pytest.approx(20.0 - span_m, abs=0.02)
    assert wrong.max() == pytest.approx(20.0 + span_m, abs=0.02)
    near = np.array(readings(RangeFinder(outlier_share=1.0, outlier_span_m=span_m), true_m=3.0))
    assert near.min() == 0.0
    assert np.mean(near == 0.0) == pytest.approx(0.25, abs=0.03)
