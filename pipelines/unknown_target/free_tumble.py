"""How an unknown body turns, and how that depends on its first rate and its inertia.

The attitude error is a small turn in body axes, ``R_true = R exp([turn]x)``. Its first value is
the gauge and no unknown: the body's axes are what the first camera's were.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import OdeSolution, solve_ivp
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from pipelines.filters.rotation_process import skew
from pipelines.unknown_target import inertia_chart

UNKNOWNS = 3 + inertia_chart.SIZE
RELATIVE, ABSOLUTE = 1e-9, 1e-10
LONGEST_STEP_RAD = 0.5  # turned by one step: the dense output is of lower order than the steps


@dataclass(frozen=True, eq=False)
class Attitudes:
    """The body at some times.

    Attributes
    ----------
    R_start_from_body : (n, 3, 3) array
        From body axes to those of the local frame at the start, held still.
    omega : (n, 3) array, rad/s
        Inertial rate, body axes.
    turn_by_unknowns, omega_by_unknowns : (n, 3, 8) array
        By the first rate and the inertia's chart.
    """

    R_start_from_body: Floats
    omega: Floats
    turn_by_unknowns: Floats
    omega_by_unknowns: Floats


class FreeTumble:
    """One way of turning, followed as far as it is asked for.

    Parameters
    ----------
    omega : (3,) array, rad/s
        First inertial rate.
    chart : (5,) array
        Of the inertia, see ``inertia_chart``.
    R_start_from_body : (3, 3) array
        First attitude.
    mean_motion_rad_s : float, rad/s
        Of the target's circular orbit, for the gravity gradient; zero leaves the body free.
    until_s : float, s
        After the start: how far it is followed at once.
    """

    def __init__(
        self,
        omega: Floats,
        chart: Floats,
        R_start_from_body: Floats,
        mean_motion_rad_s: float,
        until_s: float,
    ) -> None:
        self._first = R_start_from_body
        self._motion = mean_motion_rad_s
        self._inertia = inertia_chart.inertia_of(chart)
        self._by_chart = inertia_chart.derivatives(chart)
        self._inverse = np.asarray(np.linalg.inv(self._inertia), dtype=np.float64)
        self.until_s = until_s
        self._solution = self._solve(omega, until_s)

    def at(self, times_s: Floats) -> Attitudes:
        """Return the body at (n,) times after the start, s, none beyond ``until_s``."""
        states = self._solution(times_s).T
        flows = states[:, 7:].reshape(-1, 2, 3, UNKNOWNS)
        turns = Rotation.from_quat(states[:, 3:7]).as_matrix()
        return Attitudes(self._first @ turns, states[:, :3], flows[:, 0], flows[:, 1])

    def _solve(self, omega: Floats, until_s: float) -> OdeSolution:
        flow = np.zeros((2, 3, UNKNOWNS))
        flow[1, :, :3] = np.eye(3)
        speed = float(np.linalg.norm(omega))
        found = solve_ivp(
            self._rate,
            (0.0, until_s),
            np.concatenate([omega, [0.0, 0.0, 0.0, 1.0], flow.ravel()]),
            method="DOP853",
            dense_output=True,
            rtol=RELATIVE,
            atol=ABSOLUTE,
            max_step=LONGEST_STEP_RAD / max(speed, self._motion, 1e-9),
        )
        if not found.success or found.sol is None:
            raise RuntimeError(f"the rotation could not be integrated: {found.message}")
        return found.sol

    def _rate(self, time_s: float, state: Floats) -> Floats:
        omega, inertia = state[:3], self._inertia
        x, y, z, w = (0.5 * state[3:7]).tolist()
        p, q, r = omega.tolist()
        spun = [w * p + y * r - z * q, w * q + z * p - x * r, w * r + x * q - y * p,
                -x * p - y * q - z * r]  # fmt: skip
        turns, rates = state[7:].reshape(2, 3, UNKNOWNS)
        radial = self._radial(time_s, state[3:7])
        pull = 3.0 * self._motion**2
        across, lever = skew(omega), skew(radial)
        weighed, tide = inertia @ omega, inertia @ radial
        faster = self._inverse @ (pull * (lever @ tide) - across @ weighed)
        by_omega = self._inverse @ (skew(weighed) - across @ inertia)
        by_turn = pull * (self._inverse @ ((lever @ inertia - skew(tide)) @ lever))
        by_chart = self._by_chart @ np.stack([omega, radial, faster], axis=1)  # (5, 3, 3)
        effects = pull * (lever @ by_chart[:, :, 1].T) - across @ by_chart[:, :, 0].T
        effects -= by_chart[:, :, 2].T
        flow = np.empty((2, 3, UNKNOWNS))
        flow[0] = rates - across @ turns
        flow[1] = by_omega @ rates + by_turn @ turns
        flow[1, :, 3:] += self._inverse @ effects
        return np.concatenate([faster, spun, flow.ravel()])

    def _radial(self, time_s: float, quaternion: Floats) -> Floats:
        """Return the unit vector away from Earth in body axes, (3,)."""
        angle = self._motion * time_s
        radial = self._first.T @ np.array([np.cos(angle), np.sin(angle), 0.0])
        axis, scalar = quaternion[:3], float(quaternion[3])
        cross = skew(axis) @ radial  # the quaternion's own turn is undone
        turned = radial - 2.0 * scalar * cross + 2.0 * (skew(axis) @ cross)
        return np.asarray(turned / float(quaternion @ quaternion))
