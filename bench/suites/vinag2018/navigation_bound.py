"""The posterior Cramér-Rao bound: what no filter of the same model can be better than.

For Gaussian noise and a motion that is nearly linear within the errors, the bound's recursion
is Kalman's, linearised at the truth, with the sensors' true noise. It is told the process noise of
the variant's model: the bound of ``paper`` is that of a filter that knows J2 alone.

References
----------
P. Tichavsky, C. Muravchik and A. Nehorai, Posterior Cramér-Rao bounds for discrete-time nonlinear
filtering, IEEE Transactions on Signal Processing 46 (1998), equation 21.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bench.suites.units import Outcome
from bench.suites.vinag2018.cases import Case
from bench.suites.vinag2018.flight import flight_of
from models.arrays import Floats, Indices
from models.gnss.range_errors import RangeErrors
from models.gnss.tracking_noise import TrackingLoops
from models.motion.perturbed_orbit import lvlh_axes
from models.sensors.star_sensor import StarSensor
from pipelines.absolute.dynamics import process_noise_factor
from pipelines.absolute.error_state import ATTITUDE, CLOCK, GYRO_BIAS
from pipelines.absolute.navigator import start_sigmas
from pipelines.absolute.options import AbsoluteOptions, absolute_options_for
from renders.flight.flight import Flight

STEP_S, BLOCK_S = 1.0, 1000
ORBIT = [*range(9), CLOCK.start, CLOCK.start + 1]
TURN = [*range(ATTITUDE.start, GYRO_BIAS.stop)]


@dataclass(frozen=True)
class BoundTask:
    """A case by a variant's model.

    Attributes
    ----------
    case : Case
    variant : str
    options : str
        All settings as text.
    duration_s : float, s
    correlated : bool
        Whether the errors of ranges last; the bound then estimates them, too.
    star_rate_hz : int, Hz
        Of the star sensor.
    """

    case: Case
    variant: str
    options: str
    duration_s: float
    correlated: bool = False
    star_rate_hz: int = 5


def bound(task: BoundTask) -> Outcome:
    """Follow the bound over a flight.

    Returns
    -------
    Outcome
        By record (n): ``time_s`` (n,); ``position_m2`` (n, 3, 3), inertial, and ``along_m`` (n, 3),
        1 sigma along radial, track and normal; ``velocity_m_s`` and ``attitude_rad`` (n, 3),
        1 sigma on inertial and on body axes; ``clock`` (n, 2), m and m/s. Seconds of one core.
    """
    began = time.process_time()
    options = absolute_options_for(task.variant, task.case.regime)
    flight = flight_of(task.case, task.duration_s)
    errors = RangeErrors(ionosphere_m=task.case.ionosphere_m, correlated=task.correlated)
    orbit = OrbitBound(flight, options, errors)
    turn = _attitude_bounds(
        options, StarSensor(rate_hz=task.star_rate_hz), task.duration_s, task.case.record_s
    )
    rows = []
    for now_s, state, covariance in orbit.steps():
        if abs(now_s / task.case.record_s - round(now_s / task.case.record_s)) < 1e-9:
            axes = lvlh_axes(state[:3], state[3:])
            along = np.diagonal(axes.T @ covariance[:3, :3] @ axes)
            rows.append(
                {
                    "time_s": np.array(now_s),
                    "position_m2": covariance[:3, :3],
                    "along_m": np.sqrt(along),
                    "velocity_m_s": np.sqrt(np.diagonal(covariance)[3:6]),
                    "clock": np.sqrt(np.diagonal(covariance)[9:11]),
                }
            )
    values = {name: np.stack([row[name] for row in rows]) for name in rows[0]}
    values["attitude_rad"] = turn[: len(rows)]
    return Outcome(values, np.array([time.process_time() - began]))


class OrbitBound:
    """The recursion for position, velocity, acceleration left out, clock, and errors that last.

    Parameters
    ----------
    flight : Flight
    options : AbsoluteOptions
    errors : RangeErrors
    """

    def __init__(self, flight: Flight, options: AbsoluteOptions, errors: RangeErrors) -> None:
        self._flight, self._options, self._errors = flight, options, errors
        self._loops = TrackingLoops()
        satellites = len(flight.constellation)
        lasting = np.repeat([sigma for sigma, _ in errors.lasting], satellites)
        self._left = np.exp(-STEP_S / np.repeat([own for _, own in errors.lasting], satellites))
        self._covariance = np.diag(np.concatenate([start_sigmas(options)[ORBIT], lasting]) ** 2)
        noise = process_noise_factor(options, STEP_S)[ORBIT][:, ORBIT]
        self._noise = np.zeros_like(self._covariance)
        self._noise[:11, :11] = noise @ noise.T
        self._noise[11:, 11:] = np.diag(lasting**2 * (1.0 - self._left**2))

    def steps(self) -> Iterator[tuple[float, Floats, Floats]]:
        """Yield time, true state (6,) and covariance, (11, 11) and more, second by second."""
        count = round(self._flight.duration_s / STEP_S)
        for first in range(0, count, BLOCK_S):
            last = min(first + BLOCK_S, count)
            times_s = np.linspace(first + 1, last, last - first, dtype=np.float64) * STEP_S
            states = self._flight.orbit.states(times_s)
            received = self._flight.reception(times_s)
            senders = self._flight.constellation.states(times_s)
            above = received.lowest_height_m > self._options.mask_height_m
            for place, now_s in enumerate(times_s.tolist()):
                self._predict(states[place])
                heard = np.flatnonzero(received.tracked[place] & above[place])
                if heard.size:
                    own = senders[place, heard]
                    self._correct(states[place], own, received.cn0_dbhz[place, heard], heard)
                yield now_s, states[place], self._covariance

    def _predict(self, state: Floats) -> None:
        step = np.eye(11)
        radius = float(np.linalg.norm(state[:3]))
        up = state[:3] / radius
        gradient = self._options.mu_m3_s2 / radius**3 * (3.0 * np.outer(up, up) - np.eye(3))
        step[:3, :3] += 0.5 * STEP_S**2 * gradient
        step[:3, 3:6] = STEP_S * np.eye(3) + STEP_S**3 / 6.0 * gradient
        step[3:6, :3] = STEP_S * gradient
        step[3:6, 3:6] += 0.5 * STEP_S**2 * gradient
        step[:3, 6:9] = 0.5 * STEP_S**2 * np.eye(3)
        step[3:6, 6:9] = STEP_S * np.eye(3)
        if self._options.left_out_fades:
            step[6:9, 6:9] *= np.exp(-STEP_S / self._options.left_out_s)
        step[9, 10] = STEP_S
        before = self._covariance
        after = np.empty_like(before)
        after[:11, :11] = step @ before[:11, :11] @ step.T
        after[:11, 11:] = step @ before[:11, 11:] * self._left
        after[11:, :11] = after[:11, 11:].T
        after[11:, 11:] = before[11:, 11:] * np.outer(self._left, self._left)
        self._covariance = after + self._noise

    def _correct(self, state: Floats, senders: Floats, cn0_dbhz: Floats, heard: Indices) -> None:
        count = len(heard)
        away = state[:3] - senders[:, :3]
        distance = np.linalg.norm(away, axis=1, keepdims=True)
        sight = away / distance
        drift = state[3:] - senders[:, 3:]
        turning = (drift - sight * np.sum(sight * drift, axis=1, keepdims=True)) / distance
        slopes = np.zeros((2 * count, len(self._covariance)))
        slopes[:count, :3], slopes[:count, 9] = sight, 1.0
        slopes[count:, :3], slopes[count:, 3:6], slopes[count:, 10] = turning, sight, 1.0
        satellites = len(self._flight.constellation)
        for part in range(len(self._errors.lasting)):
            slopes[np.arange(count), 11 + part * satellites + heard] = 1.0
        ranges = np.hypot(self._errors.white_m, self._loops.code_sigma_m(cn0_dbhz))
        noise = np.concatenate([ranges, self._loops.rate_sigma_m_s(cn0_dbhz)])
        spread = self._covariance @ slopes.T
        whole = slopes @ spread + np.diag(noise**2)
        gain = np.linalg.solve(whole, spread.T).T
        keep = np.eye(len(self._covariance)) - gain @ slopes
        # Joseph's form: the plain one loses the clock's 9e7 m in the first second.
        self._covariance = keep @ self._covariance @ keep.T + (gain * noise**2) @ gain.T


def _attitude_bounds(
    options: AbsoluteOptions, stars: StarSensor, duration_s: float, record_s: float
) -> Floats:
    """Return 1 sigma of the attitude at each record, (n, 3), rad, body axes.

    The body turns by 0.1 deg/s at most, which mixes its axes slowly: it is taken as still.
    """
    frame_s = 1.0 / stars.rate_hz
    step = np.eye(6)
    step[:3, 3:] = -frame_s * np.eye(3)
    factor = process_noise_factor(options, frame_s)[TURN][:, TURN]
    noise, measured = factor @ factor.T, stars.covariance_rad2
    covariance = np.diag(start_sigmas(options)[TURN] ** 2)
    every = round(record_s / frame_s)
    sigmas = []
    for frame in range(1, round(duration_s / frame_s) + 1):
        covariance = step @ covariance @ step.T + noise
        gain = np.linalg.solve(covariance[:3, :3] + measured, covariance[:3]).T
        covariance = covariance - gain @ covariance[:3]
        covariance = 0.5 * (covariance + covariance.T)
        if frame % every == 0:
            sigmas.append(np.sqrt(np.diagonal(covariance)[:3]))
    return np.array(sigmas)
