"""Rigid transforms ``a_from_b``, the papers' Euler angles, and pose errors.

``x_in_a = a_from_b @ x_in_b``; ``a_from_c = a_from_b @ b_from_c``. Points are (3,) or (n, 3).
SciPy is loaded where it is needed: it takes 0.3 s, a tenth of a small frame's time.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import overload

import numpy as np
from numpy.typing import ArrayLike

from models.arrays import Floats

ORTHONORMAL_TOLERANCE = 2e-6  # a rotation typed with six decimals passes, a scaled one does not
EXACT = 1e-12  # long chains of products stay below it; what is above was typed, and is made exact


@dataclass(frozen=True, eq=False)
class RigidTransform:
    """A map ``a_from_b`` between right-handed frames.

    Attributes
    ----------
    rotation : (3, 3) array
        ``R_a_from_b``, a rotation matrix; one typed with a few digits is replaced by the nearest
        exact one, so that inverses and products hold.
    translation : (3,) array, m
        ``t_a_from_b``: the origin of b, in a.

    Raises
    ------
    ValueError
        If a shape is wrong, a value is not finite, or the matrix is not a rotation.
    """

    rotation: Floats
    translation: Floats

    def __post_init__(self) -> None:
        rotation = np.array(self.rotation, dtype=np.float64)
        translation = np.array(self.translation, dtype=np.float64)
        if rotation.shape != (3, 3) or translation.shape != (3,):
            raise ValueError(
                "expected a (3, 3) rotation and a (3,) translation, "
                f"got {rotation.shape} and {translation.shape}"
            )
        if not (np.isfinite(rotation).all() and np.isfinite(translation).all()):
            raise ValueError("expected a finite pose, got NaN or infinity in it")
        with np.errstate(over="ignore", invalid="ignore"):
            defect = float(np.abs(rotation @ rotation.T - np.eye(3)).max())
            determinant = np.linalg.det(rotation)
        if not defect <= ORTHONORMAL_TOLERANCE or determinant < 0:
            raise ValueError(
                f"expected a rotation matrix, got one with |R R^T - I| = {defect:.2g} "
                f"and determinant {determinant:.3g}"
            )
        if defect > EXACT:
            left, _, right = np.linalg.svd(rotation)
            rotation = left @ right  # the nearest rotation (Higham 1986)
        rotation.setflags(write=False)
        translation.setflags(write=False)
        object.__setattr__(self, "rotation", rotation)
        object.__setattr__(self, "translation", translation)

    @classmethod
    def identity(cls) -> RigidTransform:
        """Return the map that changes nothing."""
        return cls(np.eye(3), np.zeros(3))

    @classmethod
    def from_matrix(cls, matrix: ArrayLike) -> RigidTransform:
        """Read a homogeneous (4, 4) matrix."""
        matrix = np.asarray(matrix, dtype=np.float64)
        if matrix.shape != (4, 4):
            raise ValueError(f"expected a (4, 4) matrix, got {matrix.shape}")
        return cls(matrix[:3, :3], matrix[:3, 3])

    def matrix(self) -> Floats:
        """Return the homogeneous (4, 4) matrix."""
        matrix = np.eye(4)
        matrix[:3, :3] = self.rotation
        matrix[:3, 3] = self.translation
        return matrix

    def inverse(self) -> RigidTransform:
        """Return ``b_from_a``."""
        return RigidTransform(self.rotation.T, -self.rotation.T @ self.translation)

    @overload
    def __matmul__(self, other: RigidTransform) -> RigidTransform: ...
    @overload
    def __matmul__(self, other: Floats) -> Floats: ...
    def __matmul__(self, other: RigidTransform | Floats) -> RigidTransform | Floats:
        if isinstance(other, RigidTransform):
            return RigidTransform(
                self.rotation @ other.rotation, self.rotation @ other.translation + self.translation
            )
        points = np.asarray(other, dtype=np.float64)
        return points @ self.rotation.T + self.translation

    def rotate(self, directions: ArrayLike) -> Floats:
        """Turn directions, (3,) or (n, 3), from b into a; the origin does not matter to them."""
        return np.asarray(directions, dtype=np.float64) @ self.rotation.T

    def perturbed(self, rotation_vector: ArrayLike, translation: ArrayLike) -> RigidTransform:
        """Apply a small rotation vector (rad) and translation (m) on the left, both in a.

        The rotation turns the attitude only: ``R <- exp([w]x) R`` and ``t <- t + dt``. This is the
        convention of every (6, 6) covariance of the house, rotation first.
        """
        from scipy.spatial.transform import Rotation

        turn = Rotation.from_rotvec(np.asarray(rotation_vector, dtype=np.float64)).as_matrix()
        return RigidTransform(
            turn @ self.rotation, self.translation + np.asarray(translation, dtype=np.float64)
        )


def rotation_from_euler_321(euler_deg: ArrayLike) -> Floats:
    """Return ``R = R1(alpha) R2(beta) R3(gamma)``, the passive 3-2-1 matrix of the papers.

    Parameters
    ----------
    euler_deg : (3,) array, deg
        (alpha, beta, gamma), turns about x, y and z.

    Returns
    -------
    (3, 3) array

    References
    ----------
    Opromolla et al. 2022, equation 12, with its two misprinted signs put right.
    """
    from scipy.spatial.transform import Rotation

    alpha, beta, gamma = np.asarray(euler_deg, dtype=np.float64)
    return Rotation.from_euler("ZYX", [gamma, beta, alpha], degrees=True).as_matrix().T


def euler_321_from_rotation(rotation: ArrayLike) -> Floats:
    """Return (alpha, beta, gamma) in deg with ``R = R1(alpha) R2(beta) R3(gamma)``.

    alpha and gamma lie in (-180, 180], beta in [-90, 90]; at |beta| = 90 deg only alpha -+ gamma
    is defined and scipy warns.
    """
    from scipy.spatial.transform import Rotation

    matrix = np.asarray(rotation, dtype=np.float64)
    gamma, beta, alpha = Rotation.from_matrix(matrix.T).as_euler("ZYX", degrees=True)
    return np.array([alpha, beta, gamma])


def wrapped_deg(angle_deg: ArrayLike) -> Floats:
    """Bring angles in deg into [-180, 180).

    Parameters
    ----------
    angle_deg : (...,) array, deg

    Returns
    -------
    (...,) array, deg
    """
    return (np.asarray(angle_deg, dtype=np.float64) + 180.0) % 360.0 - 180.0


@dataclass(frozen=True)
class PoseError:
    """Estimate minus truth.

    Attributes
    ----------
    position_m : (3,) array, m
        Translation error in the camera's axes.
    euler_deg : (3,) array, deg
        Error of (alpha, beta, gamma), wrapped.
    rotation_vector_deg : (3,) array, deg
        The small turn ``R_estimate R_truth^T``, in the camera's axes.
    attitude_deg : float
        Its size.
    """

    position_m: Floats
    euler_deg: Floats
    rotation_vector_deg: Floats
    attitude_deg: float


def pose_error(estimate: RigidTransform, truth: RigidTransform) -> PoseError:
    """Compare two poses ``cam_from_target``."""
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_matrix(estimate.rotation @ truth.rotation.T)
    return PoseError(
        position_m=estimate.translation - truth.translation,
        euler_deg=wrapped_deg(
            euler_321_from_rotation(estimate.rotation) - euler_321_from_rotation(truth.rotation)
        ),
        rotation_vector_deg=turn.as_rotvec(degrees=True),
        attitude_deg=float(np.rad2deg(turn.magnitude())),
    )
