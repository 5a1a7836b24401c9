"""How a target turns between two frames, and how well that is known.

A turn's error is a small rotation in target axes: ``R_true = R exp([turn]x)``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.motion.kepler_orbit import KeplerOrbit
from pipelines.filters.lasting_errors import WHITE, LastingErrors
from pipelines.filters.navigation_options import NavigationOptions

LONGEST_TURN_RAD = 0.05  # of one Runge-Kutta step: its error is below 1e-9 rad then
_IDENTITY = np.eye(3)


def skew(vector: Floats) -> Floats:
    """Return ``[v]x``, (3, 3), for which ``[v]x w = v x w``.

    Parameters
    ----------
    vector : (3,) array
    """
    x, y, z = vector.tolist()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def turn_matrix(vector: Floats) -> Floats:
    """Return ``exp([v]x)``, (3, 3), of a rotation vector in rad: Rodrigues' formula."""
    angle = math.sqrt(float(vector @ vector))
    cross = skew(vector)
    half = 0.5 * angle
    ratio = math.sin(half) / half if half else 1.0
    first = math.sin(angle) / angle if angle else 1.0
    return _IDENTITY + first * cross + 0.5 * ratio * ratio * (cross @ cross)


def turn_between(start: Floats, end: Floats) -> Floats:
    """Return the (3,) rotation vector, rad, with ``end = start exp([turn]x)``."""
    turn = start.T @ end
    sines = 0.5 * np.array(
        [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
    )
    sine = math.sqrt(float(sines @ sines))
    cosine = 0.5 * (float(np.trace(turn)) - 1.0)
    if cosine < -0.9:  # near half a turn the sines say little of the axis
        return Rotation.from_matrix(turn).as_rotvec()
    return sines * (math.atan2(sine, cosine) / sine) if sine else sines


@dataclass(frozen=True, eq=False)
class RotationState:
    """An attitude and a rate, with their covariance.

    Attributes
    ----------
    R_lvlh_from_target : (3, 3) array
    omega_in_target : (3,) array, rad/s
        The rate that the process carries on: relative or inertial, see ``RotationProcess``.
    covariance : (6 + n, 6 + n) array, rad and rad/s
        Of (turn, omega, lasting).
    lasting : (n,) array
        Errors of the measured poses, in sigmas; see ``pipelines.filters.lasting_errors``.
    """

    R_lvlh_from_target: Floats
    omega_in_target: Floats
    covariance: Floats
    lasting: Floats = field(default_factory=lambda: np.zeros(0))

    def turned(self, correction: Floats, covariance: Floats) -> RotationState:
        """Return the state after a (6 + n,) correction of (turn, omega, lasting)."""
        return RotationState(
            self.R_lvlh_from_target @ turn_matrix(correction[:3]),
            self.omega_in_target + correction[3:6],
            covariance,
            self.lasting + correction[6:],
        )


@dataclass(frozen=True, eq=False)
class FreeBody:
    """A target of known inertia that nothing turns: ``I omega' = -omega x (I omega)``.

    Attributes
    ----------
    inertia : (3, 3) array
        About the centre of mass, target axes, in any unit.
    accuracy : float
        1 sigma of each of its entries, over the geometric mean of the two moments it joins.
    """

    inertia: Floats
    accuracy: float

    def rate(self, omega: Floats) -> Floats:
        """Return the (3,) angular acceleration, rad/s2."""
        return np.asarray(-self._inverse @ (skew(omega) @ (self.inertia @ omega)))

    def jacobian(self, omega: Floats) -> Floats:
        """Return the (3, 3) derivative of the acceleration with respect to the rate, 1/s."""
        gyroscopic = skew(self.inertia @ omega) - skew(omega) @ self.inertia
        return np.asarray(self._inverse @ gyroscopic)

    def carry(self, omega: Floats, step_s: float) -> tuple[Floats, Floats]:
        """Return the (3, 3) turn over a step and the rate after it.

        The rate by Runge and Kutta's steps, the turn by Magnus' expansion to fourth order, with
        the mean rate by Simpson's rule.
        """
        turned_rad = abs(step_s) * float(np.linalg.norm(omega))
        count = max(1, int(np.ceil(turned_rad / LONGEST_TURN_RAD)))
        turn, h = np.eye(3), step_s / count
        for _ in range(count):
            k1 = self.rate(omega)
            k2 = self.rate(omega + 0.5 * h * k1)
            k3 = self.rate(omega + 0.5 * h * k2)
            k4 = self.rate(omega + h * k3)
            after = omega + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
            middle = 0.5 * (omega + after) + h / 8.0 * (k1 - self.rate(after))
            mean = (omega + 4.0 * middle + after) / 6.0
            bend = h * h / 12.0 * (skew(omega) @ after)
            turn = turn @ turn_matrix(h * mean + bend)
            omega = after
        return turn, omega

    def rate_covariance(self, omega: Floats) -> Floats:
        """Return the (3, 3) covariance of ``rate`` for an inertia no more accurate than it is.

        ``d(omega') = -I^-1 (omega x dI omega + dI omega')``, entry by entry.
        """
        by_entry = self._errors @ omega @ skew(omega).T + self._errors @ self.rate(omega)
        effects = by_entry @ self._inverse.T
        return np.asarray(effects.T @ effects)

    @cached_property
    def _errors(self) -> Floats:
        """The six (3, 3) 1-sigma changes of the inertia, one for each entry."""
        sigma = self.accuracy * np.sqrt(np.diag(self.inertia))
        changes = np.zeros((6, 3, 3))
        for change, i, j in zip(changes, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2], strict=True):
            change[i, j] = change[j, i] = sigma[i] * np.sqrt(self.inertia[j, j])
        return changes

    @cached_property
    def _inverse(self) -> Floats:
        return np.asarray(np.linalg.inv(self.inertia), dtype=np.float64)


class RotationProcess:
    """Constant rate, or Euler's equation where the inertia is known.

    Parameters
    ----------
    options : NavigationOptions
    inertia_kg_m2 : (3, 3) array, optional
        Of the target, in its own axes; its scale does not matter.
    lasting : LastingErrors
        Of the measured attitudes.
    """

    def __init__(
        self,
        options: NavigationOptions,
        inertia_kg_m2: Floats | None = None,
        lasting: LastingErrors = WHITE,
    ) -> None:
        self._options = options
        self._lasting = lasting
        self._body = None
        if inertia_kg_m2 is not None and options.rate_model == "inertial":
            self._body = FreeBody(inertia_kg_m2, options.inertia_accuracy)

    def predict(
        self, state: RotationState, orbit: KeplerOrbit, from_s: float, to_s: float
    ) -> RotationState:
        """Carry a state from one frame to the next.

        Parameters
        ----------
        state : RotationState
        orbit : KeplerOrbit
            The chaser's.
        from_s, to_s : float, s
        """
        step_s = to_s - from_s
        turn, omega = self._carry(state.omega_in_target, step_s)
        attitude = state.R_lvlh_from_target @ turn
        spin = orbit.anomaly_rate(to_s)
        if self._options.rate_model == "inertial":
            advance = orbit.true_anomaly(to_s) - orbit.true_anomaly(from_s)
            attitude = turn_matrix(np.array([0.0, 0.0, -advance])) @ attitude
        transition, noise = self._linear(0.5 * (state.omega_in_target + omega), spin, step_s)
        apart = turn_between(state.R_lvlh_from_target, attitude)
        transition, noise = self._lasting.carried(transition, noise, float(np.linalg.norm(apart)))
        covariance = transition @ state.covariance @ transition.T + noise
        kept = transition[6:, 6:] @ state.lasting
        return RotationState(attitude, omega, 0.5 * (covariance + covariance.T), kept)

    def relative_from_state(
        self, state: RotationState, orbit: KeplerOrbit, time_s: float
    ) -> tuple[Floats, Floats]:
        """Return the rate relative to the local frame, (3,) rad/s, and its (6, 6) covariance.

        Parameters
        ----------
        state : RotationState
        orbit : KeplerOrbit
            The chaser's.
        time_s : float, s
        """
        if self._options.rate_model == "relative":
            return state.omega_in_target, state.covariance[:6, :6]
        spin = state.R_lvlh_from_target.T @ [0.0, 0.0, orbit.anomaly_rate(time_s)]
        change = np.eye(6)
        change[3:, :3] = -skew(spin)
        return state.omega_in_target - spin, change @ state.covariance[:6, :6] @ change.T

    def state_from_relative(
        self,
        attitude: Floats,
        omega: Floats,
        covariance: Floats,
        orbit: KeplerOrbit,
        time_s: float,
    ) -> RotationState:
        """Return what ``relative_from_state`` takes back.

        Parameters
        ----------
        attitude : (3, 3) array
            ``R_lvlh_from_target``.
        omega : (3,) array, rad/s
            Relative to the local frame, in target axes.
        covariance : (6, 6) array, rad and rad/s
            Of (turn, omega), and of the lasting errors, (6 + n, 6 + n).
        orbit : KeplerOrbit
            The chaser's.
        time_s : float, s
        """
        lasting = np.zeros(len(covariance) - 6)
        if self._options.rate_model == "relative":
            return RotationState(attitude, omega, covariance, lasting)
        spin = attitude.T @ [0.0, 0.0, orbit.anomaly_rate(time_s)]
        change = np.eye(len(covariance))
        change[3:6, :3] = skew(spin)
        return RotationState(attitude, omega + spin, change @ covariance @ change.T, lasting)

    def acceleration_covariance(self, omega: Floats, spin_of_lvlh: float) -> Floats:
        """Return the (3, 3) covariance of the acceleration that the model leaves out, rad2/s4.

        A free body's acceleration is its rate squared times a ratio of differences of its moments
        of inertia, which is below 1 for every body; in the turning frame ``omega x omega_lvlh``
        comes to it.
        """
        if self._body is not None:
            return self._body.rate_covariance(omega)
        speed = float(np.linalg.norm(omega))
        if self._options.rate_model == "inertial":
            return (self._options.asymmetry * speed**2) ** 2 * np.eye(3)
        # The relative rate may be small while the target turns with the local frame.
        own = self._options.asymmetry * (speed + spin_of_lvlh) ** 2
        return (own**2 + (speed * spin_of_lvlh) ** 2) * np.eye(3)

    def _carry(self, omega: Floats, step_s: float) -> tuple[Floats, Floats]:
        """Return the turn over a step, and the rate after it."""
        if self._body is None:
            return turn_matrix(omega * step_s), omega
        return self._body.carry(omega, step_s)

    def _linear(self, omega: Floats, spin: float, step_s: float) -> tuple[Floats, Floats]:
        """Return the (6, 6) transition of (turn, omega) and its process noise.

        Both from one exponential (Van Loan, Computing Integrals Involving the Matrix Exponential,
        1978). The acceleration left out stays the same for about a radian: white noise of that
        correlation time has the spectral density of its square times twice the time.
        """
        correlation_s = 1.0 / max(float(np.linalg.norm(omega)), spin)
        density = 2.0 * correlation_s * self.acceleration_covariance(omega, spin)
        flow = np.zeros((6, 6))
        flow[:3, :3] = -skew(omega)
        flow[:3, 3:] = np.eye(3)
        if self._body is not None:
            flow[3:, 3:] = self._body.jacobian(omega)
        both = np.zeros((12, 12))
        both[:6, :6] = flow
        both[3:6, 9:] = density
        both[6:, 6:] = -flow.T
        carried = expm(step_s * both)
        transition = carried[:6, :6]
        noise = carried[:6, 6:] @ transition.T
        return transition, 0.5 * (noise + noise.T)
