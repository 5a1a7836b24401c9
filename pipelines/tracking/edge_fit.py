"""The pose that lays the target's edges on those of an image: search along normals, then solve.

Each visible sample of an edge looks along its normal for a step in brightness; the distances found
are brought to zero by Gauss-Newton with robust weights, and the search narrows as the pose
settles (Harris and Stennett 1990, "RAPID"; Drummond and Cipolla 2002, IEEE PAMI 24; the nearest of
several steps is taken, Vacchetti et al. 2004, ISMAR).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np

from models.arrays import AnyArray, Floats, Mask
from models.camera import Camera
from models.pose import RigidTransform
from pipelines.detection.edge_map import EdgeMap
from pipelines.detection.target_region import TargetRegion
from pipelines.pnp.projection_jacobian import jacobian_by_turn
from pipelines.tracking.model_edges import EdgeSamples

STRONG_SHARE = 0.3  # of the steepest step on a normal: weaker ones are texture
TUKEY = 4.685
LEAST_SCALE_PX = 0.5
DAMPING = 1e-6
FEWEST_SAMPLES = 30
FINE_STEP_PX = 0.5
ALIGNED_BEYOND_PX = 5.0  # a wider search takes only steps whose gradient lies along the normal,
ALIGNED_RAD = 0.45  # within this; a turn of the pose's error must not shut them out


@dataclass(frozen=True, eq=False)
class EdgeImage:
    """What the fit takes of an image: its light, its edges, and the camera that took it."""

    target: TargetRegion
    edge_map: EdgeMap
    camera: Camera


class ShownEdges(Protocol):
    """Edges that a pose shows, such as ``pipelines.tracking.model_edges.ModelEdges``."""

    @property
    def radius_m(self) -> float:
        """Of the target, m."""

    def shown(self, camera: Camera, cam_from_target: RigidTransform) -> EdgeSamples:
        """Return the samples that an image at a pose shows."""


@dataclass(frozen=True, eq=False)
class EdgeSteps:
    """What samples met along their normals.

    Attributes
    ----------
    distance_px : (n,) array, px
        Along the normal, from the predicted edge to the step; NaN where there is none.
    dark : (n,) array of bool
        Whether nothing shines on either side: no light, so no step to be expected.
    """

    distance_px: Floats
    dark: Mask

    @property
    def found(self) -> Mask:
        """Whether there is a step."""
        return np.isfinite(self.distance_px)


@dataclass(frozen=True, eq=False)
class EdgeFit:
    """Where a fit ended.

    Attributes
    ----------
    cam_from_target : RigidTransform
    samples : EdgeSamples
        As seen from there.
    steps : EdgeSteps
        What they met in the last search.
    weights : (n,) array
        What each was worth.
    information : (6, 6) array
        Of the pose, for steps of 1 px, independent along each edge but for ``correlation``.
    rms_px : float, px
        Weighted, along the normals.
    """

    cam_from_target: RigidTransform
    samples: EdgeSamples
    steps: EdgeSteps
    weights: Floats
    information: Floats
    rms_px: float


def search_steps(image: EdgeImage, samples: EdgeSamples, reach_px: float) -> EdgeSteps:
    """Look along each sample's normal for the nearest clear step in brightness.

    Parameters
    ----------
    image : EdgeImage
    samples : EdgeSamples
    reach_px : float, px
        How far to look, either way.
    """
    step = FINE_STEP_PX if reach_px <= 10.0 else 1.0
    count = int(np.ceil(reach_px / step)) + 2
    offsets = step * np.arange(-count, count + 1)
    places = samples.points_px[:, None] + offsets[None, :, None] * samples.normals_px[:, None]
    x, y = places[..., 0].astype(np.float32), places[..., 1].astype(np.float32)
    border = cv2.BORDER_REPLICATE
    level = cv2.remap(image.edge_map.smooth, x, y, cv2.INTER_LINEAR, borderMode=border)
    gate = cv2.remap(image.edge_map.noise, x, y, cv2.INTER_LINEAR, borderMode=border)
    slope = (level[:, 2:] - level[:, :-2]) / (2.0 * step)
    size = np.where(samples.outline[:, None], np.maximum(-slope, 0.0), np.abs(slope))
    gate = gate[:, 1:-1]
    peak = np.zeros(size.shape, dtype=bool)
    middle = size[:, 1:-1]
    peak[:, 1:-1] = (middle >= size[:, :-2]) & (middle > size[:, 2:])
    relative = size / gate
    strongest = np.where(peak, relative, 0.0).max(axis=1, keepdims=True)
    if reach_px > ALIGNED_BEYOND_PX:
        peak &= _aligned(image.edge_map, samples, x[:, 1:-1], y[:, 1:-1])
    peak &= (relative > 1.0) & (relative >= STRONG_SHARE * np.minimum(strongest, 10.0))
    away = np.where(peak, np.abs(offsets[1:-1]), np.inf)
    nearest = np.argmin(away, axis=1)
    rows = np.arange(len(samples))
    found = np.isfinite(away[rows, nearest])
    at = np.clip(nearest, 1, size.shape[1] - 2)
    left, centre, right = size[rows, at - 1], size[rows, at], size[rows, at + 1]
    curve = left - 2.0 * centre + right
    shift = np.where(curve < 0.0, 0.5 * (left - right) / np.where(curve < 0.0, curve, -1.0), 0.0)
    distance = offsets[1:-1][at] + step * np.clip(shift, -0.5, 0.5)
    if reach_px <= 10.0:
        distance = _sharpened(image, samples, distance)
    lit = level.max(axis=1) > np.arcsinh(1.0)
    return EdgeSteps(np.where(found, distance, np.nan), ~lit)


def _aligned(edge_map: EdgeMap, samples: EdgeSamples, x: AnyArray, y: AnyArray) -> Mask:
    """Tell where the image's gradient lies along the samples' normals, give or take."""
    height, width = edge_map.angle_rad.shape
    column = np.clip(np.rint(x).astype(np.int64), 0, width - 1)
    row = np.clip(np.rint(y).astype(np.int64), 0, height - 1)
    normal = np.arctan2(samples.normals_px[:, 1], samples.normals_px[:, 0])[:, None]
    away = np.abs((edge_map.angle_rad[row, column] - normal + 0.5 * np.pi) % np.pi - 0.5 * np.pi)
    return np.asarray(away < ALIGNED_RAD)


def _sharpened(image: EdgeImage, samples: EdgeSamples, distance_px: Floats) -> Floats:
    """Move steps to where the light itself, not its logarithm, is steepest.

    The stretched image is steepest far out in a bright edge's faint blur: half a pixel or more
    towards the dark side.
    """
    offsets = FINE_STEP_PX * np.arange(-6, 7)
    along = distance_px[:, None] + offsets[None]
    places = samples.points_px[:, None] + along[..., None] * samples.normals_px[:, None]
    x, y = places[..., 0].astype(np.float32), places[..., 1].astype(np.float32)
    light = cv2.remap(
        image.target.signal, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
    ).astype(np.float64)
    slope = np.abs(light[:, 2:] - light[:, :-2])
    # The centroid of the slope's upper half, within two pixels of where the step was seen.
    inner = offsets[1:-1]
    weight = np.maximum(slope - 0.5 * slope.max(axis=1, keepdims=True), 0.0)
    weight *= np.exp(-0.5 * (inner / 1.5) ** 2)
    total = weight.sum(axis=1)
    moved = (weight @ inner) / np.where(total > 0.0, total, 1.0)
    return distance_px + moved


def _tukey(residual: Floats, scale: float) -> Floats:
    ratio = residual / (TUKEY * scale)
    return np.where(np.abs(ratio) < 1.0, (1.0 - ratio**2) ** 2, 0.0)


def normal_jacobian(camera: Camera, pose: RigidTransform, samples: EdgeSamples) -> Floats:
    """Return how samples move along their normals with the pose, (n, 6), px per rad and m.

    Parameters
    ----------
    camera : Camera
    pose : RigidTransform
        ``cam_from_target``.
    samples : EdgeSamples
        As they are seen from there.
    """
    by_pose = jacobian_by_turn(pose.rotation, pose.translation, samples.points_in_target)
    by_pose = by_pose * np.array([camera.fx, camera.fy])[:, None]
    return np.asarray(np.einsum("ni,nij->nj", samples.normals_px, by_pose))


def fit_edges(
    image: EdgeImage,
    edges: ShownEdges,
    start: RigidTransform,
    reaches_px: tuple[float, ...],
    rounds: int = 2,
) -> EdgeFit | None:
    """Lay the target's edges on the image's.

    Parameters
    ----------
    image : EdgeImage
    edges : ShownEdges
    start : RigidTransform
        ``cam_from_target``.
    reaches_px : tuple of float, px
        How far to look along the normals, in order; visibility is told anew for each.
    rounds : int
        Searches and steps for each.

    Returns
    -------
    EdgeFit, or None where too few samples met a step.
    """
    pose = start
    fit: EdgeFit | None = None
    for reach in reaches_px:
        shown = edges.shown(image.camera, pose)
        if len(shown) < FEWEST_SAMPLES:
            return None
        for _ in range(rounds):
            shown = _moved(shown, image.camera, pose)
            steps = search_steps(image, shown, reach)
            solved = _solve(image.camera, pose, shown, steps, reach)
            if solved is None:
                return None
            change, weights, information, rms = solved
            fit = EdgeFit(pose, shown, steps, weights, information, rms)
            size = float(np.linalg.norm(change[:3]))
            if size > 0.5:  # rad: the linearisation means nothing
                change = change * (0.5 / size)
            pose = pose.perturbed(change[:3], change[3:])
            if not 0.1 * edges.radius_m < pose.translation[2] < 1e3 * edges.radius_m:
                return None
    if fit is None:
        return None
    return EdgeFit(pose, fit.samples, fit.steps, fit.weights, fit.information, fit.rms_px)


def _moved(samples: EdgeSamples, camera: Camera, pose: RigidTransform) -> EdgeSamples:
    """Project anew what still projects; normals turn little within a step and stay."""
    pixels = camera.project(pose @ samples.points_in_target)
    moved = EdgeSamples(
        samples.points_in_target, pixels, samples.normals_px, samples.edge, samples.outline
    )
    return moved.subset(np.asarray(np.isfinite(pixels).all(axis=1)))


def _solve(
    camera: Camera, pose: RigidTransform, samples: EdgeSamples, steps: EdgeSteps, reach_px: float
) -> tuple[Floats, Floats, Floats, float] | None:
    found = steps.found
    if found.sum() < FEWEST_SAMPLES:
        return None
    residual = np.where(found, np.nan_to_num(steps.distance_px), 0.0)
    spread = 1.4826 * float(np.median(np.abs(residual[found])))
    scale = float(np.clip(spread, LEAST_SCALE_PX, 0.5 * reach_px))
    weights = np.where(found, _tukey(residual, scale), 0.0)
    jacobian = normal_jacobian(camera, pose, samples)
    weighted = jacobian * weights[:, None]
    information = weighted.T @ jacobian
    diagonal = np.diag(information)
    if diagonal.min() <= 0.0:
        return None
    try:
        change = np.linalg.solve(information + DAMPING * np.diag(diagonal), weighted.T @ residual)
    except np.linalg.LinAlgError:
        return None
    if not np.isfinite(change).all():
        return None
    rms = float(np.sqrt((weights * residual**2).sum() / max(weights.sum(), 1e-9)))
    return np.asarray(change, dtype=np.float64), weights, information, rms
