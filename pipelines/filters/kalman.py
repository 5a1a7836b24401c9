"""The linear Kalman filter, of which some components are measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats


@dataclass(frozen=True, eq=False)
class LinearUpdate:
    """A state after a measurement.

    Attributes
    ----------
    state : (n,) array
    covariance : (n, n) array
        For an H-infinity filter a bound, not a covariance.
    nis : float
        The innovation squared over its covariance before the measurement: chi2 with as many
        degrees of freedom as numbers measured, if filter and noise agree.
    """

    state: Floats
    covariance: Floats
    nis: float


def normalised_square(vector: Floats, covariance: Floats) -> float:
    """Return ``v' C^-1 v``.

    Parameters
    ----------
    vector : (n,) array
    covariance : (n, n) array
    """
    return float(vector @ np.linalg.solve(covariance, vector))


def predict(
    state: Floats, covariance: Floats, transition: Floats, process_noise: Floats
) -> tuple[Floats, Floats]:
    """Carry a state and its covariance over one step.

    Parameters
    ----------
    state : (n,) array
    covariance : (n, n) array
    transition : (n, n) array
    process_noise : (n, n) array

    Returns
    -------
    state : (n,) array
    covariance : (n, n) array
    """
    carried = transition @ covariance @ transition.T + process_noise
    return transition @ state, 0.5 * (carried + carried.T)


def update(
    state: Floats, covariance: Floats, measured: Floats, observation: Floats, noise: Floats
) -> LinearUpdate:
    """Take in a measurement ``y = H x + v``, v of covariance ``noise``.

    The covariance is Joseph's form, which stays positive however small the noise (Bucy and
    Joseph, Filtering for Stochastic Processes with Applications to Guidance, 1968).

    Parameters
    ----------
    state : (n,) array
    covariance : (n, n) array
    measured : (m,) array
        y.
    observation : (m, n) array
        H.
    noise : (m, m) array
    """
    innovation = measured - observation @ state
    spread = observation @ covariance @ observation.T + noise
    gain = np.linalg.solve(spread, observation @ covariance).T
    keep = np.eye(len(state)) - gain @ observation
    after = keep @ covariance @ keep.T + gain @ noise @ gain.T
    return LinearUpdate(
        state + gain @ innovation,
        0.5 * (after + after.T),
        normalised_square(innovation, spread),
    )
