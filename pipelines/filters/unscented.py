"""The unscented transformation: a Gaussian carried through a function by a few chosen points.

References
----------
Julier and Uhlmann, A New Extension of the Kalman Filter to Nonlinear Systems, 1997; scaled: Julier,
The Scaled Unscented Transformation, 2002; weights as by Wan and van der Merwe, 2000.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats

NEGATIVE = 1e-12  # of the largest eigenvalue: what a covariance that lost its sign is raised to


@dataclass(frozen=True)
class SigmaPoints:
    """How points are placed and weighed.

    Attributes
    ----------
    size : int
        Of the state.
    alpha, beta, kappa : float
    """

    size: int
    alpha: float
    beta: float
    kappa: float

    @property
    def reach(self) -> float:
        """The square of how many sigmas the points are away: n + lambda."""
        return self.alpha**2 * (self.size + self.kappa)

    @property
    def mean_weights(self) -> Floats:
        """(2 n + 1,) array, the centre first."""
        weights = np.full(2 * self.size + 1, 0.5 / self.reach)
        weights[0] = 1.0 - self.size / self.reach
        return weights

    @property
    def covariance_weights(self) -> Floats:
        """(2 n + 1,) array, the centre first."""
        weights = self.mean_weights
        weights[0] += 1.0 - self.alpha**2 + self.beta
        return weights

    def around(self, state: Floats, covariance: Floats) -> Floats:
        """Return the points, (2 n + 1, n).

        Parameters
        ----------
        state : (n,) array
        covariance : (n, n) array
            One that has lost its sign to rounding is raised to the nearest that has not.
        """
        root = np.sqrt(self.reach) * square_root(covariance)
        return np.concatenate([state[None], state + root.T, state - root.T])


def square_root(covariance: Floats) -> Floats:
    """Return a square root of a symmetric (n, n) matrix, scaled so that units do not matter."""
    scale = np.sqrt(np.maximum(np.diag(covariance), np.finfo(float).tiny))
    scaled = covariance / np.outer(scale, scale)
    scaled = 0.5 * (scaled + scaled.T)
    try:
        root = np.linalg.cholesky(scaled)
    except np.linalg.LinAlgError:
        values, vectors = np.linalg.eigh(scaled)
        root = vectors * np.sqrt(np.maximum(values, NEGATIVE * values[-1]))
    return np.asarray(scale[:, None] * root)


def weighted_mean(points: Floats, sigma_points: SigmaPoints) -> Floats:
    """Return the (m,) mean of (2 n + 1, m) points, taken about the first to lose no digits."""
    return np.asarray(points[0] + sigma_points.mean_weights @ (points - points[0]))


def cross_covariance(one: Floats, other: Floats, sigma_points: SigmaPoints) -> Floats:
    """Return the covariance of two sets of deviations, (m, k).

    Parameters
    ----------
    one : (2 n + 1, m) array
        Deviations from the mean.
    other : (2 n + 1, k) array
    sigma_points : SigmaPoints
    """
    return np.asarray((one * sigma_points.covariance_weights[:, None]).T @ other)
