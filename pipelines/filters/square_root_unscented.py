"""The parts of a square-root unscented Kalman filter, for many runs at once.

A covariance P is kept as a factor S, lower triangular, ``P = S S'``. Both steps find the next
factor by one QR decomposition of what spreads about the mean, so that no step can make P
indefinite. The rank-one downdate of the original measurement update, which can, is not needed: the
factor of state and measurement together holds gain and posterior.

References
----------
R. van der Merwe and E. A. Wan, The square-root unscented Kalman filter for state and
parameter-estimation, ICASSP 2001. The update from one factor: I. Arasaratnam and S. Haykin,
Cubature Kalman filters, IEEE Transactions on Automatic Control 54 (2009), appendix B.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models.arrays import Floats


@dataclass(frozen=True)
class UnscentedWeights:
    """How sigma points spread and weigh: of 2 n + 1 points the first is the mean.

    Attributes
    ----------
    size : int
        n, of the error state.
    alpha, beta, kappa : float
        As by van der Merwe and Wan. Small alphas give the central point a weight of minus a million
        and more, and are refused: nothing may weigh less than nothing here.

    Raises
    ------
    ValueError
        If a weight of the covariance is negative, or the points do not spread.
    """

    size: int
    alpha: float = 1.0
    beta: float = 2.0
    kappa: float = 0.0

    def __post_init__(self) -> None:
        if not self.alpha**2 * (self.size + self.kappa) > 0.0:
            raise ValueError(f"expected alpha and n + kappa above zero, got {self}")
        if self.covariance[0] < 0.0:
            raise ValueError(
                "expected alpha, beta and kappa that give no negative weight of the covariance, "
                f"got {self.covariance[0]:.3g} at the centre with alpha {self.alpha}, beta "
                f"{self.beta} and kappa {self.kappa}"
            )

    @property
    def spread(self) -> float:
        """How far the points stand from the mean, in columns of the factor."""
        return float(self.alpha * np.sqrt(self.size + self.kappa))

    @cached_property
    def mean(self) -> Floats:
        """(2 n + 1,) weights of the mean, sum 1."""
        weights = np.full(2 * self.size + 1, 0.5 / self.spread**2)
        weights[0] = 1.0 - self.size / self.spread**2
        return weights

    @cached_property
    def covariance(self) -> Floats:
        """(2 n + 1,) weights of the covariance."""
        weights = self.mean.copy()
        weights[0] += 1.0 - self.alpha**2 + self.beta
        return weights


def lower_factor(columns: Floats) -> Floats:
    """Return S with ``S S' = A A'``, lower triangular, (..., n, n); A as (..., n, m), m >= n."""
    return np.swapaxes(np.linalg.qr(np.swapaxes(columns, -1, -2), mode="r"), -1, -2)


def sigma_deviations(factor: Floats, weights: UnscentedWeights) -> Floats:
    """Return how the sigma points lie about the mean, (..., 2 n + 1, n).

    Parameters
    ----------
    factor : (..., n, n) array
    weights : UnscentedWeights
    """
    steps = weights.spread * np.swapaxes(factor, -1, -2)
    return np.concatenate([np.zeros_like(steps[..., :1, :]), steps, -steps], axis=-2)


def predicted_factor(deviations: Floats, noise_factor: Floats, weights: UnscentedWeights) -> Floats:
    """Return the factor after a step, (..., n, n).

    Parameters
    ----------
    deviations : (..., 2 n + 1, n) array
        Of the points that were carried over the step, from their mean.
    noise_factor : (n, n) array
        Of the process noise.
    weights : UnscentedWeights
    """
    spread = np.swapaxes(deviations * np.sqrt(weights.covariance)[:, None], -1, -2)
    noise = np.broadcast_to(noise_factor, (*spread.shape[:-1], noise_factor.shape[-1]))
    return lower_factor(np.concatenate([spread, noise], axis=-1))


@dataclass(frozen=True, eq=False)
class SquareRootUpdate:
    """What a measurement came to.

    Attributes
    ----------
    correction : (..., n) array
        To be added to the error state.
    factor : (..., n, n) array
        Of the covariance after it.
    nis : (...,) array
        The innovation squared over its covariance.
    """

    correction: Floats
    factor: Floats
    nis: Floats


def measurement_update(
    state_deviations: Floats,
    measured_deviations: Floats,
    noise_factor: Floats,
    innovation: Floats,
    weights: UnscentedWeights,
) -> SquareRootUpdate:
    """Return the update by one measurement.

    Parameters
    ----------
    state_deviations : (..., 2 n + 1, n) array
    measured_deviations : (..., 2 n + 1, m) array
        Of what each point would measure, from the mean of it.
    noise_factor : (..., m, m) array
        Of the measurement's covariance.
    innovation : (..., m) array
        Measured minus mean.
    weights : UnscentedWeights
    """
    size, count = state_deviations.shape[-1], measured_deviations.shape[-1]
    root = np.sqrt(weights.covariance)[:, None]
    above = np.concatenate([np.swapaxes(measured_deviations * root, -1, -2), noise_factor], axis=-1)
    below = np.swapaxes(state_deviations * root, -1, -2)
    padding = np.zeros((*below.shape[:-2], size, count))
    joint = lower_factor(
        np.concatenate([above, np.concatenate([below, padding], axis=-1)], axis=-2)
    )
    whitened = np.linalg.solve(joint[..., :count, :count], innovation[..., None])
    correction = (joint[..., count:, :count] @ whitened)[..., 0]
    return SquareRootUpdate(
        correction, joint[..., count:, count:], np.sum(whitened[..., 0] ** 2, axis=-1)
    )
