from __future__ import annotations

from datetime import timedelta

import numpy as np
import pytest
from beyond.constants import Earth
from beyond.dates import Date
from beyond.frames.frames import HillFrame
from beyond.orbits import Orbit, StateVector
from beyond.propagators.rpo import YamanakaAnkersen
from hypothesis import given
from hypothesis import strategies as st

from models.motion.clohessy_wiltshire import EARTH_MU_M3_S2
from models.motion.clohessy_wiltshire import state_transition as clohessy_wiltshire
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.relative_motion import integrate, linear_rate
from models.motion.yamanaka_ankersen import state_transition

INTEGRATOR_M = 1e-9  # DOP853 at rtol 1e-12 over half an hour, tens of metres
ROUNDING = 1e-9  # of products of entries up to 1e6, for 1 / (1 - e^2) up to 5
LEO = KeplerOrbit(7.1431e6, 1.4e-4, np.deg2rad(98.2), 1.38, 1.5, 0.0)
HEO = KeplerOrbit(6.69316e7, 0.808, np.deg2rad(69.9), 6.15, 1.68, np.deg2rad(30.0))
GEO = KeplerOrbit(4.21641e7, 1.1e-4, np.deg2rad(0.005), 4.8, 0.73, 0.0)
START = {  # Pesce et al. 2019, Table 4
    "LEO": (LEO, np.array([0.0, 30.0, 0.0, 0.0, 1e-4, 0.0])),
    "HEO": (HEO, np.array([0.0, 30.0, 0.0, 3e-3, -1e-3, 0.0])),
    "GEO": (GEO, np.array([0.0, 40.0, 0.0, 0.0, -1e-4, 0.0])),
}
OUT_OF_PLANE = np.array([1.0, 0.0, -5.0, 0.0, 0.0, 2e-3])  # Table 4 has nothing there
CASES = pytest.mark.parametrize("name", list(START))
orbits = st.builds(
    KeplerOrbit,
    semi_major_axis_m=st.just(2e7),
    eccentricity=st.floats(0.0, 0.8),
    inclination_rad=st.just(0.5),
    raan_rad=st.just(0.0),
    argument_of_perigee_rad=st.just(0.0),
    true_anomaly_rad=st.floats(-3.1, 3.1),
)
times = st.floats(-20_000.0, 20_000.0)


@CASES
def test_it_solves_the_linear_equation(name: str) -> None:
    orbit, start = START[name]
    start = start + OUT_OF_PLANE
    found = integrate(orbit, start, (0.0, 1800.0), linear_rate)
    for time_s in (1.0, 700.0, 1800.0):
        carried = state_transition(orbit, 0.0, time_s) @ start
        np.testing.assert_allclose(carried, found(time_s), atol=INTEGRATOR_M)


@given(st.floats(-3.1, 3.1), st.floats(-1e4, 1e4))
def test_on_a_circle_it_is_clohessy_and_wiltshires(anomaly: float, time_s: float) -> None:
    circle = KeplerOrbit(7.0e6, 0.0, 1.0, 0.0, 0.0, anomaly)
    n = circle.mean_motion_rad_s
    units = np.array([1, 1, 1, n, n, n])  # positions in m, velocities over n
    np.testing.assert_allclose(
        state_transition(circle, 0.0, time_s) * units / units[:, None],
        clohessy_wiltshire(n, time_s) * units / units[:, None],
        atol=ROUNDING,
    )


@CASES
@pytest.mark.parametrize("span_s", [60.0, 1800.0])
def test_it_agrees_with_beyond(name: str, span_s: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """An independent program; with its own constant of gravity they would part by 5e-6 m."""
    monkeypatch.setattr(Earth, "mass", EARTH_MU_M3_S2 / (Earth.mu / Earth.mass))
    orbit, start = START[name]
    start = start + OUT_OF_PLANE
    elements = [
        orbit.semi_major_axis_m,
        orbit.eccentricity,
        orbit.inclination_rad,
        orbit.raan_rad,
        orbit.argument_of_perigee_rad,
        orbit.true_anomaly_rad,
    ]
    date = Date(2020, 1, 1)
    peer = YamanakaAnkersen(Orbit(elements, date, "keplerian", "EME2000", "Kepler"), "QSW")
    state = StateVector(start, date, "cartesian", HillFrame("QSW")).as_orbit(peer)
    theirs = np.asarray(state.propagate(timedelta(seconds=span_s)))
    ours = state_transition(orbit, 0.0, span_s) @ start
    np.testing.assert_allclose(ours, theirs, atol=1e-8)


@given(orbits, times, times)
def test_two_spans_make_one(orbit: KeplerOrbit, first_s: float, second_s: float) -> None:
    n = orbit.mean_motion_rad_s
    units = np.array([1, 1, 1, n, n, n])
    first = state_transition(orbit, 0.0, first_s) * units / units[:, None]
    then = state_transition(orbit, first_s, second_s) * units / units[:, None]
    together = state_transition(orbit, 0.0, second_s) * units / units[:, None]
    scale = np.linalg.norm(then) * np.linalg.norm(first)
    np.testing.assert_allclose(together, then @ first, atol=ROUNDING * scale)


@given(orbits, times)
def test_the_flow_keeps_volume(orbit: KeplerOrbit, time_s: float) -> None:
    assert np.linalg.det(state_transition(orbit, 0.0, time_s)) == pytest.approx(1.0, abs=1e-6)


@CASES
def test_linearity_costs_less_than_half_a_millimetre_in_half_an_hour(name: str) -> None:
    """So it is not what spoils the HEO row of the paper's Table 6, as the text there has it."""
    orbit, start = START[name]
    linear = state_transition(orbit, 0.0, 1800.0) @ start
    true = integrate(orbit, start, (0.0, 1800.0))(1800.0)
    off_mm = 1e3 * float(np.linalg.norm(linear[:3] - true[:3]))
    assert off_mm == pytest.approx({"LEO": 0.431, "HEO": 0.018, "GEO": 0.0005}[name], rel=0.05)
