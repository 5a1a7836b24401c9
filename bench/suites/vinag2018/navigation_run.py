"""One unit of the suite: runs of a flight as one batch through one filter, and their errors."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from bench.suites.units import Outcome
from bench.suites.vinag2018.cases import Case
from bench.suites.vinag2018.flight import flight_of
from bench.suites.vinag2018.star_images import ImagedStars
from bench.suites.vinag2018.true_motion import ModelledMotion
from models.arrays import Floats
from models.gnss.range_errors import RangeErrors
from models.gnss.receiver_clock import ReceiverClock
from models.gnss.tracking_noise import TrackingLoops
from models.motion.perturbed_orbit import lvlh_axes
from models.quaternions import conjugate, from_rotation_vector, multiplied, to_rotation_vector
from models.sensors.inertial_unit import InertialUnit
from models.sensors.star_camera import star_camera
from models.sensors.star_sensor import StarSensor
from pipelines.absolute.error_state import (
    ACCELERATION,
    ATTITUDE,
    CLOCK,
    GYRO_BIAS,
    POSITION,
    SIZE,
    VELOCITY,
)
from pipelines.absolute.integrity import PROTECTION_SIGMAS
from pipelines.absolute.navigator import AbsoluteNavigator, start_sigmas, started_from
from pipelines.absolute.options import AbsoluteOptions, absolute_options_for
from renders.flight.faults import Faults
from renders.flight.flight import Flight
from renders.flight.sensing import Sensors, TrueInstant, sensed
from renders.flight.true_motion import RealMotion, TrueMotion

ORBIT = (0, 1, 2, 3, 4, 5, 15, 16)
TURN = (9, 10, 11, 12, 13, 14)
WHOLE = tuple(range(17))
START = 0x5A47  # purpose, that sets these draws apart from the sensors'


@dataclass(frozen=True)
class NavigationTask:
    """Some runs of one case by one variant.

    Attributes
    ----------
    case : Case
    variant : str
    options : str
        All settings as text.
    duration_s : float, s
    seed : int
    runs : tuple of int
    modelled : bool
        Whether the truth is drawn from the filter's own model.
    correlated : bool
        Whether the errors of ranges last.
    mask : bool
        False to use what grazes the ionosphere too.
    each_sample : bool
        Whether the filter steps at 100 Hz.
    star_rate_hz : int, Hz
        Of the star sensor.
    faults : Faults
    star_pixels : int
        Of a star camera, a side, whose images are looked at; 0 for the sensor of the data sheet.
    """

    case: Case
    variant: str
    options: str
    duration_s: float
    seed: int
    runs: tuple[int, ...]
    modelled: bool = False
    correlated: bool = False
    mask: bool = True
    each_sample: bool = False
    star_rate_hz: int = 5
    faults: Faults = field(default_factory=Faults)
    star_pixels: int = 0


def navigate(task: NavigationTask) -> Outcome:
    """Fly all runs of a task.

    Returns
    -------
    Outcome
        By record (n) and run: ``time_s`` (n,); ``position_m``, ``velocity_m_s``, errors in inertial
        axes, ``attitude_rad``, in body axes, (n, runs, 3); ``clock``, m and m/s, (n, runs, 2);
        ``sigma``, stated, of all 17, root mean square over the runs, (n, 17); ``nees_orbit`` of
        position, velocity and clock (8), ``nees_attitude`` of attitude and gyro bias (6), and with
        a modelled truth ``nees_whole`` of all 17, (n, runs);
        ``axes`` (n, 3, 3), of run 0's truth, columns radial, along, normal; ``used`` (n,)
        satellites; ``edited`` ones, of them ``edited_liar``, ``named`` liars that are one and
        ``named_healthy`` that are none, and ``beyond``, the largest error of position on an axis
        over its protection level (n, runs). Over all:
        ``doubts`` and ``refused`` star frames (runs,), and ``unseen`` ones, in which a star camera
        found nothing, (1,). Seconds of one core, all in one.
    """
    began = time.process_time()
    options = absolute_options_for(task.variant, task.case.regime, task.correlated)
    if not task.mask:
        options = replace(options, mask_height_m=-np.inf)
    flight = flight_of(task.case, task.duration_s)
    imaged = None
    if task.star_pixels:
        key = (task.seed, *task.runs)
        imaged = ImagedStars(flight, star_camera(task.star_pixels), key)
    sensors = Sensors(
        InertialUnit(),
        StarSensor(rate_hz=task.star_rate_hz),
        TrackingLoops(),
        RangeErrors(ionosphere_m=task.case.ionosphere_m, correlated=task.correlated),
        ReceiverClock(),
        task.faults,
        task.each_sample,
        imaged,
    )
    motion: TrueMotion = RealMotion(flight)
    if task.modelled:
        motion = ModelledMotion(flight, options, len(task.runs), 1.0 / task.star_rate_hz)
    navigator = _started(flight, options, task)
    rows: list[dict[str, Floats]] = []
    for record, truth in sensed(flight, sensors, motion, task.seed, task.runs):
        if record is not None:
            navigator.take(record)
        elif truth is not None and _is_due(truth.time_s, task.case.record_s):
            rows.append(
                _errors(navigator, truth, task.modelled)
                | _diagnostics(navigator, truth, task.faults.liar)
            )
    values = {name: np.stack([row[name] for row in rows]) for name in rows[0]}
    values = {name: each.astype(np.float32) for name, each in values.items()}
    values["doubts"] = navigator.integrity.doubts.astype(np.float32)
    values["refused"] = navigator.integrity.refused_stars.astype(np.float32)
    values["unseen"] = np.array([0.0 if imaged is None else imaged.refused], dtype=np.float32)
    return Outcome(values, np.array([time.process_time() - began]))


def _started(flight: Flight, options: AbsoluteOptions, task: NavigationTask) -> AbsoluteNavigator:
    draws = np.stack(
        [np.random.default_rng([task.seed, run, START]).standard_normal(9) for run in task.runs]
    )
    sigmas = start_sigmas(options)
    first = flight.orbit.states(np.zeros(1))[0]
    turn = from_rotation_vector(sigmas[ATTITUDE] * draws[:, 6:])
    state = started_from(
        options,
        first[:3] + sigmas[POSITION] * draws[:, :3],
        first[3:] + sigmas[VELOCITY] * draws[:, 3:6],
        multiplied(flight.attitude.quaternions(np.zeros(1)), turn),
    )
    return AbsoluteNavigator(options, state, flight.bodies)


def _is_due(time_s: float, every_s: float) -> bool:
    return abs(time_s / every_s - round(time_s / every_s)) * every_s < 1e-6


def _errors(navigator: AbsoluteNavigator, truth: TrueInstant, modelled: bool) -> dict[str, Any]:
    state = navigator.state
    error = np.zeros((len(state.vector), SIZE))
    error[:, : ACCELERATION.stop] = state.vector[:, : ACCELERATION.stop] - truth.motion
    # Attitude: the rotation vector that carries the estimate to the truth, as the filter has it.
    error[:, ATTITUDE] = -to_rotation_vector(
        multiplied(conjugate(state.q_inertial_from_body_wxyz), truth.q_inertial_from_body_wxyz)
    )
    error[:, GYRO_BIAS] = state.vector[:, GYRO_BIAS] - truth.gyro_bias
    error[:, CLOCK] = state.vector[:, CLOCK] - truth.clock
    covariance = state.covariance[:, :SIZE, :SIZE]
    return {
        "time_s": np.array(truth.time_s),
        "position_m": error[:, POSITION],
        "velocity_m_s": error[:, VELOCITY],
        "attitude_rad": error[:, ATTITUDE],
        "clock": error[:, CLOCK],
        "sigma": np.sqrt(np.diagonal(covariance, axis1=1, axis2=2).mean(axis=0)),
        "nees_orbit": _nees(error, covariance, ORBIT),
        "nees_attitude": _nees(error, covariance, TURN),
        "nees_whole": _nees(error, covariance, WHOLE if modelled else ORBIT + TURN),
        "axes": lvlh_axes(truth.motion[0, :3], truth.motion[0, 3:6]),
    }


def _diagnostics(navigator: AbsoluteNavigator, truth: TrueInstant, liar: int) -> dict[str, Any]:
    """Return what the filter says of its satellites and of itself, beside the truth."""
    state, integrity = navigator.state, navigator.integrity
    runs = len(state.vector)
    verdict = integrity.gnss
    fresh = verdict is not None and abs(verdict.time_s - truth.time_s) < 1e-6
    satellites = verdict.satellite if verdict is not None and fresh else np.zeros(0, dtype=np.int64)
    edited = np.zeros((runs, len(satellites)))
    if verdict is not None and fresh and verdict.edited is not None:
        edited += verdict.edited
    named = [integrity.liars(run) for run in range(runs)]
    off_m = np.abs(state.vector[:, POSITION] - truth.motion[:, POSITION])
    level_m = PROTECTION_SIGMAS * np.sqrt(
        np.diagonal(state.covariance[:, POSITION, POSITION], axis1=1, axis2=2)
    )
    return {
        "used": np.array(len(satellites)),
        "edited": edited.sum(axis=1),
        "edited_liar": edited[:, satellites == liar].sum(axis=1),
        "named": np.array([liar in each for each in named]),
        "named_healthy": np.array([len(set(each) - {liar}) for each in named]),
        "beyond": (off_m / level_m).max(axis=1),
    }


def _nees(error: Floats, covariance: Floats, places: tuple[int, ...]) -> Floats:
    own = error[:, places]
    block = covariance[:, places][:, :, places]
    return np.sum(own * np.linalg.solve(block, own[..., None])[..., 0], axis=-1)
