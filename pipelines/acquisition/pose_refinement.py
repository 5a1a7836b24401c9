"""Many rough poses made good at once: match, step, match again with a narrower gate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Indices
from pipelines.pnp.gauss_newton import gauss_newton_step, linearised

GATES = (3.0, 2.0, 1.5, 1.0, 1.0)  # over the last gate, one for each step
FAR = 1e18


@dataclass(frozen=True, eq=False)
class RefinedPoses:
    """Poses with what they explain.

    Attributes
    ----------
    rotations : (b, 3, 3) array
    translations : (b, 3) array, m
    point : (b, m) int array
        The image point of each landmark, or -1.
    log_likelihood : (b,) array
        Over that of points strewn at random over their box, none of them matched.
    """

    rotations: Floats
    translations: Floats
    point: Indices
    log_likelihood: Floats

    @property
    def matches(self) -> Indices:
        """(b,) array: landmarks matched."""
        return np.count_nonzero(self.point >= 0, axis=1)


def mutual_matches(predicted: Floats, away: Floats, gate: float) -> tuple[Indices, Floats]:
    """Match landmarks and points that are nearest to each other.

    Parameters
    ----------
    predicted : (b, 2, m) array
        Landmarks by each pose.
    away : (2, n) array
        Points, in the same coordinates.
    gate : float

    Returns
    -------
    point : (b, m) int array
        Index of a point, or -1.
    squared : (b, m) array
        Squared distance to the nearest point, matched or not.
    """
    gaps = predicted[:, :, :, None] - away[:, None, :]
    gaps *= gaps
    squared = gaps[:, 0] + gaps[:, 1]
    point = squared.argmin(axis=2)
    landmark = squared.argmin(axis=1)
    nearest = np.take_along_axis(squared, point[:, :, None], axis=2)[:, :, 0]
    back = np.take_along_axis(landmark, point, axis=1)
    mutual = (back == np.arange(point.shape[1])) & (nearest < gate * gate)
    return np.where(mutual, point, -1), nearest


def refined_poses(
    rotations: Floats,
    translations: Floats,
    points_in_target: Floats,
    normalised: Floats,
    sigma: float,
    gate_sigmas: float,
) -> RefinedPoses:
    """Refine poses against unnamed points.

    Parameters
    ----------
    rotations : (b, 3, 3) array
    translations : (b, 3) array, m
    points_in_target : (m, 3) array, m
    normalised : (n, 2) array
        Undistorted normalised image points.
    sigma : float
        1-sigma of a point, in the same coordinates.
    gate_sigmas : float
        A match's largest distance in the end.
    """
    away = np.ascontiguousarray(normalised.T)
    for widening in GATES:
        linear = linearised(rotations, translations, points_in_target)
        point, _ = mutual_matches(linear[0], away, widening * gate_sigmas * sigma)
        weights = (point >= 0).astype(np.float64)
        observed = away[:, np.maximum(point, 0)].transpose(1, 0, 2)
        rotations, translations, _ = gauss_newton_step(
            rotations, translations, linear, observed, weights
        )
    predicted, _ = linearised(rotations, translations, points_in_target)
    point, squared = mutual_matches(predicted, away, gate_sigmas * sigma)
    box = float(np.prod(np.maximum(np.ptp(normalised, axis=0), 10.0 * sigma)))
    gain = np.log(box / (2.0 * np.pi * sigma**2)) - 0.5 * squared / sigma**2
    likelihood = np.where(point >= 0, gain, 0.0).sum(axis=1)
    likelihood = np.where(np.isfinite(likelihood) & (translations[:, 2] > 0.0), likelihood, -FAR)
    return RefinedPoses(rotations, translations, point, likelihood)
