"""A target known by its corners, and the points that an image of it would give."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats, Indices
from models.camera import Camera, camera_preset
from models.pose import RigidTransform
from models.wireframe.wireframe import Wireframe

CAMERA: Camera = camera_preset("chaser_fixed")
RANGE_M = 30.0


def _corners(low: tuple[float, ...], high: tuple[float, ...]) -> list[list[float]]:
    return [
        [x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])
    ]


def telescope_target() -> Wireframe:
    """Return a telescope of 10.8 m with wings of 16 m span: 24 landmarks, no symmetry.

    A box, a narrower box at the end of the tube, and two wings whose corners are the appendages.
    """
    box = _corners((-4.0, -1.2, -1.3), (-1.5, 1.2, 1.1))
    end = _corners((5.2, -0.8, -0.8), (6.8, 0.8, 0.9))
    wings = [[x, y, z] for y in (-8.0, -2.2, 2.2, 8.0) for x, z in ((-3.6, 0.1), (-1.9, 0.25))]
    points = np.array(box + end + wings)
    names = tuple(f"corner_{index}" for index in range(len(points)))
    appendage = np.zeros(len(points), dtype=np.bool_)
    appendage[[*range(12, 16), *range(16, 18), *range(22, 24)]] = True
    edges = np.array([[16, 17], [22, 23], [16, 18], [20, 22]])
    return Wireframe("telescope", names, points, appendage, edges, np.zeros((0, 3, 3)))


def any_pose(rng: np.random.Generator, range_m: float = RANGE_M) -> RigidTransform:
    """Draw an attitude at random, at a range near the boresight."""
    turn = Rotation.random(rng=rng).as_matrix()
    return RigidTransform(turn, np.array([*rng.uniform(-0.5, 0.5, 2), range_m]))


def seen_points(
    wireframe: Wireframe,
    pose: RigidTransform,
    rng: np.random.Generator,
    sigma_px: float,
    outliers: int = 1,
) -> tuple[Floats, Indices]:
    """Project all landmarks, add noise and outliers within their box, and shuffle.

    Returns
    -------
    points_px : (n, 2) array, px
    landmark : (n,) int array
        The landmark of each point, or -1 for an outlier.
    """
    points = CAMERA.project(pose @ wireframe.points_in_target)
    points = points + sigma_px * rng.standard_normal(points.shape)
    wrong = rng.uniform(points.min(axis=0), points.max(axis=0), (outliers, 2))
    landmark = np.concatenate([np.arange(len(points)), np.full(outliers, -1)])
    order = rng.permutation(len(landmark))
    return np.concatenate([points, wrong])[order], landmark[order]


def normalised_squared_error(
    estimate: RigidTransform, truth: RigidTransform, covariance: Floats
) -> float:
    """Return e^T P^-1 e of a pose in the six numbers of ``RigidTransform.perturbed``."""
    turn = Rotation.from_matrix(estimate.rotation @ truth.rotation.T).as_rotvec()
    error = np.concatenate([turn, estimate.translation - truth.translation])
    return float(error @ np.linalg.solve(covariance, error))
