"""The H-infinity filter: the estimate whose worst case is least, for noise of any kind.

It exists only while theta is small enough. Against Gaussian noise of the covariance it was told,
nothing beats ``theta = 0``, which is Kalman's filter: robustness costs accuracy there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from pipelines.filters.kalman import LinearUpdate, normalised_square


@dataclass(frozen=True)
class NoHInfinity:
    """The filter does not exist at this step: theta is too large. Falsy.

    Attributes
    ----------
    theta : float
        As asked for.
    limit : float
        Below which it would exist.
    """

    theta: float
    limit: float

    @property
    def reason(self) -> str:
        """The same in words."""
        return f"theta {self.theta:.3g} is not below the {self.limit:.3g} where H-infinity ends"

    def __bool__(self) -> bool:
        return False


def theta_of_share(share: float, position_noise: Floats) -> float:
    """Return theta for unit weights, as a share of the least information of one position, 1/m2.

    With theta at all of it, a position far in the past would weigh no more than none.

    Parameters
    ----------
    share : float
        In [0, 1).
    position_noise : (3, 3) array, m2
        Covariance of a measured position.
    """
    return share / float(np.linalg.eigvalsh(position_noise)[-1])


def theta_limit(information: Floats, weights: Floats) -> float:
    """Return the theta at which ``information - theta weights`` stops being positive definite.

    Parameters
    ----------
    information : (n, n) array
        Positive definite.
    weights : (n, n) array
        Symmetric.
    """
    root = np.linalg.cholesky(information)
    whitened = np.linalg.solve(root, np.linalg.solve(root, weights).T)
    largest = float(np.linalg.eigvalsh(0.5 * (whitened + whitened.T))[-1])
    return 1.0 / largest if largest > 0.0 else np.inf


def update(
    state: Floats,
    covariance: Floats,
    measured: Floats,
    observation: Floats,
    noise: Floats,
    *,
    theta: float,
    weights: Floats,
) -> LinearUpdate | NoHInfinity:
    """Take in a measurement ``y = H x + v``; ``kalman.predict`` carries the result on.

    Together these are the predictor form: its gain is
    ``K = P (I - theta S P + H' R^-1 H P)^-1 H' R^-1``, its next covariance
    ``F P (...)^-1 F' + Q``. What is given back is the estimate after the measurement,
    ``x + K (y - H x)``, that the paper's Table 1 hides in its next prediction.

    Parameters
    ----------
    state, covariance : (n,) and (n, n) arrays
        Predicted.
    measured, observation, noise : (m,), (m, n) and (m, m) arrays
        y, H and R.
    theta : float
        The worst case is below 1 / theta: the weighted sum of squared errors over those of the
        start, the process and the measurements. The paper's norm is its square root.
    weights : (n, n) array
        S of the errors; the paper takes the identity, in m and m/s, without saying so.

    Returns
    -------
    LinearUpdate or NoHInfinity

    References
    ----------
    Simon, Optimal State Estimation, 2006, section 11.3; Pesce et al. 2019, equations 6 to 8.
    """
    weighed = np.linalg.solve(noise, observation).T
    information = np.linalg.inv(covariance) + weighed @ observation
    information = 0.5 * (information + information.T)
    limit = theta_limit(information, weights)
    if not theta < limit:
        return NoHInfinity(theta, limit)
    after = np.linalg.inv(information - theta * weights)
    after = 0.5 * (after + after.T)
    innovation = measured - observation @ state
    spread = observation @ covariance @ observation.T + noise
    return LinearUpdate(
        state + after @ (weighed @ innovation), after, normalised_square(innovation, spread)
    )
