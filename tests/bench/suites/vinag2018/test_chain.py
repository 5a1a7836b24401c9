"""Absolute navigation that feeds relative navigation, in the suite: runs and their summary."""

import numpy as np
import pytest

from bench.suites.units import Outcome
from bench.suites.vinag2018.chain_results import chain_table, chained
from bench.suites.vinag2018.chain_run import KEPT, NAVIGATED, TRUE, follow
from bench.suites.vinag2018.plan import Plan, Sizes

FRAMES = 10


def outcome(size: float, chaser_m: float = 0.0) -> Outcome:
    """Return a run whose every error is of one size, but for a start that is far worse."""
    values = {name: np.full(FRAMES, size) for name in KEPT}
    values["position_m"][0] = 1e3
    values |= {"time_s": np.arange(FRAMES) + 60.0, "chaser_m": np.full(FRAMES, chaser_m)}
    return Outcome(values, np.zeros(FRAMES))


def test_a_start_is_left_out_and_runs_are_pooled():
    found = chained("best", NAVIGATED, [outcome(0.003, 2.0), outcome(0.004, 2.0)])
    assert found.position_m == pytest.approx(np.sqrt((0.003**2 + 0.004**2) / 2.0))
    assert (found.runs, found.lost, found.chaser_m) == (2, 0, 2.0)
    assert found.nees_rotation == pytest.approx(0.0035 / 6.0)


def test_the_table_sets_a_navigated_chaser_beside_the_true_one():
    found = [
        chained("best", NAVIGATED, [outcome(0.004, 2.0)]),
        chained("best", TRUE, [outcome(0.002)]),
    ]
    rows = chain_table(found).rows
    assert "2.00, 2.00" in rows[0]
    assert "2.00, 2.00" not in rows[1]


def test_frames_without_a_state_are_counted():
    lost = outcome(0.003)
    lost.values["position_m"][5] = np.nan
    assert chained("best", TRUE, [lost]).lost == 1


@pytest.mark.parametrize("chaser", [NAVIGATED, TRUE])
def test_a_run_follows_the_target(chaser):
    """Well enough from the third image on; a chaser that knows its state is not off."""
    plan = Plan(Sizes(seeds=1, duration_s=60.0, chain_s=12.0), ("chain",))
    (unit,) = plan.chained("best", chaser)
    found = follow(unit.task).values
    assert len(found["time_s"]) == 13
    assert np.nanmax(found["position_m"][3:]) < 0.1
    assert (found["chaser_m"] > 0.0).all() == (chaser == NAVIGATED)
    assert found["chaser_m"].max() < 15.0
