"""How the state moves between measurements: equations 2 to 10 of VINAG 2018, discretised.

Position and velocity take a Taylor step whose slope of the acceleration is its difference over the
step: at a second a step, the second order alone leaves a millimetre per second between the two. The
quaternion takes the closed solution of equation 4 for a constant rate, whose right-hand side lacks
its q in print; the rest is linear.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from models.arrays import Floats
from models.gravity.disturbances import SUN_MU_M3_S2, third_body
from models.quaternions import from_rotation_vector, multiplied, rotated
from models.sky.moon_ephemeris import MOON_MU_M3_S2
from pipelines.absolute.error_state import (
    ACCELERATION,
    ATTITUDE,
    CLOCK_BIAS,
    CLOCK_DRIFT,
    GYRO_BIAS,
    POSITION,
    SIZE,
    VELOCITY,
)
from pipelines.absolute.options import AbsoluteOptions

ABSORBED_S = 10.0  # within which the acceleration left out takes up the accelerometers' bias


def modelled_gravity(position: Floats, options: AbsoluteOptions) -> Floats:
    """Return equation 6, (..., 3), m/s2.

    Parameters
    ----------
    position : (..., 3) array, m
    options : AbsoluteOptions
    """
    squared = np.sum(position * position, axis=-1, keepdims=True)
    z_share = position[..., 2:] ** 2 / squared
    flat = 1.5 * options.j2 * options.radius_m**2 / squared
    factor = -options.mu_m3_s2 / (squared * np.sqrt(squared))
    across = factor * (1.0 - flat * (5.0 * z_share - 1.0))
    along = factor * (1.0 - flat * (5.0 * z_share - 3.0))
    return np.concatenate([across * position[..., :2], along * position[..., 2:]], axis=-1)


def tides(position: Floats, bodies: tuple[Floats, Floats]) -> Floats:
    """Return what Sun and Moon add, (..., 3), m/s2.

    Parameters
    ----------
    position : (..., 3) array, m
    bodies : (sun, moon)
        Their inertial places, (3,) each, m.
    """
    return third_body(position, bodies[0], SUN_MU_M3_S2) + third_body(
        position, bodies[1], MOON_MU_M3_S2
    )


def carried(
    vector: Floats,
    quaternion: Floats,
    turn_rad: Floats,
    duration_s: float,
    options: AbsoluteOptions,
    tide: Floats | None = None,
    specific_force: Floats | None = None,
) -> tuple[Floats, Floats]:
    """Return states and attitudes after a step without noise.

    Parameters
    ----------
    vector : (..., n) array
        The 17 states, and those of the channels.
    quaternion : (..., 4) array
        ``q_inertial_from_body``.
    turn_rad : (..., 3) array, rad
        By the gyroscopes, over the step.
    duration_s : float, s
    options : AbsoluteOptions
    tide : (..., 3) array or None, m/s2
        By Sun and Moon; over a spread of kilometres it is the same to 1e-9 m/s2.
    specific_force : (..., 3) array or None, m/s2
        By the accelerometers, body axes.

    Returns
    -------
    vector : (..., n) array
    quaternion : (..., 4) array
    """
    moved = vector.copy()
    turn = turn_rad - duration_s * vector[..., GYRO_BIAS]
    turned = multiplied(quaternion, from_rotation_vector(turn))
    push = vector[..., ACCELERATION]
    if tide is not None:
        push = push + tide
    if specific_force is not None:
        push = push + rotated(quaternion, specific_force)
    start = modelled_gravity(vector[..., POSITION], options) + push
    moved[..., POSITION] += duration_s * (vector[..., VELOCITY] + 0.5 * duration_s * start)
    end = modelled_gravity(moved[..., POSITION], options) + push
    moved[..., POSITION] += duration_s**2 / 6.0 * (end - start)
    moved[..., VELOCITY] += 0.5 * duration_s * (start + end)
    if options.left_out_fades:
        moved[..., ACCELERATION] *= np.exp(-duration_s / options.left_out_s)
    moved[..., CLOCK_BIAS] += duration_s * vector[..., CLOCK_DRIFT]
    if options.slots:
        moved[..., SIZE:] *= np.exp(-duration_s / options.lasting_s)
    return moved, turned


@lru_cache(maxsize=64)
def process_noise_factor(
    options: AbsoluteOptions, duration_s: float, manoeuvring: bool = False
) -> Floats:
    """Return the factor of the process noise of a step, (n, n).

    Parameters
    ----------
    options : AbsoluteOptions
    duration_s : float, s
    manoeuvring : bool
        Whether the accelerometers, whose bias is neglected, are in it: what is left out then has
        to take it up.
    """
    t = duration_s
    noise = np.zeros((SIZE + options.slots, SIZE + options.slots))
    fresh = options.lasting_m**2 * -np.expm1(-2.0 * t / options.lasting_s)
    noise[SIZE:, SIZE:] = fresh * np.eye(options.slots)
    density = options.left_out_density
    if manoeuvring:
        density += 2.0 * options.accelerometer_bias_m_s2**2 / ABSORBED_S
    jerk = density * np.array(
        [
            [t**5 / 20.0, t**4 / 8.0, t**3 / 6.0],
            [t**4 / 8.0, t**3 / 3.0, t**2 / 2.0],
            [t**3 / 6.0, t**2 / 2.0, t],
        ]
    )
    angle, bias = options.gyro_densities
    turning = np.array(
        [[angle * t + bias * t**3 / 3.0, -bias * t**2 / 2.0], [-bias * t**2 / 2.0, bias * t]]
    )
    for axis in range(3):
        orbit = [each.start + axis for each in (POSITION, VELOCITY, ACCELERATION)]
        noise[np.ix_(orbit, orbit)] = jerk
        attitude = [ATTITUDE.start + axis, GYRO_BIAS.start + axis]
        noise[np.ix_(attitude, attitude)] = turning
    phase, frequency = options.clock_densities
    clock = [CLOCK_BIAS, CLOCK_DRIFT]
    noise[np.ix_(clock, clock)] = [
        [phase * t + frequency * t**3 / 3.0, frequency * t**2 / 2.0],
        [frequency * t**2 / 2.0, frequency * t],
    ]
    scale = np.sqrt(np.diag(noise))  # from 1e-11 to 1: scaled, or the factor would lose digits
    factor = scale[:, None] * np.linalg.cholesky(noise / np.outer(scale, scale))
    factor.setflags(write=False)
    return factor
