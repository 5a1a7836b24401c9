"""The centralised filter: orbit, attitude, clock and biases in one square-root unscented filter."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy

import numpy as np

from models.arrays import Floats, Indices, Mask
from models.gnss.tracking_noise import SPEED_OF_LIGHT_M_S
from models.navigation_records import (
    GnssEpoch,
    InertialInterval,
    NavigationRecord,
    StarAttitude,
)
from models.quaternions import conjugate, mean_quaternion, multiplied
from pipelines.absolute.dynamics import carried, process_noise_factor, tides
from pipelines.absolute.error_state import (
    ATTITUDE,
    CLOCK,
    POSITION,
    SIZE,
    VELOCITY,
    AbsoluteState,
)
from pipelines.absolute.integrity import GnssVerdict, Integrity, StarVerdict
from pipelines.absolute.measurements import range_and_rate_sigmas, ranges_and_rates, unmasked
from pipelines.absolute.options import DEG_H, AbsoluteOptions
from pipelines.filters.rodrigues_error import error_parameters, error_quaternion
from pipelines.filters.square_root_unscented import (
    UnscentedWeights,
    lower_factor,
    measurement_update,
    predicted_factor,
    sigma_deviations,
)

LEFT_OUT = 1e4  # by so much an edited measurement's sigma grows: it tells nothing any more
DOUBT_POSITION_M, DOUBT_VELOCITY_M_S, DOUBT_ATTITUDE_RAD = 3000.0, 3.0, 0.2
SAME_TIME_S = 1e-6

Bodies = Callable[[float], tuple[Floats, Floats]]
"""Where Sun and Moon are at a time: inertial, (3,) each, m."""


class AbsoluteNavigator:
    """A filter that takes records in the order of their times.

    Parameters
    ----------
    options : AbsoluteOptions
    state : AbsoluteState
        To start from; see ``started_from``. It is changed.
    bodies : callable, optional
        Needed where the options have Sun and Moon in the model.

    Raises
    ------
    ValueError
        If Sun and Moon are in the model and ``bodies`` is not given.
    """

    def __init__(
        self, options: AbsoluteOptions, state: AbsoluteState, bodies: Bodies | None = None
    ) -> None:
        if options.third_bodies and bodies is None:
            raise ValueError("expected the places of Sun and Moon, which the model has, got none")
        self.options = options
        self.state = state
        self.integrity = Integrity(len(state.vector))
        self._bodies = bodies if options.third_bodies else None
        self._rate = np.zeros_like(state.vector[:, ATTITUDE])  # of the last turn, rad/s
        self._tracked: dict[int, int] = {}  # satellite to slot
        self._last_s: dict[int, float] = {}
        self._weights = UnscentedWeights(
            SIZE + options.slots, options.alpha, options.beta, options.kappa
        )

    def take(self, record: NavigationRecord) -> bool:
        """Take one record; return whether it was used.

        A record from before the state's time comes too late, and is counted instead.
        """
        begins_s = record.time_s
        if isinstance(record, InertialInterval):
            begins_s -= record.duration_s
        if begins_s < self.state.time_s - SAME_TIME_S:
            self.integrity.late += 1
            return False
        if isinstance(record, InertialInterval):
            self.propagate(record)
            return True
        if isinstance(record, GnssEpoch):
            self.take_gnss(record)
        else:
            self.take_stars(record)
        return True

    def propagate(self, interval: InertialInterval) -> None:
        """Carry the state over what the inertial unit measured."""
        state, weights, force = self.state, self._weights, interval.specific_force_m_s2
        deviations = sigma_deviations(state.factor, weights)
        tide = None
        if self._bodies is not None:
            middle_s = state.time_s + 0.5 * interval.duration_s
            tide = tides(state.vector[:, None, POSITION], self._bodies(middle_s))
        points, quaternions = carried(
            state.vector[:, None, :] + deviations,
            multiplied(
                state.q_inertial_from_body_wxyz[:, None, :],
                error_quaternion(deviations[..., ATTITUDE]),
            ),
            interval.turn_rad[:, None, :],
            interval.duration_s,
            self.options,
            tide,
            None if force is None else force[:, None, :],
        )
        # About the first point, or a clock of 9e7 m would cost the digits of the others.
        shifts = points - points[:, :1]
        offset = np.einsum("i,bij->bj", weights.mean, shifts)
        mean = mean_quaternion(quaternions, weights.mean)
        spread = shifts - offset[:, None, :]
        spread[..., ATTITUDE] = error_parameters(
            multiplied(conjugate(mean)[:, None, :], quaternions)
        )
        vector = points[:, 0] + offset
        vector[:, ATTITUDE] = 0.0
        noise = process_noise_factor(self.options, interval.duration_s, force is not None)
        self._rate = interval.turn_rad / interval.duration_s
        self.state = AbsoluteState(
            interval.time_s, vector, mean, predicted_factor(spread, noise, weights)
        )

    def carried_to(self, time_s: float) -> AbsoluteState:
        """Return the state at a time after the last record, turning on as it did; none is taken.

        Parameters
        ----------
        time_s : float, s
            Not later than a few sampling times; before the state's own it is given as it is.
        """
        span_s = time_s - self.state.time_s
        if span_s <= SAME_TIME_S:
            return self.state
        ahead = copy(self)
        ahead.propagate(InertialInterval(time_s, span_s, span_s * self._rate))
        return ahead.state

    def take_gnss(self, epoch: GnssEpoch) -> None:
        """Correct the state by ranges and rates; signals below the mask are passed by."""
        kept = unmasked(epoch, self.state.vector[0, POSITION], self.options)
        verdict = GnssVerdict(epoch.time_s, epoch.satellite[kept], len(epoch.satellite))
        if kept.any():
            own = GnssEpoch(
                epoch.time_s,
                epoch.satellite[kept],
                epoch.sent_from_m[kept],
                epoch.sent_at_m_s[kept],
                epoch.cn0_dbhz[kept],
                epoch.pseudorange_m[:, kept],
                epoch.range_rate_m_s[:, kept],
            )
            self._correct_by_gnss(own, verdict)
        self.integrity.note_gnss(verdict)

    def _correct_by_gnss(self, epoch: GnssEpoch, verdict: GnssVerdict) -> None:
        slots = self._slots_of(epoch) if self.options.slots else None
        state, weights = self.state, self._weights
        deviations = sigma_deviations(state.factor, weights)
        centre = ranges_and_rates(state.vector, epoch, slots)
        points = ranges_and_rates(state.vector[:, None, :] + deviations, epoch, slots)
        shifts = points - centre[:, None, :]
        offset = np.einsum("i,bij->bj", weights.mean, shifts)
        measured = np.concatenate([epoch.pseudorange_m, epoch.range_rate_m_s], axis=-1)
        innovation = measured - centre - offset
        spread = shifts - offset[:, None, :]
        sigmas = np.broadcast_to(range_and_rate_sigmas(epoch, self.options), innovation.shape)
        if self.options.edit_sigmas > 0.0:
            variance = np.einsum("i,bij->bj", weights.covariance, spread**2) + sigmas**2
            edited = innovation**2 > self.options.edit_sigmas**2 * variance
            count = len(epoch.satellite)
            edited = edited[:, :count] | edited[:, count:]  # one that lies is not half believed
            verdict.edited = edited
            sigmas = np.where(np.concatenate([edited, edited], axis=1), LEFT_OUT * sigmas, sigmas)
        noise = sigmas[:, :, None] * np.eye(sigmas.shape[1])
        update = measurement_update(deviations, spread, noise, innovation, weights)
        verdict.nis = update.nis
        self._apply(update.correction, update.factor)
        in_doubt = self.integrity.orbits_in_doubt(verdict, self.options.patience_epochs)
        if in_doubt.any():
            self._doubt(in_doubt, orbit=True)

    def take_stars(self, stars: StarAttitude) -> None:
        """Correct the state by an attitude among the stars."""
        state, weights = self.state, self._weights
        deviations = sigma_deviations(state.factor, weights)
        spread = deviations[..., ATTITUDE]
        innovation = error_parameters(
            multiplied(conjugate(state.q_inertial_from_body_wxyz), stars.q_inertial_from_body_wxyz)
        )
        covariance = np.broadcast_to(stars.covariance_rad2, (len(innovation), 3, 3))
        verdict = StarVerdict(stars.time_s)
        if self.options.edit_sigmas > 0.0:
            factor = state.factor[:, ATTITUDE]
            whole = factor @ factor.swapaxes(-1, -2) + covariance
            solved = np.linalg.solve(whole, innovation[..., None])[..., 0]
            refused = np.sum(innovation * solved, axis=-1) > self.options.edit_sigmas**2
            verdict.refused = refused
            innovation = np.where(refused[:, None], 0.0, innovation)
            covariance = np.where(refused[:, None, None], LEFT_OUT**2 * covariance, covariance)
        noise: Floats = np.linalg.cholesky(np.asarray(covariance, dtype=np.float64))
        update = measurement_update(deviations, spread, noise, innovation, weights)
        verdict.nis = update.nis
        self._apply(update.correction, update.factor)
        in_doubt = self.integrity.attitudes_in_doubt(verdict, self.options.patience_frames)
        if in_doubt.any():
            self._doubt(in_doubt, orbit=False)
        self.integrity.note_stars(verdict)

    def _apply(self, correction: Floats, factor: Floats) -> None:
        vector = self.state.vector + correction
        vector[:, ATTITUDE] = 0.0
        quaternion = multiplied(
            self.state.q_inertial_from_body_wxyz, error_quaternion(correction[:, ATTITUDE])
        )
        self.state = AbsoluteState(self.state.time_s, vector, quaternion, factor)

    def _slots_of(self, epoch: GnssEpoch) -> Indices:
        """Return where each satellite's lasting error stands; a new one's is not known yet."""
        told = epoch.satellite.tolist()
        free = [each for each in range(self.options.slots) if each not in self._tracked.values()]
        gone = sorted(set(self._tracked) - set(told), key=lambda each: self._last_s[each])
        fresh = []
        for satellite in told:
            self._last_s[satellite] = epoch.time_s
            if satellite not in self._tracked:
                slot = free.pop() if free else self._tracked.pop(gone.pop(0))
                self._tracked[satellite] = slot
                fresh.append(SIZE + slot)
        if fresh:
            factor = self.state.factor.copy()
            factor[:, fresh] = 0.0
            known = np.zeros((*factor.shape[:-1], len(fresh)))
            known[:, fresh, np.arange(len(fresh))] = self.options.lasting_m
            self.state.vector[:, fresh] = 0.0
            self.state.factor = lower_factor(np.concatenate([factor, known], axis=-1))
        return SIZE + np.array([self._tracked[each] for each in told])

    def _doubt(self, runs: Mask, orbit: bool) -> None:
        """Widen what a run believes of its orbit and clock, or of its attitude."""
        size = self.state.factor.shape[-1]
        wider = np.zeros(size)
        if orbit:
            wider[POSITION], wider[VELOCITY] = DOUBT_POSITION_M, DOUBT_VELOCITY_M_S
            wider[CLOCK] = [DOUBT_POSITION_M, DOUBT_VELOCITY_M_S]
        else:
            wider[ATTITUDE] = DOUBT_ATTITUDE_RAD
        more = np.broadcast_to(np.diag(wider), (int(runs.sum()), size, size))
        self.state.factor[runs] = lower_factor(
            np.concatenate([self.state.factor[runs], more], axis=-1)
        )


def started_from(
    options: AbsoluteOptions,
    position: Floats,
    velocity: Floats,
    q_inertial_from_body_wxyz: Floats,
    time_s: float = 0.0,
) -> AbsoluteState:
    """Return a state to start from, with the options' first covariance; clock and biases are zero.

    Parameters
    ----------
    options : AbsoluteOptions
    position, velocity : (runs, 3) array, m and m/s
    q_inertial_from_body_wxyz : (runs, 4) array
    time_s : float, s
    """
    runs, size = len(position), SIZE + options.slots
    vector = np.zeros((runs, size))
    vector[:, POSITION], vector[:, VELOCITY] = position, velocity
    factor = np.broadcast_to(np.diag(start_sigmas(options)), (runs, size, size)).copy()
    return AbsoluteState(time_s, vector, np.array(q_inertial_from_body_wxyz), factor)


def start_sigmas(options: AbsoluteOptions) -> Floats:
    """Return 1 sigma of each error state at the start, (n,): 17, and those of the channels."""
    own = np.repeat(
        [
            options.start_position_m,
            options.start_velocity_m_s,
            options.left_out_m_s2,
            np.deg2rad(options.start_attitude_deg),
            options.start_bias_deg_h * DEG_H,
            SPEED_OF_LIGHT_M_S * options.start_clock_s,
            SPEED_OF_LIGHT_M_S * options.start_drift,
        ],
        [3, 3, 3, 3, 3, 1, 1],
    )
    return np.concatenate([own, np.full(options.slots, options.lasting_m)])
