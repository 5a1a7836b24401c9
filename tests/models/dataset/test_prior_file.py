from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from models.dataset.prior_file import NEAREST_M, prior_to_toml, read_prior
from models.errors import DatasetError
from models.onboard import PosePrior
from models.pose import RigidTransform, pose_error
from tests.support.strategies import rigid_transforms, vectors

EULER_ROUNDING_DEG = 1e-5  # worst beside gimbal lock; elsewhere a hundred million times better


@given(rigid_transforms(), vectors(10.0), vectors(180.0), st.floats(2 * NEAREST_M, 100.0))
def test_any_prior_comes_back(
    tmp_path_factory: pytest.TempPathFactory,
    pose: RigidTransform,
    sigma_m: np.ndarray,
    sigma_deg: np.ndarray,
    ahead_m: float,
) -> None:
    pose = RigidTransform(pose.rotation, np.array([*pose.translation[:2], ahead_m]))
    assume(abs(pose.rotation[0, 2]) < 1.0)
    told = PosePrior(pose, np.abs(sigma_m), np.abs(sigma_deg))
    path = tmp_path_factory.mktemp("any") / "prior.toml"
    path.write_text(prior_to_toml(told))
    back = read_prior(path)
    np.testing.assert_array_equal(back.sigma_m, told.sigma_m)
    np.testing.assert_array_equal(back.sigma_deg, told.sigma_deg)
    np.testing.assert_array_equal(back.cam_from_target.translation, pose.translation)
    assert pose_error(back.cam_from_target, pose).attitude_deg < EULER_ROUNDING_DEG


GOOD = {
    "t_cam_from_target_m": "[0.1, 0.8, 6.7]",
    "euler_321_deg": "[180.0, 0.0, 0.0]",
    "sigma_t_m": "[0.1, 0.1, 0.1]",
    "sigma_euler_deg": "[1.0, 1.0, 1.0]",
}


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("t_cam_from_target_m", "[0.1, 0.8]", "as lists of 3 numbers"),
        ("t_cam_from_target_m", '"near"', "as lists of 3 numbers, got 'near'"),
        ("t_cam_from_target_m", "[nan, 0.0, 6.7]", "as numbers of at least .*, got nan"),
        ("t_cam_from_target_m", "[0.0, 0.0, 0.0]", "with the target in front of the camera"),
        ("t_cam_from_target_m", "[0.0, 0.0, -5.0]", "with the target in front of the camera"),
        ("t_cam_from_target_m", "[0.0, 0.0, 1e300]", "as numbers of at least"),
        ("euler_321_deg", "[180.0, 0.0]", "as lists of 3 numbers"),
        ("euler_321_deg", "[1e9, 0.0, 0.0]", "as numbers of at least"),
        ("sigma_t_m", "[0.017, 0.017]", "as lists of 3 numbers"),
        ("sigma_t_m", "[0.017, -0.017, 0.01]", r"as numbers of at least 0 .*, got -0\.017"),
        ("sigma_euler_deg", "[1.0, -1.0, 1.0]", r"as numbers of at least 0 .*, got -1\.0"),
        ("sigma_euler_deg", "[1.0, inf, 1.0]", "as numbers of at least 0 .*, got inf"),
    ],
)
def test_a_prior_that_cannot_be_is_refused(tmp_path: Path, key: str, value: str, said: str) -> None:
    path = tmp_path / "prior.toml"
    path.write_text("\n".join(f"{name} = {text}" for name, text in {**GOOD, key: value}.items()))
    with pytest.raises(DatasetError, match=rf"prior\.toml: expected {key} {said}"):
        read_prior(path)


def test_a_key_more_or_less_is_named(tmp_path: Path) -> None:
    path = tmp_path / "prior.toml"
    told = {**GOOD, "sigma_m": GOOD["sigma_t_m"]}
    del told["sigma_t_m"]
    path.write_text("\n".join(f"{name} = {text}" for name, text in told.items()))
    with pytest.raises(DatasetError, match="unknown: sigma_m; missing: sigma_t_m"):
        read_prior(path)
