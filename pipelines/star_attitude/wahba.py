"""Wahba's problem: the attitude that best turns known directions into those seen.

References
----------
G. Wahba, A least squares estimate of satellite attitude, SIAM Review 7 (1965); F. L. Markley,
Attitude determination using vector observations and the singular value decomposition, Journal of
the Astronautical Sciences 36 (1988), with the covariance of its section on errors.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats


def wahba_attitude(seen: Floats, known: Floats, weights: Floats) -> Floats:
    """Return the rotation matrix, (3, 3), with ``seen = R known`` in the least squares.

    Parameters
    ----------
    seen, known : (n, 3) arrays
        Unit vectors, two or more that are not parallel.
    weights : (n,) array
        Inverse squares of the angular errors.
    """
    profile = (seen * weights[:, None]).T @ known
    left, _, right = np.linalg.svd(profile)
    sign = np.array([1.0, 1.0, np.linalg.det(left) * np.linalg.det(right)])
    return (left * sign) @ right


def wahba_covariance(seen: Floats, variances_rad2: Floats) -> Floats:
    """Return the covariance of the attitude's error, (3, 3), rad2, on the axes of ``seen``.

    Parameters
    ----------
    seen : (n, 3) array
        Unit vectors.
    variances_rad2 : (n,) array, rad2
        Of their errors, along each of two axes across.
    """
    weights = 1.0 / variances_rad2
    told = np.sum(weights) * np.eye(3) - (seen * weights[:, None]).T @ seen
    return np.asarray(np.linalg.inv(told), dtype=np.float64)
