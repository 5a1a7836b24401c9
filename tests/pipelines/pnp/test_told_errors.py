from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.camera import camera_preset
from models.pose import RigidTransform
from models.spacecraft.grasp_markers import GRASP_MARKERS
from pipelines.eye_in_hand.options import BEST
from pipelines.pnp.levenberg_marquardt import solve_pose
from pipelines.pnp.problem import PnpProblem
from pipelines.pnp.told_errors import with_common_errors
from tests.support.synthetic_dots import facing

CAMERA = camera_preset("eye_in_hand")
POINTS = GRASP_MARKERS.points_in_target
OWN = np.broadcast_to(0.05**2 * np.eye(2), (3, 2, 2))
SIGMAS = {
    "camera.fx": 1.0, "camera.fy": 1.0, "camera.cx": 1.0, "camera.cy": 1.0,
    "camera.k1": 1e-3, "markers.point_in_target_m": 3e-4,
}  # fmt: skip
DRAWS = 400
# A variance of 400 draws has a 1-sigma of 7 %, a matrix's generalised one of six more.
SPREAD = 0.35


def errors_of(pose: RigidTransform, sigmas: dict[str, float]) -> Floats:
    """Solve draws in which camera and places are told wrong, (n, 6), rad and m."""
    rng = np.random.default_rng(3)
    pixels = CAMERA.project(pose @ POINTS)
    errors = []
    for _ in range(DRAWS):
        told = replace(
            CAMERA,
            **{
                key: getattr(CAMERA, key) + sigmas.get(f"camera.{key}", 0.0) * rng.standard_normal()
                for key in ("fx", "fy", "cx", "cy", "k1")
            },
        )
        places = POINTS + sigmas.get("markers.point_in_target_m", 0.0) * rng.standard_normal((3, 3))
        noisy = pixels + 0.05 * rng.standard_normal((3, 2))
        problem = PnpProblem.weighted(told, places, noisy, OWN)
        solved = solve_pose(problem, pose, BEST.solver).pose
        turn = Rotation.from_matrix(solved.rotation @ pose.rotation.T).as_rotvec()
        errors.append([*turn, *(solved.translation - pose.translation)])
    return np.array(errors)


@pytest.mark.parametrize("range_m", [1.4, 0.45])
@pytest.mark.parametrize("key", ["", "camera.", "markers."])
def test_the_covariance_is_that_of_many_draws(range_m: float, key: str) -> None:
    pose = facing(range_m, [3.0, -4.0, 2.0], (0.01, -0.01))
    sigmas = {name: sigma for name, sigma in SIGMAS.items() if name.startswith(key)}
    stated = with_common_errors(CAMERA, POINTS, pose, OWN, sigmas)
    errors = errors_of(pose, sigmas)
    root = np.linalg.inv(np.linalg.cholesky(stated))
    whitened = root @ (errors.T @ errors / DRAWS) @ root.T
    assert np.linalg.eigvalsh(whitened) == pytest.approx(np.ones(6), abs=SPREAD)


def test_with_nothing_told_it_is_the_solvers_own() -> None:
    pose = facing(0.8, [3.0, -4.0, 2.0])
    problem = PnpProblem.weighted(CAMERA, POINTS, CAMERA.project(pose @ POINTS), OWN)
    jacobian = problem.jacobian(pose.rotation, pose.translation)
    own = with_common_errors(CAMERA, POINTS, pose, OWN, {})
    assert own == pytest.approx(np.linalg.inv(jacobian.T @ jacobian), rel=1e-6, abs=1e-18)
