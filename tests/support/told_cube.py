"""Estimates of the cube's tumble as the truth has them, in axes of their own, to be carved by."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from bench.estimating.runs import estimates_path
from bench.scoring.unknown.judged_unknown import true_rate
from models.atomic_file import write_text
from models.dataset.detector_file import detector_to_toml
from models.dataset.estimates_file import write_estimates
from models.estimate import Estimate, NamedState, PoseEstimate
from models.pose import RigidTransform
from pipelines.unknown_target.pipeline import INERTIA, MOTION, SHAPE
from renders.truth.image_truth import ImageTruth
from tests.support.textured_cube import HALF_M
from tests.support.unknown_cube import DETECTOR, SKY_DN

TRUE_FROM_OWN = Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix()
INERTIA_KG_M2 = np.diag([1.0, 1.1, 1.3])
ON_IT = HALF_M * np.array([[1.0, 0.3, -0.2], [-0.4, 1.0, 0.1], [0.2, -0.6, -1.0], [1.0, 1.0, 1.0],
                           [-1.0, -1.0, -1.0], [0.0, -1.0, 0.9]])  # fmt: skip
OFF_IT = HALF_M * np.array([[1.9, 0.0, 0.0]])
SIGMA_M = 0.02


def told(truth: ImageTruth) -> Estimate:
    """Return what would be estimated of a frame without any error."""
    points = np.concatenate([ON_IT, OFF_IT]) @ TRUE_FROM_OWN
    inertia = TRUE_FROM_OWN.T @ (INERTIA_KG_M2 / np.trace(INERTIA_KG_M2)) @ TRUE_FROM_OWN
    pose = truth.cam_from_target
    own = RigidTransform(pose.rotation @ TRUE_FROM_OWN, pose.translation)
    states = {
        MOTION: NamedState(
            {
                "rho_in_lvlh_m": -truth.state.rho_in_lvlh,
                "rho_dot_in_lvlh_m_s": -truth.state.rho_dot_in_lvlh,
                "omega_in_target_rad_s": TRUE_FROM_OWN.T @ true_rate(truth),
            },
            1e-6 * np.eye(12),
        ),
        SHAPE: NamedState(
            {
                "points_in_target_m": points,
                "track": np.arange(len(points), dtype=np.float64),
                "sigma_m": np.full(len(points), SIGMA_M),
            }
        ),
        INERTIA: NamedState({"inertia_of_trace_1": inertia}),
    }
    return Estimate(truth.frame, truth.time_s, PoseEstimate(own, 1e-6 * np.eye(6)), states=states)


def write_told(folder: Path, truths: list[ImageTruth]) -> None:
    """Write such estimates of all frames of a dataset; its sky is calibrated as black."""
    black = replace(DETECTOR, bias_dn=SKY_DN)
    write_text(folder / "detector.toml", detector_to_toml(black))
    write_estimates(estimates_path(folder, 0, "best"), [told(truth) for truth in truths])
