"""A pose from a match: solve, reject what disagrees, say how good it is, or why there is none."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Mask
from models.camera import Camera
from models.markers import MarkerPattern
from models.pose import RigidTransform
from pipelines.pnp.consistency import common_variance_px2, find_outliers
from pipelines.pnp.covariance import pose_covariance, residual_variance
from pipelines.pnp.levenberg_marquardt import solve_pose
from pipelines.pnp.match import Match, Solution
from pipelines.pnp.problem import PnpProblem
from pipelines.pnp.solver_options import MatchOptions

REWEIGHTINGS = 2


def residuals_px(
    camera: Camera, markers: MarkerPattern, match: Match, pose: RigidTransform
) -> Floats:
    """Return detected minus reprojected, (n, 2) px."""
    return match.points_px - camera.project(pose @ markers.points_in_target[match.marker])


def _problem(
    camera: Camera, markers: MarkerPattern, match: Match, options: MatchOptions
) -> PnpProblem:
    points = markers.points_in_target[match.marker]
    if options.solver.parametrisation == "euler_321":
        return PnpProblem.unweighted(camera, points, match.points_px)
    return PnpProblem.weighted(camera, points, match.points_px, match.covariance_px2)


def solve_match(
    camera: Camera,
    markers: MarkerPattern,
    match: Match,
    start: RigidTransform,
    radius_px: float,
    options: MatchOptions,
) -> Solution | str:
    """Solve for the pose.

    Parameters
    ----------
    camera : Camera
    markers : MarkerPattern
    match : Match
    start : RigidTransform
        Guess of ``cam_from_target``.
    radius_px : float, px
        Expected radius of a marker's image.
    options : MatchOptions

    Returns
    -------
    Solution or str
        In words, why there is none.
    """
    if len(match) < options.min_markers:
        return (
            f"{len(match)} of the {len(markers)} markers matched, "
            f"at least {options.min_markers} are needed"
        )
    used = np.ones(len(match), dtype=np.bool_)
    problem = _problem(camera, markers, match, options)
    pose = solve_pose(problem, start, options.solver).pose
    while options.verify:
        outliers = find_outliers(problem.subset(used), pose, options.outlier_sigmas, options.solver)
        if not outliers:
            break
        if used.sum() - len(outliers) < options.min_markers:
            return f"the {len(match)} matched markers do not agree with one pose"
        used[np.flatnonzero(used)[list(outliers)]] = False
        pose = solve_pose(problem.subset(used), pose, options.solver).pose
    if options.verify:
        match, pose = _reweighted(camera, markers, match, used, pose, options)
        problem = _problem(camera, markers, match, options)
    return _checked(camera, markers, match, used, problem.subset(used), pose, radius_px, options)


def _reweighted(
    camera: Camera,
    markers: MarkerPattern,
    match: Match,
    used: Mask,
    pose: RigidTransform,
    options: MatchOptions,
) -> tuple[Match, RigidTransform]:
    """Widen the covariances where the residuals ask for it, and solve again."""
    wider = match
    for _ in range(REWEIGHTINGS):
        left = residuals_px(camera, markers, match, pose)[used]
        variance = common_variance_px2(left, match.covariance_px2[used])
        if variance == 0.0:
            return match, pose
        wider = match.widened(variance)
        problem = _problem(camera, markers, wider, options).subset(used)
        pose = solve_pose(problem, pose, options.solver).pose
    return wider, pose


def _checked(
    camera: Camera,
    markers: MarkerPattern,
    match: Match,
    used: Mask,
    problem: PnpProblem,
    pose: RigidTransform,
    radius_px: float,
    options: MatchOptions,
) -> Solution | str:
    left = residuals_px(camera, markers, match, pose)[used]
    if not np.isfinite(left).all():
        return "the solver put markers behind the camera"
    rms_px = float(np.sqrt(np.mean(left**2)))
    if rms_px > options.max_residual_radii * radius_px:
        return (
            f"the {int(used.sum())} matched markers do not agree with one pose: "
            f"{rms_px:.1f} px rms are left"
        )
    covariance = pose_covariance(problem, pose)
    if covariance is None:
        return f"the {int(used.sum())} matched markers do not determine a pose"
    if options.solver.parametrisation == "euler_321":
        covariance, match = _measured_scale(camera, match, problem, pose, covariance, options)
    return Solution(pose, covariance, match, used, rms_px)


def _measured_scale(
    camera: Camera,
    match: Match,
    problem: PnpProblem,
    pose: RigidTransform,
    covariance: Floats,
    options: MatchOptions,
) -> tuple[Floats, Match]:
    """Without weights the residuals alone tell what a centroid is worth (Gavin 2020, eq. 20)."""
    focal_px = 0.5 * (camera.fx + camera.fy)
    variance = residual_variance(problem, pose)
    if variance is None:
        variance = (options.centroid_sigma_px / focal_px) ** 2
    each = np.broadcast_to(variance * focal_px**2 * np.eye(2), match.covariance_px2.shape)
    return variance * covariance, Match(match.points_px, each, match.marker)
