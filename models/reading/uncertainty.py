"""Matrices as read: a rotation or a covariance, or not one; what is accepted is made exact."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats
from models.pose import ORTHONORMAL_TOLERANCE

ROUNDING = 1e-12  # a rotation as our arithmetic leaves it: kept to the last bit
SYMMETRY = 1e-6  # of a correlation: a covariance typed with seven digits passes
NEGATIVE = 1e-6  # least eigenvalue of the correlations, from the same digits


def exact_rotation(matrix: Floats) -> Floats:
    """Return the rotation nearest to a (3, 3) matrix that is one to six digits.

    Raises
    ------
    ValueError
        If it is none; the message says by how much.
    """
    if matrix.shape != (3, 3):
        raise ValueError(f"one of shape {matrix.shape}")
    defect = float(np.abs(matrix @ matrix.T - np.eye(3)).max())
    determinant = float(np.linalg.det(matrix)) if np.isfinite(defect) else np.nan
    if not (defect <= ORTHONORMAL_TOLERANCE and determinant > 0.0):
        raise ValueError(f"one with |R R^T - I| = {defect:.2g} and determinant {determinant:.3g}")
    if defect <= ROUNDING:
        return matrix
    left, _, right = np.linalg.svd(matrix)
    return np.asarray(left @ right)


def exact_covariance(matrix: Floats) -> Floats:
    """Return an (n, n) covariance exactly symmetric; zero variances are allowed.

    It is judged by its correlations, for its rows may have other units.

    Raises
    ------
    ValueError
        If it is not square or not symmetric, a value is not finite, a variance of any combination
        is below zero, or what has no variance is correlated.
    """
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
        raise ValueError(f"one of shape {matrix.shape}, which is not square")
    if not np.isfinite(matrix).all():
        raise ValueError("one that is not finite")
    variances = np.diag(matrix)
    if (variances < 0.0).any():
        raise ValueError(f"one with a variance of {variances.min():.3g}")
    sigma = np.sqrt(variances)
    if np.abs(matrix[sigma == 0.0]).any() or np.abs(matrix[:, sigma == 0.0]).any():
        raise ValueError("one that correlates what has no variance")
    scale = np.where(sigma > 0.0, sigma, 1.0)
    with np.errstate(over="ignore", invalid="ignore"):
        correlations = matrix / scale[:, None] / scale
        skew = float(np.abs(correlations - correlations.T).max(initial=0.0))
    if not skew <= SYMMETRY:
        raise ValueError(f"one that is not symmetric: correlations differ by {skew:.2g}")
    symmetric = 0.5 * (matrix + matrix.T)
    least = float(np.linalg.eigvalsh(0.5 * (correlations + correlations.T)).min(initial=0.0))
    if least < -NEGATIVE:
        raise ValueError(f"one whose least eigenvalue, of its correlations, is {least:.3g}")
    return np.asarray(symmetric)
