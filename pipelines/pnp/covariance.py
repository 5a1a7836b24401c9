"""The covariance of a pose: the Cramer-Rao bound of its matches.

(6, 6), rad and m, rotation first, camera axes: the convention of ``RigidTransform.perturbed``.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats
from models.pose import RigidTransform
from pipelines.pnp.problem import PnpProblem

SINGULAR = 1e-14  # reciprocal condition below which a pose is not determined


def pose_covariance(problem: PnpProblem, pose: RigidTransform) -> Floats | None:
    """Return ``(J^T W J)^-1`` at a pose, or None where the matches do not determine it.

    For a weighted problem with the right weights this is the Cramer-Rao bound. For an unweighted
    one, multiply by the variance of the observations.

    Returns
    -------
    (6, 6) array, rad and m, or None
    """
    jacobian = problem.jacobian(pose.rotation, pose.translation)
    scale = np.linalg.norm(jacobian, axis=0)
    if not (np.isfinite(scale).all() and scale.min() > 0.0):
        return None
    balanced = jacobian / scale
    information = balanced.T @ balanced
    eigenvalues = np.linalg.eigvalsh(information)
    if eigenvalues[0] < SINGULAR * eigenvalues[-1]:
        return None
    covariance = np.linalg.inv(information) / np.outer(scale, scale)
    return np.asarray(0.5 * (covariance + covariance.T))


def pose_scatter(problem: PnpProblem, pose: RigidTransform, covariance: Floats) -> Floats:
    """Return the part of a pose's covariance that errors common to its points have none in.

    Parameters
    ----------
    problem : PnpProblem
        Weighted.
    pose : RigidTransform
    covariance : (6, 6) array, rad and m
        See ``pose_covariance``.

    Returns
    -------
    (6, 6) array, rad and m
    """
    if problem.common is None:
        return covariance
    pull = covariance @ problem.jacobian(pose.rotation, pose.translation).T @ problem.decorrelating
    return np.asarray(pull @ pull.T)


def residual_variance(problem: PnpProblem, pose: RigidTransform) -> float | None:
    """Return the variance of an observation from its residuals; None with nothing to spare."""
    freedom = 2 * len(problem) - 6
    if freedom < 1:
        return None
    residuals = problem.residuals(pose.rotation, pose.translation)
    return float(np.sum(residuals**2)) / freedom
