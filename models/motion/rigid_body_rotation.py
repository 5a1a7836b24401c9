"""A body that turns freely: Euler's equation without torque, and the attitude that follows."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.integrate import OdeSolution, solve_ivp
from scipy.spatial.transform import Rotation

from models.arrays import Floats

TOLERANCE = 1e-12
LONGEST_STEP_RAD = 0.3  # turned by one step: the dense output is of lower order than the steps


def euler_rate(inertia_kg_m2: Floats, omega_in_body: Floats) -> Floats:
    """Return the (3,) angular acceleration of a free body, rad/s2, in its own axes.

    ``I omega' = -omega x (I omega)``: what is left of Pesce et al. 2019, equation 12, whose
    brackets are lost in print, when both bodies are taken each in its own axes.
    """
    torque = -np.cross(omega_in_body, inertia_kg_m2 @ omega_in_body)
    return np.asarray(np.linalg.solve(inertia_kg_m2, torque))


@dataclass(frozen=True, eq=False)
class RigidBodyRotation:
    """The free rotation of a body from a given attitude and rate.

    Attributes
    ----------
    inertia_kg_m2 : (3, 3) array, kg m2
        About the centre of mass, body axes: symmetric, positive definite.
    omega_in_body : (3,) array, rad/s
        Inertial rate at time zero.
    R_inertial_from_body : (3, 3) array
        Attitude at time zero.
    duration_s : float, s
        How long it is followed.

    Raises
    ------
    ValueError
        If the matrix is the inertia of no body.
    """

    inertia_kg_m2: Floats
    omega_in_body: Floats
    R_inertial_from_body: Floats
    duration_s: float

    def __post_init__(self) -> None:
        inertia = self.inertia_kg_m2
        if inertia.shape != (3, 3) or not np.allclose(inertia, inertia.T):
            raise ValueError(f"expected a symmetric (3, 3) inertia in kg m2, got {inertia}")
        moments = np.linalg.eigvalsh(inertia)
        if not (moments[0] > 0.0 and moments[2] <= moments[0] + moments[1]):
            raise ValueError(
                "expected positive principal moments, none larger than the other two together, "
                f"got {moments} kg m2"
            )

    def omega_at(self, time_s: float) -> Floats:
        """Return the (3,) inertial rate in body axes, rad/s."""
        return self._solution(time_s)[:3]

    def inertial_from_body(self, time_s: float) -> Floats:
        """Return the (3, 3) attitude."""
        return self._first @ Rotation.from_quat(self._solution(time_s)[3:]).as_matrix()

    @property
    def _first(self) -> Floats:
        return self.R_inertial_from_body

    @cached_property
    def _solution(self) -> OdeSolution:
        inertia = self.inertia_kg_m2
        inverse = np.linalg.inv(inertia)

        def rate(_: float, state: Floats) -> Floats:
            wx, wy, wz, qx, qy, qz, qw = state.tolist()
            omega = state[:3]
            turn = (
                0.5 * (qw * wx + qy * wz - qz * wy),
                0.5 * (qw * wy + qz * wx - qx * wz),
                0.5 * (qw * wz + qx * wy - qy * wx),
                -0.5 * (qx * wx + qy * wy + qz * wz),
            )
            return np.concatenate([-inverse @ np.cross(omega, inertia @ omega), turn])

        speed = float(np.linalg.norm(self.omega_in_body))
        found = solve_ivp(
            rate,
            (0.0, self.duration_s),
            np.concatenate([self.omega_in_body, [0.0, 0.0, 0.0, 1.0]]),
            method="DOP853",
            dense_output=True,
            rtol=TOLERANCE,
            atol=TOLERANCE * np.array([*3 * [max(speed, 1e-6)], *4 * [1.0]]),
            max_step=LONGEST_STEP_RAD / speed if speed > 0.0 else np.inf,
        )
        if not found.success or found.sol is None:
            raise RuntimeError(f"the rotation could not be integrated: {found.message}")
        return found.sol
