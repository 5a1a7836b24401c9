from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from models.arrays import Floats
from models.motion.clohessy_wiltshire import (
    EARTH_MU_M3_S2,
    GEO_SEMI_MAJOR_AXIS_M,
    mean_motion,
    propagate,
    state_on_closed_ellipse,
    state_transition,
)

PRINTED_M = 0.5e-5  # Vallado's numbers have five decimals
INTEGRATOR_M = 1e-7  # DOP853 at rtol 1e-12 over one revolution of a 411 m ellipse
ROUNDING = 1e-9  # relative, of products of matrices with entries up to 1e5
GEO_N = mean_motion(GEO_SEMI_MAJOR_AXIS_M)
PERIOD_S = 2.0 * np.pi / GEO_N
ELLIPSE_M = 411.0


def hill_equations(_: float, state: Floats) -> Floats:
    """Solve x'' = 3 n^2 x + 2 n y', y'' = -2 n x', z'' = -n^2 z (Hill 1878)."""
    x, _, z, vx, vy, vz = state
    n = GEO_N
    return np.array([vx, vy, vz, 3 * n * n * x + 2 * n * vy, -2 * n * vx, -n * n * z])


@pytest.mark.parametrize(
    ("time_s", "position_m"),
    [
        (300.0, [-33.34572, -1.47356, -5.89453]),
        (600.0, [-70.93306, 20.35660, -11.16956]),
        (1200.0, [-143.00074, 137.27922, -17.76696]),
    ],
)
def test_vallados_example_6_14(time_s: float, position_m: list[float]) -> None:
    """Vallado, Fundamentals of Astrodynamics and Applications, example 6-14: a released object."""
    n = np.sqrt(398600.4415 / (6378.1363 + 590.0) ** 3)
    state = propagate([0.0, 0.0, 0.0, -0.1, -0.04, -0.02], n, time_s)
    np.testing.assert_allclose(state[:3], position_m, atol=PRINTED_M)
    if time_s == 300.0:
        np.testing.assert_allclose(state[3:], [-0.12034, 0.03239, -0.01895], atol=PRINTED_M)


def test_it_solves_hills_equations() -> None:
    start = np.array([10.0, 0.5, -0.8, -0.015, -1.4e-3, 2e-4])
    times = np.linspace(0.0, PERIOD_S, 7)
    found = solve_ivp(
        hill_equations, (0.0, PERIOD_S), start, "DOP853", times, rtol=1e-12, atol=1e-12
    )
    for time_s, state in zip(times, found.y.T, strict=True):
        np.testing.assert_allclose(propagate(start, GEO_N, time_s), state, atol=INTEGRATOR_M)


def test_it_approximates_keplers_motion_of_two_satellites() -> None:
    """Two inertial orbits, differenced in the target's frame; 10 m apart at GEO for 330 s."""

    def gravity(_: float, state: Floats) -> Floats:
        distance = np.linalg.norm(state[:3])
        return np.concatenate([state[3:], -EARTH_MU_M3_S2 * state[:3] / distance**3])

    relative = state_on_closed_ellipse(ELLIPSE_M, GEO_N, radial_m=10.0, normal_m=0.8)
    radius, spin = GEO_SEMI_MAJOR_AXIS_M, np.array([0.0, 0.0, GEO_N])
    target = np.array([radius, 0.0, 0.0, 0.0, radius * GEO_N, 0.0])
    chaser = target + np.concatenate([relative[:3], relative[3:] + np.cross(spin, relative[:3])])
    solved = solve_ivp(gravity, (0.0, 330.0), chaser, "DOP853", rtol=1e-13, atol=1e-9)
    angle = GEO_N * 330.0
    c, s = np.cos(angle), np.sin(angle)
    hill_from_inertial = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    position = hill_from_inertial @ solved.y[:3, -1] - [radius, 0.0, 0.0]
    # Second order in separation over radius: n^2 t^2 d^2 / r is 1e-9 m; the rest is the
    # integrator's rounding on 4.2e7 m.
    np.testing.assert_allclose(propagate(relative, GEO_N, 330.0)[:3], position, atol=1e-5)


@given(st.floats(-1e5, 1e5), st.floats(-1e5, 1e5))
def test_two_spans_make_one(first_s: float, second_s: float) -> None:
    together = state_transition(GEO_N, first_s + second_s)
    product = state_transition(GEO_N, second_s) @ state_transition(GEO_N, first_s)
    scale = np.array([1, 1, 1, GEO_N, GEO_N, GEO_N])  # positions in m, velocities over n
    np.testing.assert_allclose(
        together * scale / scale[:, None], product * scale / scale[:, None], atol=1e3 * ROUNDING
    )


@given(st.floats(-1e5, 1e5))
def test_the_flow_keeps_volume(time_s: float) -> None:
    assert np.linalg.det(state_transition(GEO_N, time_s)) == pytest.approx(1.0, abs=ROUNDING)


def test_no_time_is_no_change() -> None:
    np.testing.assert_array_equal(state_transition(GEO_N, 0.0), np.eye(6))


def test_geo_takes_a_sidereal_day() -> None:
    assert pytest.approx(86164.1, abs=2.0) == PERIOD_S  # half a kilometre of 42164 km is 1.5 s


@given(st.floats(-200.0, 200.0), st.floats(-50.0, 50.0))
def test_the_closed_ellipse_comes_back(radial_m: float, normal_m: float) -> None:
    start = state_on_closed_ellipse(ELLIPSE_M, GEO_N, radial_m, normal_m)
    np.testing.assert_allclose(propagate(start, GEO_N, PERIOD_S)[:3], start[:3], atol=1e-9)


def test_the_closed_ellipse_is_2_by_1_with_the_papers_semi_major_axis() -> None:
    start = state_on_closed_ellipse(ELLIPSE_M, GEO_N, radial_m=10.0)
    times = np.linspace(0.0, PERIOD_S, 721)
    path = np.array([propagate(start, GEO_N, time_s)[:2] for time_s in times])
    radial, along = path.T
    centre_along = 0.5 * (along.min() + along.max())
    half_along = 0.5 * (along.max() - along.min())
    assert half_along == pytest.approx(ELLIPSE_M, rel=2e-5)  # cos of half the sampling step
    on_ellipse = (radial / (ELLIPSE_M / 2)) ** 2 + ((along - ELLIPSE_M) / ELLIPSE_M) ** 2
    np.testing.assert_allclose(on_ellipse, 1.0, atol=1e-10)
    assert centre_along == pytest.approx(ELLIPSE_M, rel=2e-5)


@given(st.floats(1.0, 200.0))
def test_the_closed_ellipse_crosses_the_target_along_the_radial(radial_m: float) -> None:
    start = state_on_closed_ellipse(ELLIPSE_M, GEO_N, radial_m)
    time_to_crossing = np.arcsin(radial_m / (ELLIPSE_M / 2.0)) / GEO_N
    crossing = propagate(start, GEO_N, time_to_crossing)
    np.testing.assert_allclose(crossing[:3], 0.0, atol=1e-9)
    np.testing.assert_allclose(crossing[3:], [-GEO_N * ELLIPSE_M / 2.0, 0.0, 0.0], atol=1e-13)


def test_a_height_that_the_ellipse_does_not_reach_is_refused() -> None:
    with pytest.raises(ValueError, match=r"semi-minor axis of 205.5 m, got 300.0 m"):
        state_on_closed_ellipse(ELLIPSE_M, GEO_N, radial_m=300.0)


@pytest.mark.parametrize("axis_m", [0.0, -1.0, float("nan")])
def test_an_orbit_without_size_is_refused(axis_m: float) -> None:
    with pytest.raises(ValueError, match="semi-major axis in m above zero"):
        mean_motion(axis_m)
