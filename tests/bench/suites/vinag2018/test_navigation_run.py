"""Flights: as good as the bound, honest on their own model, the same by sums as at 100 Hz."""

from dataclasses import replace

import numpy as np
import pytest

from bench.suites.vinag2018.cases import GEO, LEO
from bench.suites.vinag2018.flight import flight_of
from bench.suites.vinag2018.navigation_bound import BoundTask, bound
from bench.suites.vinag2018.navigation_run import NavigationTask, navigate
from bench.suites.vinag2018.summaries import bound_summary, flight_summary
from models.motion.perturbed_orbit import Manoeuvre

SPAN_S = 400.0
RUNS = 8
SMOOTH = replace(LEO, degree=8)  # the filter knows J2 alone, and a small field is quick


def task(case=SMOOTH, variant="best", runs=RUNS, span_s=SPAN_S, **more) -> NavigationTask:
    return NavigationTask(case, variant, "", span_s, 0, tuple(range(runs)), star_rate_hz=1, **more)


@pytest.fixture(scope="module")
def modelled():
    return navigate(task(modelled=True))


def test_with_truth_of_its_own_model_it_reaches_the_bound(modelled):
    """RMSE over bound: 1 but for the sample; eight runs' errors hang together for a minute."""
    found = flight_summary([modelled], modelled=True)
    best = bound_summary(bound(BoundTask(SMOOTH, "best", "", SPAN_S)))
    assert found.rms_m / best.position_m == pytest.approx(1.0, abs=0.2)
    assert found.rms_along_m == pytest.approx(best.along_m, rel=0.45)


def test_with_truth_of_its_own_model_it_is_honest(modelled):
    """Mean NEES of eight runs and some ten independent instants."""
    found = flight_summary([modelled], modelled=True)
    for each, spread in ((found.orbit, 0.2), (found.attitude, 0.2), (found.whole, 0.15)):
        assert each.mean == pytest.approx(1.0, abs=spread)


def test_by_sums_of_samples_it_is_the_same_as_at_100_hz():
    """The same samples, one run: errors within two percent."""
    sums = task(runs=1, span_s=60.0)
    sums = replace(sums, star_rate_hz=5)
    one, other = (navigate(each).values for each in (sums, replace(sums, each_sample=True)))
    for name in ("position_m", "attitude_rad"):
        sizes = [np.sqrt(np.mean(each[name][10:] ** 2)) for each in (one, other)]
        assert sizes[1] == pytest.approx(sizes[0], rel=0.02)
    apart = np.abs(one["position_m"] - other["position_m"])[10:, 0]
    assert (apart / one["sigma"][10:, :3]).max() < 0.02


def test_a_run_is_the_same_in_any_company(modelled):
    """Single precision, in which outcomes are kept: batches of other sizes round otherwise."""
    alone = navigate(replace(task(modelled=True, span_s=100.0), runs=(3,))).values
    for name in ("position_m", "attitude_rad", "clock"):
        together = modelled.values[name][: len(alone["time_s"]), 3:4]
        assert alone[name] == pytest.approx(together, abs=1e-4 * float(np.abs(together).max()))


def test_without_the_mask_ionospheric_outliers_return():
    """In GEO with 9 dBi, while a ray grazes the layer: what the mask leaves out is metres off."""
    case, span_s = replace(GEO, gain_dbi=9.0, record_s=1.0), 240.0
    flight = flight_of(case, span_s)
    received = flight.reception(np.arange(10.0, span_s, 10.0))
    low = received.tracked & (received.lowest_height_m < 6e5)
    assert low.any(axis=1).mean() > 0.5
    masked, bare = (
        navigate(task(case, "paper", runs=2, span_s=span_s, mask=mask)) for mask in (True, False)
    )
    assert bare.values["used"].min() > masked.values["used"].max()
    off = [np.abs(each.values["position_m"][60:]).mean() for each in (masked, bare)]
    honest = [each.values["nees_orbit"][60:].mean() for each in (masked, bare)]
    assert honest[1] > 3.0 * honest[0]
    assert off[1] > off[0]


def test_lasting_errors_are_estimated_as_well_as_they_can_be():
    """Beside its bound, honest; the filter that takes them as white is neither."""
    span_s = 300.0
    knowing = flight_summary([navigate(task(span_s=span_s, runs=3, correlated=True))])
    believing = flight_summary([navigate(task(variant="paper", span_s=span_s, correlated=True))])
    best = bound_summary(bound(BoundTask(SMOOTH, "best", "", span_s, correlated=True)))
    assert knowing.rms_m < 1.6 * best.position_m  # three runs of one constellation: one draw each
    assert knowing.orbit.mean < 1.6
    assert believing.orbit.mean > 2.0


def test_a_flight_may_manoeuvre():
    quiet = flight_of(SMOOTH, 200.0)
    pushed = flight_of(SMOOTH, 200.0, (Manoeuvre(50.0, 100.0, (0.0, 0.01, 0.0)),))
    apart = pushed.orbit.states(np.array([200.0])) - quiet.orbit.states(np.array([200.0]))
    assert np.linalg.norm(apart[0, 3:]) == pytest.approx(0.5, rel=0.1)


def test_sun_and_moon_stand_between_their_knots():
    flight = flight_of(SMOOTH, 2000.0)
    at, beside = flight.bodies(600.0), flight.bodies(600.0 - 1e-6)
    for one, other in zip(at, beside, strict=True):
        assert one == pytest.approx(other, rel=1e-9)
