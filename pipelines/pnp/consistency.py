"""Whether matches agree with one pose: outliers, and errors that no covariance foresaw."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq
from scipy.stats import chi2

from models.arrays import Floats
from models.pose import RigidTransform
from pipelines.pnp.problem import PnpProblem

MEDIAN_CHI2 = 2.0 * np.log(2.0)  # of two degrees of freedom
LEAST_FREEDOM = 0.1  # share of a residual that the solver has not fitted away
SUSPICIOUS = 0.999  # quantile of chi-square beyond which a common error is assumed
LARGEST_COMMON_PX = 100.0


def studentised_chi2(problem: PnpProblem, pose: RigidTransform) -> Floats:
    """Return each match's squared residual over its own expected covariance, (n,).

    A solver pulls itself towards a point with leverage and hides its error; dividing by
    ``I - J (J^T J)^-1 J^T`` undoes that. Correct matches follow chi-square with two degrees of
    freedom.
    """
    residuals = problem.residuals(pose.rotation, pose.translation)
    jacobian = problem.jacobian(pose.rotation, pose.translation)
    basis, _ = np.linalg.qr(jacobian)
    blocks = basis.reshape(-1, 2, basis.shape[1])
    left = np.eye(2) - blocks @ blocks.transpose(0, 2, 1)
    values, vectors = np.linalg.eigh(left)
    turned = np.einsum("nji,nj->ni", vectors, residuals)
    return np.asarray((turned**2 / np.maximum(values, LEAST_FREEDOM)).sum(axis=1))


def worst_outlier(problem: PnpProblem, pose: RigidTransform, outlier_sigmas: float) -> int | None:
    """Return the match that agrees least, if it does not agree; else None.

    The scale is the matches' own: where all residuals are larger than foreseen (markers not where
    they were surveyed), none of them is an outlier for that.
    """
    distances = studentised_chi2(problem, pose)
    scale = max(1.0, float(np.median(distances)) / MEDIAN_CHI2)
    worst = int(np.argmax(distances))
    return worst if distances[worst] > outlier_sigmas**2 * scale else None


def common_variance_px2(residuals_px: Floats, covariance_px2: Floats) -> float:
    """Return the variance which, added to every axis of every point, explains the residuals, px^2.

    Zero where they are explained already. This is the moment estimate of a random effect
    (DerSimonian and Laird 1986): marker survey errors, a distortion left over.

    Parameters
    ----------
    residuals_px : (n, 2) array, px
    covariance_px2 : (n, 2, 2) array, px^2
    """
    freedom = 2 * len(residuals_px) - 6
    if freedom < 1:
        return 0.0

    def excess(sigma_px: float) -> float:
        wider = covariance_px2 + sigma_px**2 * np.eye(2)
        solved = np.linalg.solve(wider, residuals_px[..., None])[..., 0]
        return float((residuals_px * solved).sum()) - freedom

    if excess(0.0) + freedom <= chi2.ppf(SUSPICIOUS, freedom) or excess(LARGEST_COMMON_PX) > 0.0:
        return 0.0
    return float(brentq(excess, 0.0, LARGEST_COMMON_PX, xtol=1e-6)) ** 2
