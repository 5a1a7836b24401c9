"""Problems for solvers: ten corner cubes seen along the approach, with noise and first poses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.camera import camera_preset
from models.spacecraft.retroreflector_layout import RETROREFLECTORS

NEAR_M, FAR_M = 1.8, 6.7
TILT_DEG = 3.0  # 1 sigma about each axis of how the target faces the camera
PRIOR_M, PRIOR_DEG = np.array([0.017, 0.017, 0.05]), 1.0  # Opromolla et al. 2022, Table 5


@dataclass(frozen=True, eq=False)
class Problems:
    """As many problems of the same points as there are.

    Attributes
    ----------
    points_in_target : (m, 3) array, m
    observed : (b, m, 2) array
        Normalised coordinates, with noise.
    sigma : float
        Of the noise, normalised coordinates.
    rotations, translations : (b, 3, 3) and (b, 3) arrays, m
        True ``cam_from_target``.
    start_rotations, start_translations : (b, 3, 3) and (b, 3) arrays, m
        First poses.
    """

    points_in_target: Floats
    observed: Floats
    sigma: float
    rotations: Floats
    translations: Floats
    start_rotations: Floats
    start_translations: Floats

    def __len__(self) -> int:
        return len(self.observed)


def drawn_problems(count: int, noise_px: float, seed: int) -> Problems:
    """Draw problems: ranges even in their logarithm, first poses with the errors of Table 5.

    Parameters
    ----------
    count : int
    noise_px : float, px
        1 sigma of a centroid on each axis.
    seed : int
    """
    rng = np.random.default_rng([0x50E5, seed])
    points = np.ascontiguousarray(RETROREFLECTORS.points_in_target)
    centre = points.mean(axis=0)
    facing = np.diag([1.0, -1.0, -1.0])
    tilts = Rotation.from_rotvec(np.deg2rad(TILT_DEG) * rng.standard_normal((count, 3)))
    rotations = tilts.as_matrix() @ facing
    range_m = np.exp(rng.uniform(np.log(NEAR_M), np.log(FAR_M), count))
    translations = range_m[:, None] * np.array([0.0, 0.0, 1.0]) - rotations @ centre
    in_cam = np.einsum("bij,mj->bmi", rotations, points) + translations[:, None]
    sigma = noise_px / camera_preset("chaser_fixed").fx
    projected = in_cam[..., :2] / in_cam[..., 2:]
    turns = Rotation.from_rotvec(np.deg2rad(PRIOR_DEG) * rng.standard_normal((count, 3)))
    return Problems(
        points,
        projected + sigma * rng.standard_normal(projected.shape),
        sigma,
        rotations,
        translations,
        turns.as_matrix() @ rotations,
        translations + PRIOR_M * rng.standard_normal((count, 3)),
    )
