"""Summaries of runs whose errors are drawn, so that what they come to is known."""

import numpy as np
import pytest

from bench.suites.consistency import consistency, root_mean_square
from bench.suites.pesce2019.summaries import (
    acquisition_summary,
    bound_summary,
    settled,
    steady,
    tracking_summary,
)
from bench.suites.pesce2019.tracking_run import ERRORS
from bench.suites.units import Outcome

FRAMES, RUNS = 360, 20
NO_TIME = np.zeros(1)


def run(seed: int, size: float = 1.0, lost: slice = slice(0)) -> Outcome:
    """Return a run whose every error is |N(0, size)|, and that has no state for a while."""
    rng = np.random.default_rng(seed)
    values = {name: np.abs(size * rng.standard_normal(FRAMES)) for name in ERRORS}
    for column in values.values():
        column[lost] = np.nan
    values["mode"] = np.full(FRAMES, 2, dtype=np.int8)
    values["reasons"] = np.array(["dark by 1.5", "dark by 20"])
    values["reason_counts"] = np.array([1, 1])
    return Outcome(values, NO_TIME)


def test_windows_are_the_papers():
    assert steady(1800) == slice(800, 1800)
    assert settled(1800, 1.0) == slice(50, 1800)
    assert steady(360) == slice(160, 360)


def test_errors_are_pooled_over_runs_and_frames():
    runs = [run(seed) for seed in range(RUNS)]
    found = tracking_summary(runs, settled(FRAMES, 1.0))
    count = RUNS * (FRAMES - 50)
    assert found.frames == count
    assert found.position_m == pytest.approx(1.0, abs=4.0 / np.sqrt(2.0 * count))
    own = runs[0].values["position_m"][50:]
    assert found.first_run_position_m == pytest.approx(np.sqrt(np.mean(own**2)))
    assert found.worst_run_share_position < 2.0 / RUNS
    assert found.modes["tracked"] == count
    assert found.reasons == {"dark by …": 2 * RUNS}


def test_a_lost_frame_is_counted_and_has_no_error():
    runs = [run(0), run(1, lost=slice(100, 131))]
    found = tracking_summary(runs, settled(FRAMES, 1.0))
    assert found.no_state == pytest.approx(31 / (2 * 310))
    assert found.no_pose == found.no_state
    assert found.position_m is not None


def test_one_bad_run_shows():
    runs = [*(run(seed) for seed in range(9)), run(9, size=30.0)]
    found = tracking_summary(runs, steady(FRAMES))
    assert found.worst_run_share_position > 0.98
    assert found.median_run_position_m < 1.2
    assert found.position_m > 8.0


def test_nothing_comes_to_nothing():
    found = tracking_summary([run(0, lost=slice(None))], steady(FRAMES))
    assert found.position_m is None
    assert found.largest_attitude_deg is None
    assert found.nees_rotation.mean is None
    assert found.no_state == 1.0
    assert root_mean_square(np.array([np.nan])) is None


@pytest.mark.parametrize(("factor", "honest"), [(1.0, True), (2.0, False), (0.5, False)])
def test_consistency_tells_honest_filters_from_others(factor, honest):
    squares = factor * np.random.default_rng(0).chisquare(6, (50, 2000))
    found = consistency(squares, 6)
    assert found.mean == pytest.approx(factor, rel=0.01)
    # 2000 independent instants, 95 of 100 inside: four sigma are 2 in 100.
    assert (abs(found.inside - 0.95) < 0.02) is honest


def test_a_bound_is_summarised_as_errors_are():
    names = ("raw_position_m", "raw_attitude_deg", "position_m", "attitude_deg", "velocity_m_s",
             "rate_deg_s")  # fmt: skip
    outcome = Outcome({name: np.array([3.0, 4.0], dtype=np.float32) for name in names}, NO_TIME)
    assert bound_summary(outcome, slice(0, 2)).position_m == pytest.approx(np.sqrt(12.5))


def test_acquisitions_right_wrong_confused_and_none():
    outcome = Outcome(
        {
            "position_m": np.array([0.1, 0.2, 2.0, 0.1, np.nan]),
            "attitude_deg": np.array([1.0, 2.0, 1.0, 180.0, np.nan]),
            "attitude_symmetric_deg": np.array([1.0, 2.0, 1.0, 0.5, np.nan]),
            "images": np.array([1, 3, 1, 1, 0]),
        },
        NO_TIME,
    )
    found = acquisition_summary([outcome])
    assert (found.runs, found.acquired, found.wrong, found.confused) == (5, 4, 2, 1)
    assert found.wrong_share == 0.5
    assert found.first_image == pytest.approx(0.6)
    assert found.position_m == pytest.approx(0.6)
    assert acquisition_summary([outcome], most=2).wrong == 0


def test_no_failure_in_many_runs_bounds_the_failure_rate():
    """The rule of three, for 97.5 %: -ln(0.025) / n."""
    many = 1000
    outcome = Outcome(
        {name: np.full(many, 0.1) for name in ("position_m", "attitude_deg",
                                               "attitude_symmetric_deg", "images")},
        NO_TIME,
    )  # fmt: skip
    found = acquisition_summary([outcome])
    assert found.wrong_share == 0.0
    assert found.wrong_share_most == pytest.approx(-np.log(0.025) / many, rel=0.01)
