"""Quaternions in bulk against SciPy's rotations."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.navigation_records import coned_turn
from models.quaternions import (
    conjugate,
    from_rotation_vector,
    mean_quaternion,
    multiplied,
    rotated,
    to_rotation_vector,
)

ROUNDING = 1e-12
vectors = st.lists(st.floats(-1.7, 1.7), min_size=3, max_size=3).map(np.array)


def scipys(rotation: Rotation) -> np.ndarray:
    return rotation.as_quat(scalar_first=True)


@given(vectors, vectors)
def test_products_and_turns_are_scipys(first, second):
    one, two = Rotation.from_rotvec(first), Rotation.from_rotvec(second)
    a, b = from_rotation_vector(first), from_rotation_vector(second)
    assert a == pytest.approx(scipys(one), abs=ROUNDING)
    product = multiplied(a, b)
    expected = scipys(one * two)
    assert product * np.sign(product @ expected) == pytest.approx(expected, abs=ROUNDING)
    assert rotated(a, second) == pytest.approx(one.apply(second), abs=ROUNDING)
    assert multiplied(a, conjugate(a)) == pytest.approx([1, 0, 0, 0], abs=ROUNDING)


@given(vectors)
def test_a_rotation_vector_comes_back(vector):
    assert to_rotation_vector(from_rotation_vector(vector)) == pytest.approx(vector, abs=1e-10)
    assert to_rotation_vector(-from_rotation_vector(vector)) == pytest.approx(vector, abs=1e-10)


def test_the_mean_is_scipys_and_takes_negative_weights():
    rng = np.random.default_rng(4)
    turns = Rotation.from_rotvec(0.2 * rng.standard_normal((9, 3)))
    weights = rng.uniform(0.1, 1.0, 9)
    quaternions = scipys(turns) * np.where(rng.random(9) < 0.5, -1.0, 1.0)[:, None]
    mean = mean_quaternion(quaternions, weights)
    expected = scipys(turns.mean(weights))
    assert mean * np.sign(mean @ expected) == pytest.approx(expected, abs=ROUNDING)
    one = mean_quaternion(quaternions[:2], np.array([2.0, -0.5]))
    assert np.linalg.norm(one) == pytest.approx(1.0)


def test_coned_samples_are_the_product_of_their_turns():
    """Twenty samples of a body that cones at a degree per second; a plain sum is far worse."""
    times_s = 0.01 * np.arange(20)
    rate = np.deg2rad(1.0)
    increments = (
        0.01 * rate * np.stack([np.cos(20 * times_s), np.sin(20 * times_s), np.ones(20)], axis=1)
    )
    exact = Rotation.identity()
    for each in increments:
        exact = exact * Rotation.from_rotvec(each)
    assert coned_turn(increments) == pytest.approx(exact.as_rotvec(), abs=3e-9)
    assert np.abs(increments.sum(axis=0) - exact.as_rotvec()).max() > 1e-7
