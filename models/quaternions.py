"""Quaternions in bulk, scalar first: many at once, where a ``Rotation`` object each is too slow.

``q_a_from_b`` turns b-coordinates into a: ``multiplied(q_a_from_b, q_b_from_c)`` is ``q_a_from_c``.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats


def multiplied(first: Floats, second: Floats) -> Floats:
    """Return Hamilton's product of quaternions, (..., 4) each."""
    w, x, y, z = (first[..., k] for k in range(4))
    a, b, c, d = (second[..., k] for k in range(4))
    return np.stack(
        [
            w * a - x * b - y * c - z * d,
            w * b + x * a + y * d - z * c,
            w * c - x * d + y * a + z * b,
            w * d + x * c - y * b + z * a,
        ],
        axis=-1,
    )


def conjugate(quaternion: Floats) -> Floats:
    """Return the inverse of unit quaternions, (..., 4)."""
    return quaternion * np.array([1.0, -1.0, -1.0, -1.0])


def from_rotation_vector(rotation_vector: Floats) -> Floats:
    """Return the quaternions, (..., 4), of rotation vectors, (..., 3), rad."""
    angle = np.sqrt(np.sum(rotation_vector * rotation_vector, axis=-1, keepdims=True))
    half = 0.5 * np.sinc(angle / (2.0 * np.pi))
    return np.concatenate([np.cos(0.5 * angle), half * rotation_vector], axis=-1)


def to_rotation_vector(quaternion: Floats) -> Floats:
    """Return rotation vectors, (..., 3), rad, of unit quaternions, (..., 4)."""
    positive = np.where(quaternion[..., :1] < 0.0, -quaternion, quaternion)
    sine = np.sqrt(np.sum(positive[..., 1:] ** 2, axis=-1, keepdims=True))
    angle = 2.0 * np.arctan2(sine, positive[..., :1])
    return positive[..., 1:] * np.where(sine > 1e-12, angle / np.maximum(sine, 1e-300), 2.0)


def rotated(quaternion: Floats, vector: Floats) -> Floats:
    """Return vectors, (..., 3), turned by unit quaternions, (..., 4)."""
    axis = quaternion[..., 1:]
    once = 2.0 * np.cross(axis, vector)
    return vector + quaternion[..., :1] * once + np.cross(axis, once)


def mean_quaternion(quaternions: Floats, weights: Floats) -> Floats:
    """Return the weighted mean of unit quaternions over the last axis but one, (..., 4).

    Parameters
    ----------
    quaternions : (..., n, 4) array
    weights : (n,) array
        Their sum is positive; single ones may be negative.

    References
    ----------
    F. L. Markley, Y. Cheng, J. L. Crassidis and Y. Oshman, Averaging quaternions, JGCD 30 (2007):
    the eigenvector of the largest eigenvalue of the weighted sum of outer products.
    """
    outer = np.swapaxes(quaternions * weights[:, None], -1, -2) @ quaternions
    mean = np.linalg.eigh(outer)[1][..., -1]
    return np.where(np.sum(mean * quaternions[..., 0, :], axis=-1)[..., None] < 0.0, -mean, mean)
