"""The pose of a target in an image near a predicted one, with its covariance and whether it fits.

The predicted pose is laid on the image's edges; where it does not come to fit, it is tried again
from a wider search and from poses about the prediction. A pose is believed only if the edges are
where it says and no light is where it says there is none, so that a wrong one is dropped at once,
or within a few frames as the target turns on.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Indices
from models.camera import Camera
from models.pose import RigidTransform
from pipelines.pnp.projection_jacobian import jacobian_by_turn
from pipelines.tracking.edge_fit import EdgeFit, EdgeImage, fit_edges, normal_jacobian
from pipelines.tracking.model_edges import ModelEdges
from pipelines.tracking.pose_check import PoseCheck, check_pose

DRAWN_OUTSIDE = 0.06  # light outside the silhouette that a right pose may well have
DARK_DOUBT = 5.0  # how much more an edge errs where all others lie in the dark
LEAST_SIGMA_PX = 0.35  # of half an edge: the drawing's and the light's errors, measured
SHARED = 0.85  # of the samples' rms, what those of half an edge have in common
OUTLINE_SIGMA_PX = 0.2  # of all outlines together, outwards: measured
SHIFT_SIGMA_PX = 0.05  # of all edges together, along either axis of the image: measured
LEAST_EIGENVALUE = 1e-9


@dataclass(frozen=True)
class ImageTrackingOptions:
    """How far to look about a prediction, and what to believe.

    Attributes
    ----------
    reach_sigmas : float
        Search reach over the predicted uncertainty in the image.
    nearest_px, farthest_px : float, px
        Bounds of that reach.
    least_score : float
        Of ``PoseCheck``: less fits no image.
    least_supported : float
        Share of the edges in light that must be found, whatever the score.
    sure_score : float
        Less is tried again, from about the prediction.
    retries : int
        How often.
    """

    reach_sigmas: float = 3.0
    nearest_px: float = 8.0
    farthest_px: float = 24.0
    least_score: float = 0.45
    least_supported: float = 0.7
    sure_score: float = 0.7
    retries: int = 2


@dataclass(frozen=True, eq=False)
class TrackedPose:
    """A pose laid on an image, how it fits, and why it is not believed, if it is not."""

    fit: EdgeFit
    check: PoseCheck
    doubt: str


def track_in_image(
    image: EdgeImage,
    edges: ModelEdges,
    predicted: RigidTransform,
    covariance: Floats,
    options: ImageTrackingOptions,
) -> TrackedPose | str:
    """Find the pose near a predicted one.

    Parameters
    ----------
    image : EdgeImage
    edges : ModelEdges
    predicted : RigidTransform
        ``cam_from_target``.
    covariance : (6, 6) array, rad and m
        Of the prediction, as in ``RigidTransform.perturbed``.
    options : ImageTrackingOptions

    Returns
    -------
    TrackedPose, or why there is none.
    """
    if not image.target:
        return "nothing in the image stands out of the sky"
    spread = options.reach_sigmas * spread_px(image.camera, edges, predicted, covariance)
    reach = float(np.clip(spread, options.nearest_px, options.farthest_px))
    best: TrackedPose | None = None
    for start, wide in _starts(predicted, covariance, reach, options):
        fit = fit_edges(image, edges, start, (wide, max(0.6 * wide, 5.0), 5.0, 4.0))
        if fit is None:
            continue
        check = check_pose(image, edges, fit.cam_from_target)
        if best is None or check.score > best.check.score:
            best = TrackedPose(fit, check, _doubt(check, options))
        if best.check.score >= options.sure_score:
            break
    return "the predicted edges meet no edges of the image" if best is None else best


def spread_px(
    camera: Camera, edges: ModelEdges, predicted: RigidTransform, covariance: Floats
) -> float:
    """Return how far off the prediction may have the target's corners, 1-sigma rms, px.

    Parameters
    ----------
    camera : Camera
    edges : ModelEdges
    predicted : RigidTransform
        ``cam_from_target``.
    covariance : (6, 6) array, rad and m
        Rotation first, as in ``RigidTransform.perturbed``.
    """
    points = edges.wireframe.points_in_target
    by_pose = jacobian_by_turn(predicted.rotation, predicted.translation, points)
    by_pose = (by_pose * np.array([camera.fx, camera.fy])[:, None]).reshape(-1, 6)
    variance = np.einsum("ni,ij,nj->n", by_pose, covariance, by_pose)
    return float(np.sqrt(max(float(variance.mean()), 0.0)))


def fit_covariance(fit: EdgeFit, camera: Camera, check: PoseCheck) -> Floats | None:
    """Return the covariance of a fitted pose, (6, 6) rad and m; None where edges do not fix it.

    The fit weighs samples alike, as if each erred by itself, but the samples of an edge err
    together: what moves the pose is the sum over each half of an edge, of as much as the fit gives
    it (the covariance of an estimate whose weights are not those of its errors: White 1982,
    Econometrica 50). All outlines together may lie outside or inside of the drawing's, which is
    mostly an error of the range, and light from one side moves all edges a little. Where much
    light falls outside the silhouette, the image shows what the drawing leaves out, and edges are
    taken for others; where edges lie in the dark, the light ends at shadows that are none of them:
    the sigma grows with both.

    Parameters
    ----------
    fit : EdgeFit
    camera : Camera
    check : PoseCheck
        Of the pose.
    """
    samples = fit.samples
    jacobian = normal_jacobian(camera, fit.cam_from_target, samples)
    weighted = jacobian * fit.weights[:, None]
    information = weighted.T @ jacobian
    scale = np.sqrt(np.maximum(np.diag(information), 0.0))
    if scale.min() <= 0.0:
        return None
    balanced = information / np.outer(scale, scale)
    if np.linalg.eigvalsh(balanced)[0] < LEAST_EIGENVALUE:
        return None
    gain = np.linalg.solve(balanced, (weighted / scale).T) / scale[:, None]
    half = np.zeros((2 * (int(samples.edge.max()) + 1), 6))
    np.add.at(half, _halves(samples.edge), gain.T)
    doubt = 1.0 + (check.outside / DRAWN_OUTSIDE) ** 3 + DARK_DOUBT * check.unseen
    sigma = max(LEAST_SIGMA_PX, SHARED * fit.rms_px) * doubt
    swollen = OUTLINE_SIGMA_PX * gain @ samples.outline
    shifted = SHIFT_SIGMA_PX * gain @ samples.normals_px
    covariance = sigma**2 * half.T @ half + np.outer(swollen, swollen) + shifted @ shifted.T
    return np.asarray(0.5 * (covariance + covariance.T))


def _halves(edge: Indices) -> Indices:
    """Return the half of an edge that each of its samples, which follow each other, lies on."""
    first = np.searchsorted(edge, edge, side="left")
    count = np.bincount(edge)[edge]
    return 2 * edge + (2 * (np.arange(len(edge)) - first) >= count)


def _starts(
    predicted: RigidTransform, covariance: Floats, reach: float, options: ImageTrackingOptions
) -> list[tuple[RigidTransform, float]]:
    """Return the prediction, then poses about it: a fixed draw, the same for every frame."""
    starts = [(predicted, reach)]
    if reach < options.farthest_px:
        starts.append((predicted, options.farthest_px))
    values, vectors = np.linalg.eigh(covariance)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    for draw in np.random.default_rng([4, 6]).standard_normal((options.retries, 6)):
        step = 1.5 * root @ draw
        turn = step[:3] * min(1.0, 0.3 / max(float(np.linalg.norm(step[:3])), 1e-9))
        starts.append((predicted.perturbed(turn, step[3:]), options.farthest_px))
    return starts


def _doubt(check: PoseCheck, options: ImageTrackingOptions) -> str:
    if check.score >= options.least_score and check.supported >= options.least_supported:
        return ""
    return (
        f"the pose fits the image by {check.score:.2f}, {options.least_score:.2f} is needed: "
        f"{100 * check.supported:.0f} % of its edges are found, {100 * check.outside:.0f} % of the "
        f"light is outside it"
    )
