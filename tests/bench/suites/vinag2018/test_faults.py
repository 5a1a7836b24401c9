"""A lying satellite, a GNSS gap, a swapped star frame: detected, told of, survived."""

from dataclasses import replace

import numpy as np
import pytest

from bench.suites.vinag2018.cases import LEO
from bench.suites.vinag2018.flight import flight_of
from bench.suites.vinag2018.navigation_run import NavigationTask, navigate
from bench.suites.vinag2018.plan import FAULT_S, LIAR
from renders.flight.faults import Faults

CASE = replace(LEO, degree=8)
RUNS = 3
STAR_SIGMA_RAD = 2.6e-5  # of a frame, the coarse axis


def flown(faults: Faults, span_s: float, variant: str = "best", star_rate_hz: int = 1):
    runs = tuple(range(RUNS))
    task = NavigationTask(
        CASE, variant, "", span_s, 1, runs, star_rate_hz=star_rate_hz, faults=faults
    )
    return navigate(task).values


def sizes_m(values) -> np.ndarray:
    return np.linalg.norm(values["position_m"], axis=-1)


def test_the_liar_of_the_suite_is_tracked_while_it_lies():
    times_s = np.arange(200.0, 500.0, 20.0)
    assert flight_of(LEO, FAULT_S).reception(times_s).tracked[:, LIAR].all()


def test_a_lying_satellite_is_named_and_left_out():
    """150 m from 200 s to 300 s: edited at once, named within ten seconds, not named after."""
    lie = Faults(liar=LIAR, lie_m=150.0, lie_start_s=200.0, lie_end_s=300.0)
    honest, lied = flown(Faults(), 330.0), flown(lie, 330.0)
    during = slice(205, 295)
    assert lied["edited"][during].min() == 1.0
    assert lied["named"][210:295].min() == 1.0
    assert lied["named"][:199].max() == lied["named"][325:].max() == 0.0
    shift = np.abs(lied["position_m"] - honest["position_m"])[during]
    assert (shift / lied["sigma"][during][:, None, :3]).max() < 1.0
    assert lied["doubts"].max() == 0.0


def test_the_paper_variant_believes_the_liar():
    lie = Faults(liar=LIAR, lie_m=150.0, lie_start_s=200.0, lie_end_s=300.0)
    assert sizes_m(flown(lie, 300.0, "paper"))[280:].mean() > 3.0


def test_ten_minutes_without_gnss_are_told_and_survived():
    """The stated sigma grows with the error, and both are small again a minute later."""
    gap = Faults(gap_start_s=200.0, gap_end_s=800.0)
    values = flown(gap, 900.0)
    size, sigma = sizes_m(values), np.linalg.norm(values["sigma"][:, :3], axis=1)
    used = values["used"]
    assert used[205:795].max() == 0
    assert used[805:].min() > 10
    assert sigma[790] > 20.0 * sigma[190]
    assert size[:, :].max(axis=1)[790] < 4.0 * sigma[790]
    assert sigma[890] < 3.0 * sigma[190]
    assert size[890].max() < 4.0 * sigma[890]
    assert values["doubts"].max() == 0.0


def test_a_swapped_star_frame_is_refused():
    swap = Faults(swapped_s=100.0, swapped_frames=1, swapped_deg=30.0)
    right, swapped = flown(Faults(), 130.0), flown(swap, 130.0)
    assert swapped["refused"].tolist() == [1.0] * RUNS
    assert right["refused"].max() == 0.0
    apart = np.abs(swapped["attitude_rad"] - right["attitude_rad"])
    assert apart.max() < 3.0 * STAR_SIGMA_RAD  # one frame less to go by


def test_a_sensor_that_stays_elsewhere_is_believed_in_the_end():
    """Half a minute of frames that agree with each other and not with the filter."""
    swap = Faults(swapped_s=60.0, swapped_frames=40, swapped_deg=5.0)
    values = flown(swap, 99.0)
    off_deg = np.rad2deg(np.linalg.norm(values["attitude_rad"], axis=-1))
    assert values["doubts"].min() >= 1.0
    assert off_deg[70].max() < 0.1
    assert off_deg[-1] == pytest.approx(5.0, abs=0.1)
