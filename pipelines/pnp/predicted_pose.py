"""Where a target should be, and how sure that is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.pose import RigidTransform

LEAST_VARIANCE = 1e-12  # rad^2 and m^2: keeps a prediction without uncertainty invertible


@dataclass(frozen=True, eq=False)
class PredictedPose:
    """Where the target should be.

    Attributes
    ----------
    pose : RigidTransform
        ``cam_from_target``.
    covariance : (6, 6) array, rad and m
        Rotation first, as in ``RigidTransform.perturbed``.
    lost_frames : int
        Frames without a pose since the last one.
    """

    pose: RigidTransform
    covariance: Floats
    lost_frames: int

    def squared_distance(self, pose: RigidTransform) -> float:
        """Return how far another pose lies from this one, squared, in sigmas of all six."""
        turn = Rotation.from_matrix(pose.rotation @ self.pose.rotation.T).as_rotvec()
        away = np.concatenate([turn, pose.translation - self.pose.translation])
        return float(away @ np.linalg.solve(self.covariance + LEAST_VARIANCE * np.eye(6), away))
