"""A pose whose covariance is none: refused with a reason, and the filters stay as they were."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.estimate import Estimate, PoseEstimate
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.relative_state import RelativeState
from models.motion.tumble import Tumble
from models.pose import RigidTransform
from pipelines.filters.covariance_fault import covariance_fault, positive
from pipelines.filters.navigation_options import BEST, PAPER, NavigationOptions
from pipelines.filters.relative_navigation import FilteredState, RelativeNavigation

SIGMA = np.array([*np.deg2rad([0.16, 0.14, 0.05]), 0.008, 0.008, 0.043])
GOOD = np.diag(SIGMA**2)
MOUNT = RigidTransform(
    Rotation.from_rotvec([0.5 * np.pi, 0.0, 0.0]).as_matrix(), np.array([0.0, 0.0, -0.5])
)
TUMBLE = Tumble(
    KeplerOrbit(7.1431e6, 1.4e-4, np.deg2rad(98.2), 1.38, 1.5, 0.0),
    np.array([0.0, 30.0, 0.0]),
    np.array([0.0, 1e-4, 0.0]),
    np.deg2rad([0.5, -0.3, 0.2]),
    np.diag([1.0, 2.0, 3.0]),
    10.0,
)


def changed(**entries: float) -> Floats:
    """Return a good covariance with entries named ``c03`` put to other values."""
    covariance = GOOD.copy()
    for name, value in entries.items():
        covariance[int(name[1]), int(name[2])] = value
    return covariance


FAULTS: dict[str, tuple[Floats | None, str]] = {
    "none stated": (None, r"no \(6, 6\) covariance"),
    "one NaN": (changed(c03=np.nan), "not finite"),
    "NaN all over": (np.full((6, 6), np.nan), "not finite"),
    "infinite": (changed(c55=np.inf), "not finite"),
    "negated": (-GOOD, "not positive"),
    "nothing": (np.zeros((6, 6)), "not positive"),
    "one variance negative": (changed(c22=-1e-6), "not positive"),
    "correlated above one": (
        changed(c34=1.1 * SIGMA[3] * SIGMA[4], c43=1.1 * SIGMA[3] * SIGMA[4]),
        "not positive",
    ),
    "one-sided": (changed(c01=0.2 * SIGMA[0] * SIGMA[1]), "not symmetric"),
    "sharper than any camera": (1e-30 * GOOD, "which no camera has"),
    "telling nothing": (1e30 * GOOD, "which no camera has"),
    "of three": (np.eye(3), r"no \(6, 6\) covariance"),
}


def pose_of(state: RelativeState, covariance: Floats | None) -> Estimate:
    return Estimate(0, state.time_s, PoseEstimate(state.cam_from_target(MOUNT), covariance, 1.0))


def predicted(options: NavigationOptions) -> tuple[RelativeNavigation, FilteredState]:
    filters = RelativeNavigation(options, MOUNT)
    filters.start_from_pose(pose_of(TUMBLE.state(0.0), GOOD), TUMBLE.chaser_state(0.0))
    return filters, filters.predict(1.0, TUMBLE.chaser_state(1.0))


def numbers(state: FilteredState) -> list[Floats]:
    return [
        state.state.rho_in_lvlh,
        state.state.rho_dot_in_lvlh,
        state.state.R_lvlh_from_target,
        state.state.omega_target_wrt_lvlh_in_target,
        state.translation_covariance,
        state.rotation_covariance,
    ]


@pytest.mark.parametrize("options", [PAPER, BEST], ids=["paper", "best"])
@pytest.mark.parametrize(("covariance", "said"), FAULTS.values(), ids=FAULTS.keys())
def test_a_pose_without_a_true_covariance_is_refused_and_nothing_moves(
    options: NavigationOptions, covariance: Floats | None, said: str
) -> None:
    filters, before = predicted(options)
    now = filters.update(pose_of(TUMBLE.state(1.0), covariance))
    assert not now.used_pose
    assert now.refused_in_row == 1
    assert said.replace("\\", "") in now.reason
    for kept, was in zip(numbers(now), numbers(before), strict=True):
        np.testing.assert_array_equal(kept, was)
    assert filters.update(pose_of(TUMBLE.state(1.0), GOOD)).used_pose


@pytest.mark.parametrize(("covariance", "said"), FAULTS.values(), ids=FAULTS.keys())
def test_the_filters_do_not_start_from_such_a_pose(covariance: Floats | None, said: str) -> None:
    filters = RelativeNavigation(BEST, MOUNT)
    with pytest.raises(ValueError, match=said):
        filters.start_from_pose(pose_of(TUMBLE.state(0.0), covariance), TUMBLE.chaser_state(0.0))
    assert not filters.started


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_a_covariance_of_any_likely_size_is_none_of_these(scale: float) -> None:
    rng = np.random.default_rng(3)
    root = SIGMA[:, None] * rng.standard_normal((6, 6))
    assert covariance_fault(scale * (root @ root.T)) == ""


def test_none_at_all_is_a_fault() -> None:
    assert covariance_fault(None) == "no (6, 6) covariance"


@pytest.mark.parametrize("change", [np.diag([1e-18, 1.0]), np.array([[1.0, 0.999], [0.999, 1.0]])])
def test_positive_is_told_whatever_the_units(change: Floats) -> None:
    assert positive(change)
    assert not positive(change - 1.001 * np.linalg.eigvalsh(change)[0] * np.eye(2))


@pytest.mark.parametrize("time_s", [np.nan, 0.5])
def test_a_time_that_is_none_is_refused_as_a_time(time_s: float) -> None:
    filters, _ = predicted(BEST)
    with pytest.raises(ValueError, match="frames go forward in time"):
        filters.predict(time_s, TUMBLE.chaser_state(1.0))


def test_a_pose_far_off_a_sharp_state_leaves_the_paper_sane() -> None:
    """78 deg off, in a filter that has no gate: its covariance stays positive, its rate finite."""
    filters, _ = predicted(PAPER)
    pose = TUMBLE.state(1.0).cam_from_target(MOUNT)
    off = pose.perturbed([np.deg2rad(78.0), 0.0, 0.0], np.zeros(3))
    now = filters.update(Estimate(0, 1.0, PoseEstimate(off, GOOD, 1.0)))
    assert positive(now.rotation_covariance)
    assert positive(now.translation_covariance)
    speed_deg_s = np.rad2deg(np.linalg.norm(now.state.omega_target_wrt_lvlh_in_target))
    assert speed_deg_s < 78.0 + 1.0  # one second has gone by: no more than the turn itself
