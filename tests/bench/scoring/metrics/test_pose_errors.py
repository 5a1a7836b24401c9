"""Metrics argue from identities: the truth scores perfectly, a known error scores itself."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from bench.scoring.core_score import Sizes, core_score, sizes
from bench.scoring.metrics.pose_errors import axis_errors, consistency, frame_nees, root_mean_square
from models.estimate import PoseEstimate
from models.pose import PoseError, RigidTransform, pose_error, rotation_from_euler_321

rounding = 1e-9  # of numbers near one, in double precision, after a few trigonometric functions
FACING = RigidTransform(rotation_from_euler_321([179.0, 2.0, -3.0]), np.array([0.1, -0.2, 5.0]))


def position_mm(errors: list[PoseError]) -> Sizes:
    return sizes([1e3 * float(np.linalg.norm(error.position_m)) for error in errors])


def attitude_deg(errors: list[PoseError]) -> Sizes:
    return sizes([error.attitude_deg for error in errors])


def test_truth_scores_zero():
    errors = [pose_error(FACING, FACING)] * 3
    axes = axis_errors(errors)
    assert axes.position_rms_mm == [0.0, 0.0, 0.0]
    assert position_mm(errors).p95 == 0.0
    assert attitude_deg(errors).p95 == pytest.approx(0.0, abs=rounding)
    assert axes.euler_rms_deg == [0.0, 0.0, 0.0]


@given(st.floats(-179.0, 179.0), st.floats(-80.0, 80.0), st.floats(-179.0, 179.0))
def test_a_turn_of_one_degree_is_an_error_of_one_degree(alpha, beta, gamma):
    truth = RigidTransform(rotation_from_euler_321([alpha, beta, gamma]), FACING.translation)
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    turned = truth.perturbed(np.deg2rad(1.0) * axis, np.zeros(3))
    errors = [pose_error(turned, truth)]
    assert attitude_deg(errors).median == pytest.approx(1.0, abs=1e-7)
    about = axis_errors(errors).rotation_vector_rms_deg
    assert about == pytest.approx(np.abs(axis), abs=1e-7)


def test_an_alpha_that_passes_180_degrees_is_a_small_error():
    before = RigidTransform(rotation_from_euler_321([179.9, 0.0, 0.0]), FACING.translation)
    behind = RigidTransform(rotation_from_euler_321([-179.9, 0.0, 0.0]), FACING.translation)
    axes = axis_errors([pose_error(behind, before)])
    assert axes.euler_rms_deg == pytest.approx([0.2, 0.0, 0.0], abs=rounding)


def test_a_known_offset_is_its_own_score():
    moved = FACING.perturbed(np.zeros(3), [3e-3, -4e-3, 12e-3])
    errors = [pose_error(moved, FACING)]
    assert position_mm(errors).median == pytest.approx(13.0, abs=rounding)
    assert position_mm(errors).rms == pytest.approx(13.0, abs=rounding)
    along = axis_errors(errors).position_rms_mm
    assert along == pytest.approx([3.0, 4.0, 12.0], abs=rounding)


def test_sizes_are_those_of_what_is_there():
    """Against numbers counted by hand; what is absent, None or NaN, is left out."""
    assert sizes([3.0, None, 1.0, float("nan"), 2.0]).median == 2.0
    assert sizes([3.0, 4.0]).rms == pytest.approx(np.sqrt(12.5))
    assert sizes(list(range(101))).p95 == pytest.approx(95.0)


def test_rms_counts_a_bias():
    assert root_mean_square(np.full((5, 2), [2.0, -3.0])) == pytest.approx([2.0, 3.0])


def test_order_of_frames_changes_no_bit():
    rng = np.random.default_rng(5)
    errors = [
        pose_error(FACING.perturbed(1e-3 * rng.normal(size=3), rng.normal(size=3)), FACING)
        for _ in range(40)
    ]
    shuffled = [errors[k] for k in rng.permutation(40)]
    assert axis_errors(errors) == axis_errors(shuffled)
    assert position_mm(errors) == position_mm(shuffled)
    assert attitude_deg(errors) == attitude_deg(shuffled)


def test_no_frames_give_no_numbers():
    assert axis_errors([]).position_rms_mm is None
    assert sizes([None]) == Sizes(None, None, None)
    assert consistency([]).consistent is None
    core = core_score([[]], [])
    assert (core.frames, core.estimated, core.lost.count) == (0, 0, 0)
    assert core.attitude_error_deg.median is core.runtime_ms.p95 is None


def test_runtimes_are_median_and_percentile():
    assert core_score([[]], list(range(101))).runtime_ms.median == 50.0
    assert core_score([[]], list(range(101))).runtime_ms.p95 == pytest.approx(95.0)


def drawn_estimates(count: int, scale: float) -> list[PoseEstimate]:
    """Draw estimates whose errors have the covariance stated, times ``scale`` squared."""
    rng = np.random.default_rng(7)
    root = 1e-3 * np.tril(rng.normal(size=(6, 6))) + 2e-3 * np.eye(6)
    covariance = root @ root.T
    estimates = []
    for _ in range(count):
        error = scale * root @ rng.normal(size=6)
        pose = FACING.perturbed(error[:3], error[3:])
        estimates.append(PoseEstimate(pose, covariance))
    return estimates


@pytest.mark.parametrize(
    ("scale", "consistent"), [(1.0, True), (1.2, False), (0.8, False)], ids=str
)
def test_nees_knows_an_honest_covariance_from_a_boast(scale, consistent):
    """With 500 frames the 95 % interval is about +-5 %; 20 % in sigma is 44 % in NEES."""
    nees = consistency([frame_nees(e, FACING) for e in drawn_estimates(500, scale)])
    assert nees.consistent is consistent
    assert nees.bounds == pytest.approx([0.95, 1.05], abs=0.01)
    assert nees.mean == pytest.approx(scale**2, rel=0.06)


def test_nees_bounds_hold_95_times_in_100():
    """Coverage over 300 trials of 20 frames: binomial, sd 1.3 %, so within 4 %."""
    rng = np.random.default_rng(11)
    inside = [consistency(list(rng.chisquare(6, 20))).consistent for _ in range(300)]
    assert np.mean(inside) == pytest.approx(0.95, abs=0.04)


def test_a_singular_covariance_has_no_nees():
    assert frame_nees(PoseEstimate(FACING, np.zeros((6, 6))), FACING) is None


def test_no_covariance_has_no_nees():
    assert frame_nees(PoseEstimate(FACING), FACING) is None


def test_rotation_errors_are_about_the_cameras_axes():
    turn = Rotation.from_rotvec([0.0, 0.0, 0.5], degrees=True).as_matrix()
    rolled = RigidTransform(turn @ FACING.rotation, FACING.translation)
    axes = axis_errors([pose_error(rolled, FACING)])
    assert axes.rotation_vector_rms_deg == pytest.approx([0.0, 0.0, 0.5], abs=rounding)
