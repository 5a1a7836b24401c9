"""Whether matches agree with one pose: outliers, and errors that no covariance foresaw."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from scipy.optimize import brentq

from models.arrays import Floats
from models.pose import RigidTransform
from models.quantiles import chi_square_quantile, f_quantile
from pipelines.pnp.levenberg_marquardt import solve_pose
from pipelines.pnp.problem import PnpProblem
from pipelines.pnp.solver_options import LevenbergMarquardtOptions

LEAST_FREEDOM = 0.02  # share of a residual that the solver has not fitted away
CALM = 0.9999  # quantile of chi-square up to which residuals are as foreseen
FALSE_ALARM = 1e-5  # of the test for one outlier among residuals larger than foreseen
SUSPECTS = 4  # sets of matches that are left out in earnest, the most promising ones
LARGEST_COMMON_PX = 100.0


def deletion_gains(
    problem: PnpProblem, pose: RigidTransform, together: int
) -> dict[tuple[int, ...], float]:
    """Return by how much chi2 would fall without some of the matches.

    A solver pulls itself towards a wrong match and hides its error among the others; leaving
    matches out, to first order ``r^T (I - J (J^T J)^-1 J^T)^-1 r`` over their residuals, undoes
    that (Cook and Weisberg 1982). Where observations share errors, what is left out is the
    directions that an error of these matches alone would take among the whitened residuals.

    Parameters
    ----------
    problem : PnpProblem
    pose : RigidTransform
        The solution of all matches.
    together : int
        How many to leave out at a time.
    """
    residuals = problem.residuals(pose.rotation, pose.translation).reshape(-1)
    basis, _ = np.linalg.qr(problem.jacobian(pose.rotation, pose.translation))
    errors = problem.decorrelating
    gains = {}
    for chosen in combinations(range(len(problem)), together):
        rows = [2 * index + axis for index in chosen for axis in (0, 1)]
        ways, _ = np.linalg.qr(errors[:, rows])
        fitted = basis.T @ ways
        values, vectors = np.linalg.eigh(np.eye(len(rows)) - fitted.T @ fitted)
        turned = vectors.T @ (ways.T @ residuals)
        gains[chosen] = float(np.sum(turned**2 / np.maximum(values, LEAST_FREEDOM)))
    return gains


def find_outliers(
    problem: PnpProblem,
    pose: RigidTransform,
    outlier_sigmas: float,
    solver: LevenbergMarquardtOptions,
) -> tuple[int, ...]:
    """Return the one or two matches that do not agree with all others; none if they do agree.

    What is left without them sets the scale: where all residuals are larger than foreseen
    (markers not where they were surveyed), none of them is an outlier for that.

    Parameters
    ----------
    problem : PnpProblem
        Weighted.
    pose : RigidTransform
        Its solution, ``cam_from_target``.
    outlier_sigmas : float
        Where the errors are as foreseen, how far off a match may be.
    solver : LevenbergMarquardtOptions
        With which a problem is solved again without the suspects.

    Returns
    -------
    tuple of int
        Numbers of matches in the problem.
    """
    total = float(np.sum(problem.residuals(pose.rotation, pose.translation) ** 2))
    for together in (1, 2):
        freedom = 2 * (len(problem) - together) - 6
        if freedom < 1 or total <= chi_square_quantile(CALM, freedom + 2 * together):
            return ()
        gains = deletion_gains(problem, pose, together)
        suspects = sorted(gains, key=lambda chosen: -gains[chosen])[:SUSPECTS]
        left = {chosen: _chi2_without(problem, pose, chosen, solver) for chosen in suspects}
        worst = min(left, key=lambda chosen: left[chosen])
        if left[worst] <= chi_square_quantile(CALM, freedom):
            limit = outlier_sigmas**2
        else:
            ratio = f_quantile(1.0 - FALSE_ALARM, 2 * together, freedom)
            limit = left[worst] / freedom * 2.0 * together * ratio
        if total - left[worst] > limit:
            return worst
    return ()


def _chi2_without(
    problem: PnpProblem,
    pose: RigidTransform,
    chosen: tuple[int, ...],
    solver: LevenbergMarquardtOptions,
) -> float:
    keep = ~np.isin(np.arange(len(problem)), chosen)
    return solve_pose(problem.subset(keep), pose, solver).chi2


def common_variance_px2(
    residuals_px: Floats, covariance_px2: Floats, common_px: Floats | None = None
) -> float:
    """Return the variance which, added to every axis of every point, explains the residuals, px^2.

    Zero where they are explained already. This is the moment estimate of a random effect
    (DerSimonian and Laird 1986): marker survey errors, a distortion left over.

    Parameters
    ----------
    residuals_px : (n, 2) array, px
    covariance_px2 : (n, 2, 2) array, px^2
    common_px : (n, 2, k) array, px, optional
        What k errors that all points share, 1 sigma of each, do to them.
    """
    freedom = 2 * len(residuals_px) - 6
    if freedom < 1:
        return 0.0

    def excess(sigma_px: float) -> float:
        wider = covariance_px2 + sigma_px**2 * np.eye(2)
        solved = np.linalg.solve(wider, residuals_px[..., None])[..., 0]
        alone = float((residuals_px * solved).sum()) - freedom
        if common_px is None:
            return alone
        # Woodbury's identity: the shared errors explain their part of it.
        weighed = np.linalg.solve(wider, common_px)
        pull = np.einsum("nik,ni->k", common_px, solved)
        shared = np.eye(common_px.shape[2]) + np.einsum("nik,nil->kl", common_px, weighed)
        return alone - float(pull @ np.linalg.solve(shared, pull))

    if (
        excess(0.0) + freedom <= chi_square_quantile(CALM, freedom)
        or excess(LARGEST_COMMON_PX) > 0.0
    ):
        return 0.0
    return float(brentq(excess, 0.0, LARGEST_COMMON_PX, xtol=1e-6)) ** 2
