"""An approach of two satellites, each on an orbit of its own, from states at an epoch.

The target's nominal axes go round with its orbit, as those of Opromolla et al. 2022, section 4.1:
z away from the Earth, x back along the track, y against the orbit's normal, and it may sway about
them. The chaser turns so that its camera looks at a point of the target. Nobody steers: both fly as
the field of the Earth, Sun, Moon, light and air have it, or on Kepler's ellipses.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from models.arrays import Floats
from models.motion.aimed_camera import aimed_camera
from models.motion.approach import ORBITAL_TARGET_FROM_HILL
from models.motion.attitude_wobble import AttitudeWobble
from models.motion.perturbed_orbit import PerturbedOrbit, lvlh_axes
from models.motion.perturbed_tumble import local_frame_rate
from models.motion.relative_state import ChaserState
from models.pose import RigidTransform

STEADY = AttitudeWobble(np.zeros(3), np.zeros((3, 1)), np.ones((3, 1)), np.zeros((3, 1)))
"""A target that does not sway."""


class Orbit(Protocol):
    """Where a satellite is; ``KeplerOrbit`` is one."""

    def state(self, time_s: float, /) -> ChaserState:
        """Return its inertial position and velocity."""
        ...


@dataclass(frozen=True, eq=False)
class RealOrbit:
    """An orbit in the real field; an instant beyond its ends is met at constant acceleration.

    A shutter that is open about time zero asks for one: in a second the jerk of a geostationary
    orbit makes 3 micrometres of that, the same for both satellites.

    Attributes
    ----------
    orbit : PerturbedOrbit
    """

    orbit: PerturbedOrbit

    def state(self, time_s: float) -> ChaserState:
        """Return the inertial position and velocity."""
        inside_s = min(max(time_s, 0.0), self.orbit.duration_s)
        state = self.orbit.states(np.array([inside_s]))[0]
        position, velocity, beyond_s = state[:3], state[3:], time_s - inside_s
        if beyond_s != 0.0:
            pull = self.orbit.acceleration(inside_s, position, velocity)
            position = position + beyond_s * velocity + 0.5 * beyond_s**2 * pull
            velocity = velocity + beyond_s * pull
        return ChaserState(time_s, position, velocity)


def beside(
    target: ChaserState,
    acceleration: Floats,
    from_target_m: Floats,
    from_target_m_s: Floats,
) -> ChaserState:
    """Return the state of a satellite beside another.

    Parameters
    ----------
    target : ChaserState
        Of the other.
    acceleration : (3,) array, m/s2
        The other's, inertial: its local frame turns by it.
    from_target_m, from_target_m_s : (3,) array, m and m/s
        Radial, along the track and normal, in the other's local frame; the rate is that in the
        turning frame.
    """
    state = np.concatenate([target.position_in_inertial, target.velocity_in_inertial])
    axes, turning = lvlh_axes(state[:3], state[3:]), local_frame_rate(state, acceleration)
    rate = from_target_m_s + np.cross(turning, from_target_m)
    return ChaserState(target.time_s, state[:3] + axes @ from_target_m, state[3:] + axes @ rate)


@dataclass(frozen=True, eq=False)
class TwoOrbits:
    """One approach; every pose is a pure function of these and of time.

    Attributes
    ----------
    target, chaser : Orbit
        Inertial, axes of the ICRS.
    target_com : (3,) array, m
        The target's centre of mass, target frame.
    aim : (3,) array, m
        What the camera looks at, target frame.
    chaser_com_to_camera_m : float, m
        Along the boresight.
    wobble : AttitudeWobble
        How the target sways about its centre of mass.
    """

    target: Orbit
    chaser: Orbit
    target_com: Floats
    aim: Floats
    chaser_com_to_camera_m: float = 1.5
    wobble: AttitudeWobble = STEADY

    def inertial_from_orbital_target(self, time_s: float) -> Floats:
        """Return the (3, 3) rotation of the target's nominal axes."""
        state = self.target.state(time_s)
        axes = lvlh_axes(state.position_in_inertial, state.velocity_in_inertial)
        return np.asarray(axes @ ORBITAL_TARGET_FROM_HILL.T)

    def target_from_inertial(self, time_s: float) -> Floats:
        """Return the (3, 3) rotation of the target among the stars, sway and all."""
        nominal = self.inertial_from_orbital_target(time_s).T
        return np.asarray(self.wobble.nominal_from_target(time_s).T @ nominal)

    def chaser_in_orbital_target(self, time_s: float) -> Floats:
        """Return the chaser's centre of mass, (3,), m, about the target's, nominal axes."""
        own, other = self.target.state(time_s), self.chaser.state(time_s)
        away = other.position_in_inertial - own.position_in_inertial
        return np.asarray(self.inertial_from_orbital_target(time_s).T @ away)

    def orbital_target_from_target(self, time_s: float) -> RigidTransform:
        """Return the target's true pose: it sways about its centre of mass."""
        rotation = self.wobble.nominal_from_target(time_s)
        return RigidTransform(rotation, -rotation @ self.target_com)

    def cam_from_target(self, time_s: float) -> RigidTransform:
        """Return the true pose at an instant."""
        orbital_from_target = self.orbital_target_from_target(time_s)
        chaser = self.chaser_in_orbital_target(time_s)
        cam_from_orbital = aimed_camera(
            chaser, orbital_from_target @ self.aim, self.chaser_com_to_camera_m
        )
        return cam_from_orbital @ orbital_from_target

    @cached_property
    def planned(self) -> TwoOrbits:
        """The same with a target that does not sway, as the chaser reckons with."""
        return TwoOrbits(
            self.target, self.chaser, self.target_com, self.aim, self.chaser_com_to_camera_m
        )
