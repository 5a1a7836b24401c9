"""A pose from a match: solve, reject what disagrees, say how good it is, or why there is none."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Mask
from models.camera import Camera
from models.markers import MarkerPattern
from models.pose import RigidTransform
from pipelines.pnp.consistency import common_variance_px2, find_outliers
from pipelines.pnp.covariance import pose_covariance, pose_scatter, residual_variance
from pipelines.pnp.levenberg_marquardt import solve_pose
from pipelines.pnp.match import Match, Solution
from pipelines.pnp.mirrored_pose import DECISIVE_CHI2, mirrored_pose, misfit, rival_of
from pipelines.pnp.predicted_pose import PredictedPose
from pipelines.pnp.problem import PnpProblem
from pipelines.pnp.solver_options import MatchOptions

REWEIGHTINGS = 2
BEHIND = "the solver put markers behind the camera"


def residuals_px(
    camera: Camera, markers: MarkerPattern, match: Match, pose: RigidTransform
) -> Floats:
    """Return detected minus reprojected, (n, 2) px.

    Parameters
    ----------
    camera : Camera
    markers : MarkerPattern
    match : Match
    pose : RigidTransform
        ``cam_from_target``.
    """
    return match.points_px - camera.project(pose @ markers.points_in_target[match.marker])


def _problem(
    camera: Camera, markers: MarkerPattern, match: Match, options: MatchOptions
) -> PnpProblem:
    points = markers.points_in_target[match.marker]
    if options.solver.parametrisation == "euler_321":
        return PnpProblem.unweighted(camera, points, match.points_px)
    return PnpProblem.weighted(
        camera, points, match.points_px, match.covariance_px2, match.common_px
    )


def solve_match(
    camera: Camera,
    markers: MarkerPattern,
    match: Match,
    start: RigidTransform,
    radius_px: float,
    options: MatchOptions,
    predicted: PredictedPose | None = None,
) -> Solution | str:
    """Solve for the pose; where the matches allow two and nothing tells which, for none.

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
    predicted : PredictedPose, optional
        Decides between two poses that the matches fit alike.

    Returns
    -------
    Solution or str
        In words, why there is none.
    """
    outcome = _solved_from(camera, markers, match, start, radius_px, options)
    if isinstance(outcome, str) or not options.verify:
        return outcome
    return _unambiguous(camera, markers, match, outcome, radius_px, options, predicted)


def _unambiguous(
    camera: Camera,
    markers: MarkerPattern,
    match: Match,
    found: Solution,
    radius_px: float,
    options: MatchOptions,
    predicted: PredictedPose | None,
) -> Solution | str:
    """Look for the mirrored pose, and return the better of the two if one is clearly better."""
    mirrored = mirrored_pose(found.pose, markers.points_in_target[found.match.marker[found.used]])
    if mirrored is None:
        return found
    other = _solved_from(camera, markers, match, mirrored, radius_px, options)
    if isinstance(other, str):
        return found
    apart_deg = rival_of(found, other)
    if apart_deg is None:
        return found
    # The better pose tells how large the errors are: the one that needed less widening.
    noise = min(found.match.covariance_px2, other.match.covariance_px2, key=np.sum)
    lead = 0.0
    for solution, sign in ((other, 1.0), (found, -1.0)):
        left = residuals_px(camera, markers, match, solution.pose)
        lead += sign * misfit(left, noise, options.outlier_sigmas)
    if abs(lead) < DECISIVE_CHI2 and predicted is not None:
        lead += predicted.squared_distance(other.pose) - predicted.squared_distance(found.pose)
    if abs(lead) < DECISIVE_CHI2:
        return (
            f"the pose is ambiguous: the {int(found.used.sum())} matched markers lie in a plane, "
            f"and two poses {apart_deg:.1f} deg apart fit them alike"
        )
    return found if lead > 0.0 else other


def _solved_from(
    camera: Camera,
    markers: MarkerPattern,
    match: Match,
    start: RigidTransform,
    radius_px: float,
    options: MatchOptions,
) -> Solution | str:
    if len(match) < options.min_markers:
        return (
            f"{len(match)} of the {len(markers)} markers matched, "
            f"at least {options.min_markers} are needed"
        )
    used = np.ones(len(match), dtype=np.bool_)
    problem = _problem(camera, markers, match, options)
    solved = solve_pose(problem, start, options.solver)
    if not np.isfinite(solved.chi2):
        return BEHIND
    pose = solved.pose
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
        kept = match.kept(used)
        variance = common_variance_px2(left, kept.covariance_px2, kept.common_px)
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
        return BEHIND
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
    scatter = pose_scatter(problem, pose, covariance)
    return Solution(pose, covariance, scatter, match, used, rms_px)


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
