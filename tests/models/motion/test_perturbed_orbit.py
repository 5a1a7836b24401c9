"""The true orbit: conserved quantities, J2's drift of the node, another integrator, a push."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from models.gravity.field import earth_gravity
from models.motion.gravity_gradient import GravityGradientAttitude
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.perturbed_orbit import Ball, Manoeuvre, PerturbedOrbit, lvlh_axes
from models.quaternions import rotated
from models.sky.sun_ephemeris import epoch_of

PERIOD_S = 6027.0


def orbit(duration_s: float = PERIOD_S, **more) -> PerturbedOrbit:
    start = KeplerOrbit.from_elements_deg(
        a_km=7158.0,
        e=0.0,
        i_deg=98.5,
        raan_deg=0.0,
        argument_of_perigee_deg=0.0,
        true_anomaly_deg=0.0,
    ).state(0.0)
    return PerturbedOrbit(
        epoch_of("2026-03-20T12:00:00Z"),
        start.position_in_inertial,
        start.velocity_in_inertial,
        duration_s,
        Ball(100.0, 1.28),
        **more,
    )


LEO = orbit(degree=12)


def test_another_integrator_finds_the_same_orbit():
    """Radau: implicit, of another family; ten minutes, for it is slow."""
    own = replace(LEO, duration_s=600.0)

    def slope(time_s, state):
        return np.concatenate([state[3:], own.acceleration(time_s, state[:3], state[3:])])

    start = np.concatenate([own.position_m, own.velocity_m_s])
    other = solve_ivp(slope, (0.0, 600.0), start, method="Radau", rtol=1e-10, atol=1e-6)
    assert own.states(np.array([600.0]))[0, :3] == pytest.approx(other.y[:3, -1], abs=0.01)


def test_the_node_moves_as_j2_says():
    """Sun-synchronous: 0.9856 deg a day eastward; the osculating node wobbles within an orbit."""
    states = LEO.states(np.array([0.0, PERIOD_S]))
    normals = np.cross(states[:, :3], states[:, 3:])
    nodes = np.rad2deg(np.arctan2(normals[:, 0], -normals[:, 1]))
    rate_deg_day = (nodes[1] - nodes[0]) / PERIOD_S * 86_400.0
    n = np.sqrt(3.986e14 / 7.158e6**3)
    secular = -1.5 * earth_gravity(2).j2 * (6.378e6 / 7.158e6) ** 2 * n * np.cos(np.deg2rad(98.5))
    assert rate_deg_day == pytest.approx(np.rad2deg(secular) * 86_400.0, rel=0.03)


def test_leaving_out_the_earths_rotation_is_caught():
    """The classic error: a field that stands still. It is tens of metres after an orbit."""
    still = replace(LEO, earth_turns=False)
    end_s = np.array([PERIOD_S])
    apart_m = np.linalg.norm(LEO.states(end_s)[0, :3] - still.states(end_s)[0, :3])
    assert apart_m > 10.0


def test_between_its_steps_it_keeps_to_its_own_law():
    """The dense output's slope is the acceleration: to 1e-7 of it."""
    for now_s in (37.0, 1234.5, 5000.1):
        states = LEO.states(np.array([now_s - 0.5, now_s, now_s + 0.5]))
        slope = states[2, 3:] - states[0, 3:]
        pull = LEO.acceleration(now_s, states[1, :3], states[1, 3:])
        assert slope == pytest.approx(pull, abs=1e-6)  # half a second of the orbit's third order


def test_a_push_along_the_track_raises_the_orbit():
    pushed = replace(LEO, manoeuvres=(Manoeuvre(100.0, 160.0, (0.0, 0.01, 0.0)),))
    before, after = (each.states(np.array([100.0, 160.0])) for each in (LEO, pushed))
    assert after[0] == pytest.approx(before[0], abs=1e-4)
    gained = np.linalg.norm(after[1, 3:]) - np.linalg.norm(before[1, 3:])
    assert gained == pytest.approx(0.6, rel=0.01)


def test_a_long_body_hangs_towards_the_earth():
    """Libration of an elongated body about the vertical is stable, and keeps its energy."""
    attitude = GravityGradientAttitude(LEO, (26.0, 28.0, 10.7), off_deg=(1.0, 2.0, 0.5))
    times_s = np.linspace(0.0, PERIOD_S, 200)
    states = LEO.states(times_s)
    down = -states[:, :3] / np.linalg.norm(states[:, :3], axis=1, keepdims=True)
    axis = rotated(attitude.quaternions(times_s), np.broadcast_to([0.0, 0.0, 1.0], (200, 3)))
    off_deg = np.rad2deg(np.arccos(np.sum(down * axis, axis=1)))
    assert off_deg[0] == pytest.approx(np.hypot(1.0, 2.0), abs=0.01)
    assert off_deg.max() < 4.0
    upside = GravityGradientAttitude(LEO, (10.7, 12.0, 22.0), off_deg=(0.0, 2.0, 0.0))
    turned = rotated(upside.quaternions(times_s), np.broadcast_to([0.0, 0.0, 1.0], (200, 3)))
    assert np.rad2deg(np.arccos(np.sum(down * turned, axis=1))).max() > 20.0  # a flat one does not


def test_quaternions_turn_at_the_rates():
    attitude = GravityGradientAttitude(LEO, (26.0, 28.0, 10.7), off_deg=(1.0, 2.0, 0.5))
    times_s = np.array([999.99, 1000.01])
    ends = attitude.quaternions(times_s)
    x = rotated(ends, np.broadcast_to([1.0, 0.0, 0.0], (2, 3)))
    rate = attitude.rates(np.array([1000.0]))[0]
    moved = rotated(ends[:1], np.cross(rate, [1.0, 0.0, 0.0])[None])[0] * 0.02
    assert x[1] - x[0] == pytest.approx(moved, abs=1e-8)


def test_axes_of_the_local_frame_are_right_handed():
    axes = lvlh_axes(np.array([7e6, 0.0, 0.0]), np.array([10.0, 7500.0, 0.0]))
    assert axes == pytest.approx(np.eye(3), abs=2e-3)
    assert np.linalg.det(axes) == pytest.approx(1.0)
