"""Two satellites on their own orbits: against Clohessy-Wiltshire, and against light's own push."""

from __future__ import annotations

import numpy as np
import pytest

from models.arrays import Floats
from models.gravity.disturbances import SOLAR_PRESSURE_N_M2
from models.motion.approach import Approach
from models.motion.clohessy_wiltshire import EARTH_MU_M3_S2
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.perturbed_orbit import Ball, PerturbedOrbit, lvlh_axes
from models.motion.relative_state import ChaserState
from models.motion.two_orbits import RealOrbit, TwoOrbits, beside
from models.sky.sun_ephemeris import epoch_of, sun_dir_in_inertial

EPOCH = epoch_of("2026-03-20T12:00:00Z")
STEADY = Approach(pointing_accuracy_deg=0.0)
COM = np.array([0.0, 0.0, -STEADY.target_com_to_ring_m])
TARGET = KeplerOrbit(42_164_000.0, 0.0, 0.0, 0.0, 0.0, 2.4).state(0.0)
# The next term of gravity's gradient, 1.5 n^2 rho^2 / a, makes 1e-9 m of 10 m in 330 s; places of
# 4e7 m are rounded to 7e-9.
SAME_M = 5e-8
LIGHT, HEAVY = Ball(1500.0, 15.0), Ball(3800.0, 50.0)


def point_mass(state: ChaserState) -> Floats:
    place = state.position_in_inertial
    return np.asarray(-EARTH_MU_M3_S2 * place / np.linalg.norm(place) ** 3)


def start_of(approach: Approach) -> tuple[Floats, Floats]:
    state = approach._start_state
    return state[:3], state[3:]


def kepler_pair() -> TwoOrbits:
    chaser = beside(TARGET, point_mass(TARGET), *start_of(STEADY))
    return TwoOrbits(
        KeplerOrbit.from_state(TARGET),
        KeplerOrbit.from_state(chaser),
        COM,
        np.array(STEADY.pattern_centre),
    )


def real_pair(target: Ball, chaser: Ball) -> TwoOrbits:
    def flown(state: ChaserState, ball: Ball) -> RealOrbit:
        return RealOrbit(
            PerturbedOrbit(
                EPOCH, state.position_in_inertial, state.velocity_in_inertial, 330.0, ball, 8
            )
        )

    own = flown(TARGET, target)
    pull = own.orbit.acceleration(0.0, TARGET.position_in_inertial, TARGET.velocity_in_inertial)
    return TwoOrbits(
        own,
        flown(beside(TARGET, pull, *start_of(STEADY)), chaser),
        COM,
        np.array(STEADY.pattern_centre),
    )


@pytest.mark.parametrize("time_s", [0.0, 100.0, 330.0])
def test_two_ellipses_are_hills_ellipse_where_they_are_near(time_s: float) -> None:
    expected = STEADY.chaser_in_orbital_target(time_s)
    np.testing.assert_allclose(
        kepler_pair().chaser_in_orbital_target(time_s), expected, atol=SAME_M, rtol=0.0
    )


def test_a_pose_is_the_approachs_own_where_the_aim_is() -> None:
    """The approach's aim wanders by its curvature and slew; looked at there, the poses are one."""
    pair = kepler_pair()
    for time_s in (0.0, 150.0, 330.0):
        aimed = TwoOrbits(pair.target, pair.chaser, COM, STEADY.aim_in_target(time_s))
        own, other = aimed.cam_from_target(time_s), STEADY.cam_from_target(time_s)
        np.testing.assert_allclose(own.translation, other.translation, atol=SAME_M)
        np.testing.assert_allclose(own.rotation, other.rotation, atol=SAME_M)


def test_the_camera_looks_at_its_aim() -> None:
    pair = kepler_pair()
    seen = pair.cam_from_target(200.0) @ pair.aim
    np.testing.assert_allclose(seen[:2], 0.0, atol=1e-9)
    assert seen[2] > 0.0


def test_light_pushes_two_satellites_apart_by_what_they_weigh() -> None:
    """Relative to two ellipses: half of the pressure's difference, times the time squared.

    All else acts on both alike: of the Earth's flattening its gradient over 10 m, 4e-12 m/s2.
    """
    time_s = 330.0
    pushed = real_pair(HEAVY, LIGHT).chaser_in_orbital_target(time_s)
    pushed = pushed - kepler_pair().chaser_in_orbital_target(time_s)
    coefficient = LIGHT.pressure_coefficient
    difference = LIGHT.area_m2 / LIGHT.mass_kg - HEAVY.area_m2 / HEAVY.mass_kg
    push = -SOLAR_PRESSURE_N_M2 * coefficient * difference * sun_dir_in_inertial(EPOCH)
    expected = kepler_pair().inertial_from_orbital_target(0.0).T @ (0.5 * push * time_s**2)
    size = float(np.linalg.norm(expected))
    assert size > 1e-4
    # The Sun is 0.5 % nearer in March, the axes turn by 1.4 deg meanwhile.
    np.testing.assert_allclose(pushed, expected, atol=0.03 * size)


def test_satellites_alike_stay_on_hills_ellipse_in_the_real_field() -> None:
    pushed = real_pair(HEAVY, HEAVY).chaser_in_orbital_target(330.0)
    # J2 by its gradient makes 4e-12 m/s2 over 10 m, Moon and Sun less: 0.3 um of half a t squared.
    np.testing.assert_allclose(pushed, STEADY.chaser_in_orbital_target(330.0), atol=2e-6)


def test_an_instant_before_the_start_lies_on_the_way() -> None:
    pair = real_pair(HEAVY, LIGHT)
    for time_s in (-0.033, 330.5):
        step = 1e-3
        ahead = pair.chaser_in_orbital_target(time_s + step)
        back = pair.chaser_in_orbital_target(time_s - step)
        middle = pair.chaser_in_orbital_target(time_s)
        np.testing.assert_allclose(0.5 * (ahead + back), middle, atol=SAME_M)


def test_the_local_axes_are_the_targets() -> None:
    pair = kepler_pair()
    axes = lvlh_axes(TARGET.position_in_inertial, TARGET.velocity_in_inertial)
    nominal = pair.inertial_from_orbital_target(0.0)
    np.testing.assert_allclose(nominal[:, 2], axes[:, 0], atol=1e-12)  # away from the Earth
    np.testing.assert_allclose(nominal[:, 0], -axes[:, 1], atol=1e-12)  # back along the track
    np.testing.assert_allclose(nominal[:, 1], -axes[:, 2], atol=1e-12)
