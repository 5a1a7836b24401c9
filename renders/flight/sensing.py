"""What the sensors of a flight give, record after record, in as many runs as there are.

All draws are keyed by (seed, run, sensor, block of time): a run is the same in any company.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from models.arrays import Floats
from models.gnss.range_errors import LastingErrors, RangeErrors
from models.gnss.receiver_clock import ReceiverClock
from models.gnss.signal_path import ionospheric_delay_m
from models.gnss.tracking_noise import TrackingLoops
from models.navigation_records import (
    GnssEpoch,
    InertialInterval,
    NavigationRecord,
    StarAttitude,
    coned_turn,
)
from models.sensors.inertial_unit import DEG_H, InertialUnit
from models.sensors.star_sensor import StarSensor
from renders.flight.faults import Faults
from renders.flight.flight import Flight
from renders.flight.true_motion import TrueMotion

BLOCK_S = 100.0
GRAZING_M = 1_000_000.0  # what passes below it on its way to a high orbit meets the ionosphere
CLOCK, BIAS, STARS, GYRO, RANGES, MOTION, LASTING, TURN_ON = range(8)


class StarImager(Protocol):
    """A star sensor that takes images and finds an attitude in them, for one run."""

    def attitude(
        self, time_s: float, q_inertial_from_body_wxyz: Floats, measured_rate: Floats
    ) -> StarAttitude | None:
        """Return what it makes of one frame; None if it refuses it.

        Parameters
        ----------
        time_s : float, s
        q_inertial_from_body_wxyz : (4,) array
            True.
        measured_rate : (3,) array, rad/s
            By the gyroscopes, body axes.
        """
        ...


@dataclass(frozen=True)
class Sensors:
    """The sensors of a flight.

    Attributes
    ----------
    unit : InertialUnit
    stars : StarSensor
    loops : TrackingLoops
    errors : RangeErrors
    clock : ReceiverClock
    faults : Faults
    each_sample : bool
        Whether every sample of the gyroscopes is a record, or their sum between star frames.
    images : StarImager or None
        The star sensor as a camera, in place of ``stars``, whose rate stays; for one run at a time.
    """

    unit: InertialUnit
    stars: StarSensor
    loops: TrackingLoops
    errors: RangeErrors
    clock: ReceiverClock
    faults: Faults
    each_sample: bool = False
    images: StarImager | None = None


@dataclass(frozen=True, eq=False)
class TrueInstant:
    """What was so when a record was taken.

    Attributes
    ----------
    time_s : float, s
    motion : (runs or 1, 9) array
        Position, velocity, acceleration that the model leaves out.
    q_inertial_from_body_wxyz : (4,) array
    gyro_bias : (runs, 3) array, rad/s
    clock : (runs, 2) array, m and m/s
    """

    time_s: float
    motion: Floats
    q_inertial_from_body_wxyz: Floats
    gyro_bias: Floats
    clock: Floats


def sensed(
    flight: Flight, sensors: Sensors, motion: TrueMotion, seed: int, runs: tuple[int, ...]
) -> Iterator[tuple[NavigationRecord | None, TrueInstant | None]]:
    """Yield records in the order of their times; after those of a whole second, the truth.

    Parameters
    ----------
    flight : Flight
    sensors : Sensors
    motion : TrueMotion
    seed : int
    runs : tuple of int
        Their numbers.

    Yields
    ------
    (record, None) or (None, truth)

    Raises
    ------
    ValueError
        If there are star images and more than one run.
    """
    if sensors.images is not None and len(runs) != 1:
        raise ValueError(f"expected one run with star images, got {len(runs)}")
    per_second = round(sensors.stars.rate_hz)
    frame_s = 1.0 / per_second
    per_block = round(BLOCK_S / frame_s)
    per_frame = round(frame_s / sensors.unit.sample_s)
    satellites = len(flight.constellation)
    lasting = LastingErrors(sensors.errors)
    clock = sensors.clock.at_start(len(runs))
    left, fresh = sensors.unit.bias_steps(frame_s)
    turn_on = _draws(seed, runs, TURN_ON, 0, (2, 3))
    constant = sensors.unit.gyro_turn_on_deg_h * DEG_H * turn_on[:, 0]
    wandering = sensors.unit.gyro_bias_deg_h * DEG_H * turn_on[:, 1]
    for block in range(int(np.ceil(flight.duration_s / BLOCK_S))):
        first_s = block * BLOCK_S
        times_s = first_s + frame_s * np.arange(1.0, per_block + 1.0)
        whole_s = times_s[per_second - 1 :: per_second]
        if block == 0:
            motion.block(np.zeros(1), _draws(seed, runs, MOTION, -1, (1, 9)))
        states = motion.block(times_s, _draws(seed, runs, MOTION, block, (per_block, 9)))
        turns = flight.attitude.quaternions(times_s)
        samples = np.arange(per_block * per_frame, dtype=np.float64)
        samples_s = np.asarray(first_s + sensors.unit.sample_s * (samples + 0.5))
        rates = flight.attitude.rates(samples_s).reshape(per_block, per_frame, 3)
        gyro = _draws(seed, runs, GYRO, block, (per_block, per_frame, 3))
        stars = _draws(seed, runs, STARS, block, (per_block, 3))
        bias_draws = _draws(seed, runs, BIAS, block, (per_block, 3))
        clock_draws = _draws(seed, runs, CLOCK, block, (per_block, 2))
        ranges = _draws(seed, runs, RANGES, block, (len(whole_s), 3, satellites))
        lasts = _draws(seed, runs, LASTING, block, (len(whole_s), 2, satellites))
        received = flight.reception(whole_s)
        senders = flight.constellation.states(whole_s)
        for frame, now_s in enumerate(times_s.tolist()):
            if now_s > flight.duration_s + 1e-6:
                return
            bias = constant + wandering
            measured = sensors.unit.turns(rates[frame], bias[:, None, :], gyro[:, frame])
            yield from _inertial(sensors, measured, now_s, frame_s)
            wandering = left * wandering + fresh * bias_draws[:, frame]
            clock = sensors.clock.after(clock, frame_s, clock_draws[:, frame])
            star = _star_attitude(sensors, now_s, turns[frame], stars[:, frame], measured, frame_s)
            if star is not None:
                yield sensors.faults.of_stars(star, frame_s), None
            if (frame + 1) % per_second:
                continue
            second = (frame + 1) // per_second - 1
            off_m = lasting.after(1.0, lasts[:, second].swapaxes(0, 1))
            epoch = _epoch(
                sensors,
                now_s,
                np.flatnonzero(received.tracked[second]),
                received.cn0_dbhz[second],
                senders[second],
                states[:, frame],
                clock,
                ranges[:, second],
                off_m,
            )
            told = sensors.faults.of_epoch(epoch)
            if told is not None:
                yield told, None
            yield None, TrueInstant(now_s, states[:, frame], turns[frame], bias, clock)


def _star_attitude(
    sensors: Sensors,
    now_s: float,
    q_inertial_from_body_wxyz: Floats,
    draws: Floats,
    measured: Floats,
    frame_s: float,
) -> StarAttitude | None:
    """Return what the star sensor says, by its data sheet or by an image; None if it refuses."""
    if sensors.images is None:
        seen = sensors.stars.measured(q_inertial_from_body_wxyz, draws)
        return StarAttitude(now_s, seen, sensors.stars.covariance_rad2)
    rate = measured[0].sum(axis=0) / frame_s
    return sensors.images.attitude(now_s, q_inertial_from_body_wxyz, rate)


def _inertial(
    sensors: Sensors, measured: Floats, now_s: float, frame_s: float
) -> Iterator[tuple[InertialInterval, None]]:
    """Yield each sample of a frame, (runs, n, 3), or their sum."""
    if not sensors.each_sample:
        yield InertialInterval(now_s, frame_s, coned_turn(measured)), None
        return
    count, sample_s = measured.shape[1], sensors.unit.sample_s
    for place in range(count):
        end_s = now_s - (count - 1 - place) * sample_s
        yield InertialInterval(end_s, sample_s, measured[:, place]), None


def _epoch(
    sensors: Sensors,
    now_s: float,
    tracked: np.ndarray,
    cn0_dbhz: Floats,
    senders: Floats,
    state: Floats,
    clock: Floats,
    draws: Floats,
    off_m: Floats,
) -> GnssEpoch:
    own = senders[tracked]
    away = state[:, None, :3] - own[:, :3]
    distance = np.sqrt(np.sum(away**2, axis=-1))
    rate = np.sum(away * (state[:, None, 3:6] - own[:, 3:]), axis=-1) / distance
    cn0 = cn0_dbhz[tracked]
    noise_m = sensors.loops.code_sigma_m(cn0) * draws[:, 0, tracked]
    noise_m += sensors.errors.white_m * draws[:, 1, tracked] + off_m[:, tracked]
    if np.linalg.norm(state[0, :3]) > 2e7:
        noise_m += ionospheric_delay_m(np.broadcast_to(state[0, :3], (len(own), 3)), own[:, :3])
    noise_m_s = sensors.loops.rate_sigma_m_s(cn0) * draws[:, 2, tracked]
    return GnssEpoch(
        now_s,
        tracked,
        own[:, :3],
        own[:, 3:],
        cn0,
        distance + clock[:, :1] + noise_m,
        rate + clock[:, 1:] + noise_m_s,
    )


def _draws(
    seed: int, runs: tuple[int, ...], sensor: int, block: int, shape: tuple[int, ...]
) -> Floats:
    """Return standard normal numbers, (runs, *shape)."""
    return np.stack(
        [
            np.random.default_rng([seed, run, sensor, block + 1]).standard_normal(shape)
            for run in runs
        ]
    )
