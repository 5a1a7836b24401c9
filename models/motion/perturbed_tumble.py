"""Two satellites on real orbits that drift past each other while the target turns freely.

As ``models.motion.tumble``, but for the orbits: both are in a real field, in air and light, each
by its own mass and area. The target turns without torque all the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

import numpy as np

from models.arrays import Floats
from models.motion.perturbed_orbit import Ball, PerturbedOrbit, lvlh_axes
from models.motion.relative_state import ChaserState, RelativeState
from models.motion.rigid_body_rotation import RigidBodyRotation
from models.motion.tumble import CAM_FROM_LVLH, within
from models.pose import RigidTransform

KNOT_S = 2.0  # a field of degree 36 changes along an orbit over minutes


@dataclass(frozen=True, eq=False)
class LocalFrameAttitude:
    """The attitude of a satellite whose body keeps to its local frame (LVLH).

    Attributes
    ----------
    orbit : PerturbedOrbit
    """

    orbit: PerturbedOrbit

    def quaternions(self, times_s: Floats) -> Floats:
        """Return ``q_inertial_from_body``, (n, 4), scalar first, at times (n,) in s."""
        from scipy.spatial.transform import Rotation

        axes = np.stack([lvlh_axes(each[:3], each[3:]) for each in self.orbit.states(times_s)])
        found: Floats = Rotation.from_matrix(axes).as_quat(scalar_first=True)
        return found

    def rates(self, times_s: Floats) -> Floats:
        """Return the inertial rates in body axes, (n, 3), rad/s, at times (n,) in s."""
        from scipy.interpolate import CubicSpline

        times_s = np.asarray(times_s, dtype=np.float64)
        count = max(4, int(np.ceil(np.ptp(times_s) / KNOT_S)) + 1)
        knots_s = np.linspace(times_s.min(), max(times_s.max(), times_s.min() + KNOT_S), count)
        states = self.orbit.states(knots_s)
        rates = [
            local_frame_rate(each, self.orbit.acceleration(now_s, each[:3], each[3:]))
            for now_s, each in zip(knots_s.tolist(), states, strict=True)
        ]
        found: Floats = CubicSpline(knots_s, np.array(rates))(times_s)
        return found


def local_frame_rate(state: Floats, acceleration: Floats) -> Floats:
    """Return how the local frame turns, (3,), rad/s, in its own axes.

    Parameters
    ----------
    state : (6,) array, m and m/s
        Inertial.
    acceleration : (3,) array, m/s2

    Notes
    -----
    ``h / r^2`` about the normal; the part of the acceleration along the normal, ``a_n``, tilts the
    plane by ``r a_n / h`` about the radius, and nothing turns the frame about the track.
    """
    position, velocity = state[:3], state[3:]
    momentum = np.cross(position, velocity)
    size, radius = float(np.linalg.norm(momentum)), float(np.linalg.norm(position))
    across = float(acceleration @ momentum) / size
    return np.array([radius * across / size, 0.0, size / radius**2])


@dataclass(frozen=True, eq=False)
class PerturbedTumble:
    """The true motion of a target about a chaser; every state is a pure function of time.

    Attributes
    ----------
    chaser, target : PerturbedOrbit
        From time zero.
    rotation : RigidBodyRotation
        Of the target.
    duration_s : float, s
        States exist from 0 to here.
    """

    chaser: PerturbedOrbit
    target: PerturbedOrbit
    rotation: RigidBodyRotation
    duration_s: float

    @classmethod
    def from_start(
        cls,
        epoch: datetime,
        start: ChaserState,
        *,
        rho0_m: Sequence[float],
        rho_dot0_m_s: Sequence[float],
        omega0_rad_s: Floats,
        inertia_kg_m2: Floats,
        R_lvlh_from_target: Floats,
        duration_s: float,
        chaser: Ball,
        target: Ball,
        degree: int,
        overtime_s: float = 0.0,
    ) -> PerturbedTumble:
        """Return the motion from where it begins.

        Parameters
        ----------
        epoch : datetime
            Of time zero.
        start : ChaserState
            Of the chaser, at time zero.
        rho0_m, rho_dot0_m_s : 3 floats, m and m/s
            From the chaser to the target, and its rate in the turning frame; local frame.
        omega0_rad_s : (3,) array, rad/s
            The target's inertial rate, target axes.
        inertia_kg_m2 : (3, 3) array
            Of the target, its own axes.
        R_lvlh_from_target : (3, 3) array
        duration_s : float, s
        chaser, target : Ball
            As air and light meet them.
        degree : int
            Of the gravity field.
        overtime_s : float, s
            By which the chaser's orbit outlasts the motion.
        """
        own = PerturbedOrbit(
            epoch,
            start.position_in_inertial,
            start.velocity_in_inertial,
            duration_s + overtime_s,
            chaser,
            degree,
        )
        first = np.concatenate([start.position_in_inertial, start.velocity_in_inertial])
        axes = lvlh_axes(first[:3], first[3:])
        turning = local_frame_rate(first, own.acceleration(0.0, first[:3], first[3:]))
        rho, rho_dot = np.array(rho0_m), np.array(rho_dot0_m_s)
        other = PerturbedOrbit(
            epoch,
            first[:3] + axes @ rho,
            first[3:] + axes @ (rho_dot + np.cross(turning, rho)),
            duration_s,
            target,
            degree,
        )
        attitude = RigidTransform(R_lvlh_from_target, rho).rotation  # exact
        turn = RigidBodyRotation(inertia_kg_m2, omega0_rad_s, axes @ attitude, duration_s)
        return cls(own, other, turn, duration_s)

    def state(self, time_s: float) -> RelativeState:
        """Return the true relative state.

        Raises
        ------
        ValueError
            If the time is before the start or after ``duration_s``.
        """
        time_s = self._within(time_s)
        own, other = self._states(time_s)
        axes = lvlh_axes(own[:3], own[3:])
        turning = local_frame_rate(own, self.chaser.acceleration(time_s, own[:3], own[3:]))
        rho = axes.T @ (other[:3] - own[:3])
        attitude = axes.T @ self.rotation.inertial_from_body(time_s)
        return RelativeState(
            time_s,
            rho,
            axes.T @ (other[3:] - own[3:]) - np.cross(turning, rho),
            attitude,
            self.rotation.omega_at(time_s) - attitude.T @ turning,
        )

    def chaser_state(self, time_s: float) -> ChaserState:
        """Return the chaser's true inertial position and velocity."""
        time_s = self._within(time_s)
        own, _ = self._states(time_s)
        return ChaserState(time_s, own[:3], own[3:])

    def chaser_state_beside(self, time_s: float) -> ChaserState:
        """Return the chaser's state a shutter's time before the start or after the end."""
        end_s = min(max(time_s, 0.0), self.duration_s)
        own, _ = self._states(end_s)
        late_s = time_s - end_s
        pull = self.chaser.acceleration(end_s, own[:3], own[3:])
        return ChaserState(
            time_s, own[:3] + late_s * (own[3:] + 0.5 * late_s * pull), own[3:] + late_s * pull
        )

    def inertial_from_lvlh(self, time_s: float) -> Floats:
        """Return the (3, 3) rotation out of the chaser's local frame."""
        own, _ = self._states(self._within(time_s))
        return lvlh_axes(own[:3], own[3:])

    def cam_from_target(
        self, time_s: float, cam_from_lvlh: RigidTransform = CAM_FROM_LVLH
    ) -> RigidTransform:
        """Return the true pose that the camera sees."""
        return self.state(time_s).cam_from_target(cam_from_lvlh)

    def _states(self, time_s: float) -> tuple[Floats, Floats]:
        at = np.array([time_s])
        return self.chaser.states(at)[0], self.target.states(at)[0]

    def _within(self, time_s: float) -> float:
        return within(time_s, self.duration_s)
