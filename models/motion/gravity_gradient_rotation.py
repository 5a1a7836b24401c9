"""A body that turns on a circular orbit: Euler's equation with Earth's gravity gradient."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.integrate import OdeSolution, solve_ivp
from scipy.spatial.transform import Rotation

from models.arrays import Floats

TOLERANCE = 1e-12
LONGEST_STEP_RAD = 0.3  # turned by one step: the dense output is of lower order than the steps
LONGEST_STEP_ORBIT_RAD = 0.1


def gravity_gradient_rate(
    inertia_kg_m2: Floats, omega_in_body: Floats, radial_in_body: Floats, mean_motion_rad_s: float
) -> Floats:
    """Return the (3,) angular acceleration in body axes, rad/s2.

    ``I omega' = -omega x (I omega) + 3 n^2 r x (I r)``, r the unit vector away from Earth
    (Volpe et al. 2017, equation 18d; Hughes, Spacecraft Attitude Dynamics, section 8.1).

    Parameters
    ----------
    inertia_kg_m2 : (3, 3) array, kg m2
        In any unit: its scale cancels.
    omega_in_body : (3,) array, rad/s
        Inertial rate.
    radial_in_body : (3,) array
    mean_motion_rad_s : float, rad/s
    """
    torque = 3.0 * mean_motion_rad_s**2 * np.cross(radial_in_body, inertia_kg_m2 @ radial_in_body)
    torque -= np.cross(omega_in_body, inertia_kg_m2 @ omega_in_body)
    return np.asarray(np.linalg.solve(inertia_kg_m2, torque))


@dataclass(frozen=True, eq=False)
class GravityGradientRotation:
    """The rotation of a rigid body on a circular orbit, from a given attitude and rate.

    Attributes
    ----------
    inertia_kg_m2 : (3, 3) array, kg m2
        About the centre of mass, body axes.
    omega_in_body : (3,) array, rad/s
        Inertial rate at time zero.
    R_lvlh_from_body : (3, 3) array
        Attitude at time zero with respect to the local frame (radial, along track, normal).
    mean_motion_rad_s : float, rad/s
        Of the orbit; zero leaves the body free.
    duration_s : float, s
        How long it is followed.
    """

    inertia_kg_m2: Floats
    omega_in_body: Floats
    R_lvlh_from_body: Floats
    mean_motion_rad_s: float
    duration_s: float

    def omega_at(self, time_s: float) -> Floats:
        """Return the (3,) inertial rate in body axes, rad/s."""
        return self._solution(time_s)[:3]

    def lvlh_from_body(self, time_s: float) -> Floats:
        """Return the (3, 3) attitude with respect to the local frame of that time."""
        turn = Rotation.from_quat(self._solution(time_s)[3:]).as_matrix()
        return lvlh_from_first(self.mean_motion_rad_s * time_s) @ self.R_lvlh_from_body @ turn

    @cached_property
    def _solution(self) -> OdeSolution:
        inertia, motion, first = self.inertia_kg_m2, self.mean_motion_rad_s, self.R_lvlh_from_body

        def rate(time_s: float, state: Floats) -> Floats:
            omega, turn = state[:3], Rotation.from_quat(state[3:])
            angle = motion * time_s
            radial = turn.inv().apply(first.T @ [np.cos(angle), np.sin(angle), 0.0])
            half = 0.5 * omega
            x, y, z, w = state[3:]
            spun = np.array(
                [
                    w * half[0] + y * half[2] - z * half[1],
                    w * half[1] + z * half[0] - x * half[2],
                    w * half[2] + x * half[1] - y * half[0],
                    -x * half[0] - y * half[1] - z * half[2],
                ]
            )
            return np.concatenate([gravity_gradient_rate(inertia, omega, radial, motion), spun])

        speed = float(np.linalg.norm(self.omega_in_body))
        fastest = max(speed / LONGEST_STEP_RAD, motion / LONGEST_STEP_ORBIT_RAD)
        found = solve_ivp(
            rate,
            (0.0, self.duration_s),
            np.concatenate([self.omega_in_body, [0.0, 0.0, 0.0, 1.0]]),
            method="DOP853",
            dense_output=True,
            rtol=TOLERANCE,
            atol=TOLERANCE * np.array([*3 * [max(speed, 1e-6)], *4 * [1.0]]),
            max_step=1.0 / fastest if fastest > 0.0 else np.inf,
        )
        if not found.success or found.sol is None:
            raise RuntimeError(f"the rotation could not be integrated: {found.message}")
        return found.sol


def lvlh_from_first(angle_rad: float) -> Floats:
    """Return (3, 3): from the local frame of time zero, held still, to the one an angle later."""
    c, s = float(np.cos(angle_rad)), float(np.sin(angle_rad))
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
