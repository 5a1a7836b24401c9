"""The second pose that matches in a plane allow: its tilt mirrored about the line of sight.

Seen from afar a plane tilted one way looks like the same plane tilted the other way, and least
squares has a minimum at each (Schweighofer and Pinz 2006). A solver finds the one it starts nearer
to, and the covariance there knows nothing of the other.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.pose import RigidTransform
from models.quantiles import chi_square_quantile
from pipelines.pnp.match import Solution
from pipelines.pnp.predicted_pose import PredictedPose

NEARLY_PLANE = 0.1  # relief over the lesser extent; with more, the mirrored pose never fits
DECISIVE_CHI2 = 13.8  # likelihoods a thousand to one
SAME_CHI2 = chi_square_quantile(0.95, 6)  # poses nearer than this, in sigmas squared, are one


def mirrored_pose(pose: RigidTransform, points_in_target: Floats) -> RigidTransform | None:
    """Return the pose with the points' plane mirrored about the line of sight to their middle.

    Parameters
    ----------
    pose : RigidTransform
        ``cam_from_target``.
    points_in_target : (n, 3) array, m

    Returns
    -------
    RigidTransform or None
        None where the points are not in a plane, nearly.
    """
    middle = points_in_target.mean(axis=0)
    _, extent, axes = np.linalg.svd(points_in_target - middle)
    if extent[2] > NEARLY_PLANE * extent[1]:
        return None
    normal = axes[2]
    ahead = pose @ middle
    sight = ahead / np.linalg.norm(ahead)
    depth_reversed = np.eye(3) - 2.0 * np.outer(sight, sight)
    plane_reversed = np.eye(3) - 2.0 * np.outer(normal, normal)
    rotation = depth_reversed @ pose.rotation @ plane_reversed
    return RigidTransform(rotation, ahead - rotation @ middle)


def squared_distance(solution: Solution, pose: RigidTransform) -> float:
    """Return how far a pose lies from a solution, squared, in the sigmas that it states."""
    stated = PredictedPose(solution.pose, solution.covariance, 0)
    return stated.squared_distance(pose)


def rival_of(solution: Solution, other: Solution) -> float | None:
    """Return how far another solution's attitude lies, deg; None where the two are one.

    They are one where the covariance of each covers the way to the other.
    """
    apart = max(squared_distance(solution, other.pose), squared_distance(other, solution.pose))
    if apart < SAME_CHI2:
        return None
    turn = Rotation.from_matrix(other.pose.rotation @ solution.pose.rotation.T)
    return float(np.rad2deg(turn.magnitude()))


def misfit(residuals_px: Floats, covariance_px2: Floats, outlier_sigmas: float) -> float:
    """Return chi2 over all matches, in which none counts more than an outlier does.

    Parameters
    ----------
    residuals_px : (n, 2) array, px
        A NaN counts as an outlier.
    covariance_px2 : (n, 2, 2) array, px^2
        Of the points.
    outlier_sigmas : float
        From which on a match is one.
    """
    solved = np.linalg.solve(covariance_px2, residuals_px[..., None])[..., 0]
    squares = (residuals_px * solved).sum(axis=1)
    return float(np.minimum(np.nan_to_num(squares, nan=np.inf), outlier_sigmas**2).sum())
