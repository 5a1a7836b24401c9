from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.pose import (
    RigidTransform,
    euler_321_from_rotation,
    pose_error,
    rotation_from_euler_321,
    wrapped_deg,
)
from tests.support.strategies import rigid_transforms, vectors

ROUNDING_M = 1e-12  # a few hundred ulps of the 20 m poses drawn
ROUNDING = 1e-13  # of a rotation matrix's entries after two products
ROUNDING_DEG = 1e-9  # of angles away from beta = +-90 deg
GIMBAL_MARGIN_DEG = 1.0  # at beta = 89 deg the angles lose two digits, no more
LINEAR_SHARE = 1e-4  # what a first-order argument may miss at 1e-4 rad


def assert_same(a: RigidTransform, b: RigidTransform) -> None:
    np.testing.assert_allclose(a.rotation, b.rotation, atol=ROUNDING)
    np.testing.assert_allclose(a.translation, b.translation, atol=ROUNDING_M)


@given(rigid_transforms(), rigid_transforms(), rigid_transforms())
def test_transforms_compose_associatively(
    a: RigidTransform, b: RigidTransform, c: RigidTransform
) -> None:
    assert_same((a @ b) @ c, a @ (b @ c))


@given(rigid_transforms())
def test_the_inverse_undoes_from_both_sides(a: RigidTransform) -> None:
    assert_same(a @ a.inverse(), RigidTransform.identity())
    assert_same(a.inverse() @ a, RigidTransform.identity())


@given(rigid_transforms())
def test_the_identity_changes_nothing(a: RigidTransform) -> None:
    assert_same(a @ RigidTransform.identity(), a)
    assert_same(RigidTransform.identity() @ a, a)


@given(rigid_transforms(), rigid_transforms(), vectors(20.0))
def test_composing_is_applying_one_after_the_other(
    a: RigidTransform, b: RigidTransform, point: Floats
) -> None:
    np.testing.assert_allclose((a @ b) @ point, a @ (b @ point), atol=ROUNDING_M)


@given(rigid_transforms(), vectors(20.0), vectors(20.0))
def test_distances_and_handedness_survive(a: RigidTransform, p: Floats, q: Floats) -> None:
    before, after = np.linalg.norm(p - q), np.linalg.norm(a @ p - a @ q)
    assert after == pytest.approx(before, abs=ROUNDING_M)
    np.testing.assert_allclose(
        np.cross(a.rotate(p), a.rotate(q)), a.rotate(np.cross(p, q)), atol=1e3 * ROUNDING_M
    )  # products of two 20 m vectors round a thousand times coarser


@given(rigid_transforms())
def test_the_homogeneous_matrix_is_the_same_map(a: RigidTransform) -> None:
    point = np.array([0.3, -1.2, 4.0])
    np.testing.assert_allclose((a.matrix() @ [*point, 1.0])[:3], a @ point, atol=ROUNDING_M)
    back = RigidTransform.from_matrix(a.matrix())
    np.testing.assert_array_equal(back.rotation, a.rotation)
    np.testing.assert_array_equal(back.translation, a.translation)


def test_many_points_are_mapped_as_one_by_one() -> None:
    a = RigidTransform(rotation_from_euler_321([170.0, 20.0, -60.0]), np.array([1.0, 2.0, 3.0]))
    points = np.random.default_rng(0).normal(size=(7, 3))
    np.testing.assert_allclose(a @ points, [a @ p for p in points], atol=ROUNDING_M)
    np.testing.assert_allclose(a.rotate(points), a @ points - a.translation, atol=ROUNDING_M)


def test_the_name_tells_the_direction() -> None:
    """A camera 5 m above a target that faces it: the target's origin lies 5 m ahead."""
    cam_from_target = RigidTransform(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, 5.0]))
    np.testing.assert_array_equal(cam_from_target @ np.zeros(3), [0.0, 0.0, 5.0])
    np.testing.assert_array_equal(cam_from_target.inverse() @ np.zeros(3), [0.0, 0.0, 5.0])
    np.testing.assert_array_equal(cam_from_target @ np.array([0.0, 1.0, 1.0]), [0.0, -1.0, 4.0])


@pytest.mark.parametrize(
    ("rotation", "translation", "said"),
    [
        (np.eye(2), np.zeros(3), r"\(2, 2\)"),
        (np.eye(3), np.zeros(2), r"\(2,\)"),
        (np.eye(3), np.array([0.0, np.nan, 0.0]), "finite"),
        (1.1 * np.eye(3), np.zeros(3), "rotation matrix"),
        (np.diag([1.0, 1.0, -1.0]), np.zeros(3), "determinant -1"),
    ],
)
def test_what_is_no_pose_is_refused(rotation: Floats, translation: Floats, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        RigidTransform(rotation, translation)


def test_a_matrix_of_another_shape_is_refused() -> None:
    with pytest.raises(ValueError, match=r"expected a \(4, 4\) matrix, got \(3, 4\)"):
        RigidTransform.from_matrix(np.eye(4)[:3])


@given(rigid_transforms(), st.sampled_from([6, 7, 9]))
def test_a_rotation_typed_with_a_few_digits_is_made_exact(a: RigidTransform, digits: int) -> None:
    """What is accepted composes and inverts like any other, and is what was typed to its digits."""
    typed = np.round(a.rotation, digits)
    read = RigidTransform(typed, a.translation)
    assert np.abs(read.rotation - typed).max() < 2.0 * 10.0**-digits
    assert np.abs(read.rotation @ read.rotation.T - np.eye(3)).max() < ROUNDING
    assert_same(read.inverse() @ read, RigidTransform.identity())
    assert_same((read @ a) @ read.inverse(), read @ (a @ read.inverse()))


@given(rigid_transforms())
def test_an_exact_rotation_is_kept_to_the_bit(a: RigidTransform) -> None:
    np.testing.assert_array_equal(RigidTransform(a.rotation, a.translation).rotation, a.rotation)


def test_numbers_too_large_for_a_rotation_are_refused_quietly() -> None:
    with pytest.raises(ValueError, match="rotation matrix"):
        RigidTransform(1e300 * np.ones((3, 3)), np.zeros(3))


def test_a_pose_cannot_be_changed_from_outside() -> None:
    shift = np.zeros(3)
    a = RigidTransform(np.eye(3), shift)
    shift[0] = 9.0
    assert a.translation[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        a.translation[0] = 9.0


@given(
    st.floats(-180.0, 180.0),
    st.floats(-90.0 + GIMBAL_MARGIN_DEG, 90.0 - GIMBAL_MARGIN_DEG),
    st.floats(-180.0, 180.0),
)
def test_euler_angles_come_back(alpha: float, beta: float, gamma: float) -> None:
    back = euler_321_from_rotation(rotation_from_euler_321([alpha, beta, gamma]))
    difference = wrapped_deg(back - [alpha, beta, gamma])
    np.testing.assert_allclose(difference, 0.0, atol=ROUNDING_DEG)


@given(st.floats(-1e-6, 1e-6), st.floats(-5.0, 5.0), st.floats(-5.0, 5.0))
def test_euler_angles_come_back_across_the_seam_at_180_deg(
    beyond: float, beta: float, gamma: float
) -> None:
    """Facing the target, alpha is near 180 deg and jumps to -180 deg: only wrapped errors hold."""
    back = euler_321_from_rotation(rotation_from_euler_321([180.0 + beyond, beta, gamma]))
    difference = wrapped_deg(back - [180.0 + beyond, beta, gamma])
    np.testing.assert_allclose(difference, 0.0, atol=ROUNDING_DEG)


@given(vectors(180.0))
def test_the_matrix_is_the_product_of_three_passive_turns(euler_deg: Floats) -> None:
    """Opromolla et al. 2022, below equation 12: R = R1(alpha) R2(beta) R3(gamma)."""
    (sa, sb, sg), (ca, cb, cg) = np.sin(np.deg2rad(euler_deg)), np.cos(np.deg2rad(euler_deg))
    r1 = np.array([[1, 0, 0], [0, ca, sa], [0, -sa, ca]])
    r2 = np.array([[cb, 0, -sb], [0, 1, 0], [sb, 0, cb]])
    r3 = np.array([[cg, sg, 0], [-sg, cg, 0], [0, 0, 1]])
    np.testing.assert_allclose(rotation_from_euler_321(euler_deg), r1 @ r2 @ r3, atol=ROUNDING)


def test_gimbal_lock_is_warned_of() -> None:
    with pytest.warns(UserWarning, match="[Gg]imbal"):
        euler_321_from_rotation(rotation_from_euler_321([10.0, 90.0, 0.0]))


@given(st.floats(-1e4, 1e4))
def test_wrapping_keeps_the_angle_and_bounds_it(angle: float) -> None:
    wrapped = float(wrapped_deg(angle))
    assert -180.0 <= wrapped < 180.0
    turns = (angle - wrapped) / 360.0
    assert turns == pytest.approx(round(turns), abs=1e-12)  # 1e4 deg are 28 turns of 53 bits


def test_wrapping_at_the_seam() -> None:
    np.testing.assert_allclose(wrapped_deg([359.0, -359.0, 180.0, -180.0]), [-1, 1, -180, -180])


@given(rigid_transforms(), vectors(0.05), vectors(0.5))
def test_the_error_of_a_perturbed_pose_is_the_perturbation(
    truth: RigidTransform, turn: Floats, shift: Floats
) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # a drawn pose may sit at gimbal lock
        error = pose_error(truth.perturbed(turn, shift), truth)
    np.testing.assert_allclose(error.position_m, shift, atol=ROUNDING_M)
    np.testing.assert_allclose(error.rotation_vector_deg, np.rad2deg(turn), atol=ROUNDING_DEG)
    # The magnitude is a square root of squares: near zero it keeps half the digits.
    assert error.attitude_deg == pytest.approx(np.rad2deg(np.linalg.norm(turn)), abs=1e-6)


def test_a_perturbation_turns_the_attitude_and_not_the_translation() -> None:
    truth = RigidTransform(np.diag([1.0, -1.0, -1.0]), np.array([0.1, 0.2, 5.0]))
    turned = truth.perturbed([0.0, 0.0, 0.01], [0.0, 0.0, 0.0])
    np.testing.assert_array_equal(turned.translation, truth.translation)
    step = Rotation.from_rotvec([0.0, 0.0, 0.01]).as_matrix()
    np.testing.assert_allclose(turned.rotation, step @ truth.rotation, atol=ROUNDING)


def test_small_euler_errors_facing_the_target_are_turns_about_the_cameras_axes() -> None:
    """At R = diag(1, -1, -1), to first order: alpha about -x, beta about +y, gamma about +z."""
    truth = RigidTransform(rotation_from_euler_321([180.0, 0.0, 0.0]), np.array([0.0, 0.0, 5.0]))
    euler_error = np.array([0.004, -0.003, 0.005])
    estimate = RigidTransform(
        rotation_from_euler_321(np.array([180.0, 0.0, 0.0]) + euler_error), truth.translation
    )
    error = pose_error(estimate, truth)
    np.testing.assert_allclose(error.euler_deg, euler_error, atol=ROUNDING_DEG)
    expected = euler_error * [-1.0, 1.0, 1.0]
    np.testing.assert_allclose(error.rotation_vector_deg, expected, atol=LINEAR_SHARE * 0.005)


def test_errors_across_the_seam_are_small() -> None:
    estimate = RigidTransform(rotation_from_euler_321([-179.99, 0.0, 0.0]), np.zeros(3))
    truth = RigidTransform(rotation_from_euler_321([179.98, 0.0, 0.0]), np.zeros(3))
    error = pose_error(estimate, truth)
    assert error.euler_deg[0] == pytest.approx(0.03, abs=ROUNDING_DEG)
    assert error.attitude_deg == pytest.approx(0.03, abs=1e-6)
