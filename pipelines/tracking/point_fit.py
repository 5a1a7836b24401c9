"""The pose that unnamed points give near a rough one: match, solve, match again, to rest.

The end is the maximum of the likelihood over pose and one-to-one matches within a gate; its
covariance is the Cramer-Rao bound of the matches, points having equal and independent errors.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Indices
from models.camera import Camera
from models.pose import RigidTransform
from pipelines.pnp.gauss_newton import gauss_newton_step, linearised
from pipelines.pnp.identification import one_to_one

MOST_ROUNDS = 12
RESTED = 1e-6  # of the last step, in radians and in shares of the range; what is left is its square
LEAST_MATCHES = 4
SINGULAR = 1e-14


@dataclass(frozen=True, eq=False)
class PointFit:
    """A pose with its matches.

    Attributes
    ----------
    pose : RigidTransform
        ``cam_from_target``.
    covariance : (6, 6) array, rad and m
        Rotation first, as in ``RigidTransform.perturbed``.
    matched : (n,) int array
        The landmark of each point, or -1.
    residual_rms_px : float, px
        Per axis, over the matches.
    rested : bool
        Whether the matches and the pose came to rest together.
    """

    pose: RigidTransform
    covariance: Floats
    matched: Indices
    residual_rms_px: float
    rested: bool

    @property
    def matches(self) -> int:
        """Number of points matched."""
        return int(np.count_nonzero(self.matched >= 0))


def fit_points(
    points_px: Floats,
    points_in_target: Floats,
    camera: Camera,
    start: RigidTransform,
    sigma_px: float,
    first_gate_px: float,
    gate_px: float,
    named: Indices | None = None,
    shown: Indices | None = None,
) -> PointFit | str:
    """Solve for the pose near a rough one.

    Parameters
    ----------
    points_px : (n, 2) array, px
    points_in_target : (m, 3) array, m
        All landmarks.
    camera : Camera
    start : RigidTransform
        Rough ``cam_from_target``.
    sigma_px : float, px
        1-sigma of a point, per axis.
    first_gate_px : float, px
        Within which the rough pose finds matches.
    gate_px : float, px
        Within which the solved pose finds them.
    named : (n,) int array, optional
        Matches to begin with, in place of the rough pose's own: a landmark each, or -1.
    shown : (k,) int array, optional
        Landmarks that may be matched; without it, all.

    Returns
    -------
    PointFit or str
        In words, why there is none.
    """
    focal_px = 0.5 * (camera.fx + camera.fy)
    normalised = camera.normalise(points_px)
    rotation, translation = start.rotation[None], start.translation[None]
    matched = named
    widths = (max(first_gate_px, gate_px) / focal_px, gate_px / focal_px)
    observed = np.zeros((1, 2, len(points_in_target)))
    before: Indices | None = None
    rested = False
    for turn in range(MOST_ROUNDS):
        linear = linearised(rotation, translation, points_in_target)
        if turn or matched is None:
            matched = _matches(linear[0][0].T, normalised, widths[min(turn, 1)], shown)
        if np.count_nonzero(matched >= 0) < LEAST_MATCHES:
            return f"{np.count_nonzero(matched >= 0)} of {len(points_px)} points match a landmark"
        taken = matched >= 0
        observed[0][:, matched[taken]] = normalised[taken].T
        weights = np.zeros((1, len(points_in_target)))
        weights[0, matched[taken]] = 1.0
        moved = gauss_newton_step(rotation, translation, linear, observed, weights)
        if not moved[2][0]:
            return "the matched points do not determine a pose"
        change = max(
            float(np.abs(moved[0] - rotation).max()),
            float(np.abs(moved[1] - translation).max()) / float(translation[0, 2]),
        )
        rotation, translation = moved[:2]
        if not translation[0, 2] > 0.0:
            return "the solver put the target behind the camera"
        same = before is not None and bool((matched == before).all())
        if same and turn > 1 and change < RESTED:
            rested = True
            break
        before = matched
    assert matched is not None
    return _finished(
        rotation, translation, points_in_target, normalised, matched, sigma_px, focal_px, rested
    )


def _matches(predicted: Floats, normalised: Floats, gate: float, shown: Indices | None) -> Indices:
    """Match one to one, at least total squared distance; only where crowded does it cost time."""
    expected = predicted if shown is None else predicted[shown]
    gaps = normalised[:, None, :] - expected
    squared = np.einsum("nmi,nmi->nm", gaps, gaps)
    near = squared < gate * gate
    if (near.sum(axis=0) <= 1).all() and (near.sum(axis=1) <= 1).all():
        matched = np.where(near.any(axis=1), near.argmax(axis=1), -1)
    else:
        matched = one_to_one(squared / gate**2, near)
    return matched if shown is None else np.where(matched >= 0, shown[matched], -1)


def _finished(
    rotation: Floats,
    translation: Floats,
    points_in_target: Floats,
    normalised: Floats,
    matched: Indices,
    sigma_px: float,
    focal_px: float,
    rested: bool,
) -> PointFit | str:
    taken = matched >= 0
    predicted, jacobian = linearised(rotation, translation, points_in_target[matched[taken]])
    covariance = _bound(jacobian[0].reshape(6, -1) * (focal_px / sigma_px))
    if covariance is None:
        return "the matched points do not determine a pose"
    left_px = focal_px * (normalised[taken] - predicted[0].T)
    pose = RigidTransform(_orthonormal(rotation[0]), translation[0])
    return PointFit(pose, covariance, matched, float(np.sqrt(np.mean(left_px**2))), rested)


def covariance_of(
    pose: RigidTransform, points_in_target: Floats, focal_px: float, sigma_px: float
) -> Floats | None:
    """Return the Cramer-Rao bound of a pose seen by points, or None where there is none.

    (6, 6), rad and m, rotation first, as in ``RigidTransform.perturbed``.

    Parameters
    ----------
    pose : RigidTransform
        ``cam_from_target``.
    points_in_target : (n, 3) array, m
    focal_px : float, px
    sigma_px : float, px
        1 sigma of each point on each axis.
    """
    _, jacobian = linearised(pose.rotation[None], pose.translation[None], points_in_target)
    return _bound(jacobian[0].reshape(6, -1) * (focal_px / sigma_px))


def _bound(whitened: Floats) -> Floats | None:
    """Invert the information of a whitened Jacobian, (6, 2n)."""
    scale = np.sqrt(np.einsum("ij,ij->i", whitened, whitened))
    if not (np.isfinite(scale).all() and scale.min() > 0.0):
        return None
    balanced = whitened / scale[:, None]
    information = balanced @ balanced.T
    eigenvalues = np.linalg.eigvalsh(information)
    if not eigenvalues[0] > SINGULAR * eigenvalues[-1]:
        return None
    covariance = np.linalg.inv(information) / (scale[:, None] * scale)
    return np.asarray(0.5 * (covariance + covariance.T), dtype=np.float64)


def _orthonormal(rotation: Floats) -> Floats:
    """Take rounding off a rotation: one step towards its polar factor."""
    return 1.5 * rotation - 0.5 * rotation @ rotation.T @ rotation
