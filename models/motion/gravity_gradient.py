"""How a satellite without control turns in the Earth's gravity gradient."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.integrate import OdeSolution, solve_ivp

from models.arrays import Floats
from models.gravity.field import MU_M3_S2
from models.motion.perturbed_orbit import PerturbedOrbit, lvlh_axes

TOLERANCE = 1e-12
LONGEST_STEP_RAD = 0.02  # of the orbit: the dense output is of lower order than the steps
KNOT_RAD = 0.01  # of the orbit


@dataclass(frozen=True, eq=False)
class GravityGradientAttitude:
    """The attitude of a rigid body along an orbit.

    The body's nominal axes: x along the track, y against the orbit's normal, z to the Earth.

    Attributes
    ----------
    orbit : PerturbedOrbit
    moments_kg_m2 : (float, float, float), kg m2
        Principal moments about those axes.
    off_deg : (float, float, float), deg
        Turn away from the nominal axes at time zero, a rotation vector in body axes.
    """

    orbit: PerturbedOrbit
    moments_kg_m2: tuple[float, float, float]
    off_deg: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def quaternions(self, times_s: Floats) -> Floats:
        """Return ``q_inertial_from_body``, (n, 4), scalar first, at times (n,) in s."""
        found = self._solution(np.asarray(times_s)).T[:, 3:]
        return found / np.linalg.norm(found, axis=1, keepdims=True)

    def rates(self, times_s: Floats) -> Floats:
        """Return the inertial rates in body axes, (n, 3), rad/s, at times (n,) in s."""
        return self._solution(np.asarray(times_s)).T[:, :3]

    @cached_property
    def _solution(self) -> OdeSolution:
        from scipy.interpolate import CubicSpline
        from scipy.spatial.transform import Rotation

        moments = np.array(self.moments_kg_m2)
        torque_arms = np.array(
            [moments[2] - moments[1], moments[0] - moments[2], moments[1] - moments[0]]
        )
        end_s = self.orbit.duration_s
        first = self.orbit.states(np.zeros(1))[0]
        speed = float(np.linalg.norm(np.cross(first[:3], first[3:])) / (first[:3] @ first[:3]))
        knots_s = np.linspace(0.0, end_s, max(8, int(end_s * speed / KNOT_RAD)))
        place = CubicSpline(knots_s, self.orbit.states(knots_s)[:, :3])  # torque needs no more

        axes = lvlh_axes(first[:3], first[3:])
        nominal = np.stack([axes[:, 1], -axes[:, 2], -axes[:, 0]], axis=1)
        off = Rotation.from_rotvec(self.off_deg, degrees=True)
        attitude = Rotation.from_matrix(nominal) * off
        omega = off.inv().apply([0.0, -speed, 0.0])

        def slope(time_s: float, state: Floats) -> Floats:
            wx, wy, wz, w, x, y, z = state.tolist()
            here = place(time_s)
            radius = np.sqrt(here @ here)
            up = _into_body(state[3:], here / radius)
            twist = 3.0 * MU_M3_S2 / radius**3
            # I' omega = 3 mu / r^3 up x I up - omega x I omega, in principal axes.
            products = np.array(
                [
                    twist * up[1] * up[2] - wy * wz,
                    twist * up[2] * up[0] - wz * wx,
                    twist * up[0] * up[1] - wx * wy,
                ]
            )
            turn = (
                -0.5 * (x * wx + y * wy + z * wz),
                0.5 * (w * wx + y * wz - z * wy),
                0.5 * (w * wy + z * wx - x * wz),
                0.5 * (w * wz + x * wy - y * wx),
            )
            return np.concatenate([torque_arms * products / moments, turn])

        found = solve_ivp(
            slope,
            (0.0, end_s),
            np.concatenate([omega, attitude.as_quat(scalar_first=True)]),
            method="DOP853",
            dense_output=True,
            rtol=TOLERANCE,
            atol=TOLERANCE * np.array([*3 * [speed], *4 * [1.0]]),
            max_step=LONGEST_STEP_RAD / speed,
        )
        if not found.success or found.sol is None:
            raise RuntimeError(f"the attitude could not be integrated: {found.message}")
        return found.sol


def _into_body(q_inertial_from_body_wxyz: Floats, vector: Floats) -> Floats:
    w, axis = q_inertial_from_body_wxyz[0], -q_inertial_from_body_wxyz[1:]
    once = np.cross(axis, vector)
    return vector + 2.0 * (w * once + np.cross(axis, once))
