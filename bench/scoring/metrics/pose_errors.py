"""What the pose errors of many frames come to: axis by axis, and against what is stated.

Every summary pools frames, and runs where there are several, and does not depend on their order.
An error is estimate minus truth (``models.pose.pose_error``). No frames, no number: ``None``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from models.arrays import Floats
from models.estimate import PoseEstimate
from models.pose import PoseError, RigidTransform, pose_error
from models.quantiles import chi_square_quantile

POSE_DOF = 6
NEES_CONFIDENCE = 0.95


@dataclass(frozen=True)
class AxisErrors:
    """Root mean square of pose errors along and about each axis.

    Attributes
    ----------
    position_rms_mm : list of 3 floats
        Of ``t_cam_from_target``, along the camera's x, y and z; a constant bias counts.
    euler_rms_deg : list of 3 floats
        Of the wrapped errors of (alpha, beta, gamma), passive 3-2-1.
    rotation_vector_rms_deg : list of 3 floats
        Of the turn ``R_estimate R_truth^T``, about the camera's x, y and z.
    """

    position_rms_mm: list[float] | None
    euler_rms_deg: list[float] | None
    rotation_vector_rms_deg: list[float] | None


@dataclass(frozen=True)
class Nees:
    """Whether the covariance that a pipeline states fits the errors that it makes.

    Attributes
    ----------
    mean : float
        Mean over frames of ``e^T P^-1 e / 6``: 1 when honest, above when overconfident.
    bounds : list of 2 floats
        Where that mean falls in 95 of 100 cases if the errors are independent from frame to frame
        and P is right: quantiles of chi-square with 6 n degrees of freedom, over 6 n.
    consistent : bool
        Whether it does.
    """

    mean: float | None
    bounds: list[float] | None
    consistent: bool | None


def root_mean_square(values: ArrayLike) -> list[float]:
    """Return the root mean square of each column of an (n, k) array."""
    table = np.asarray(values, dtype=np.float64)
    return [float(np.sqrt(np.mean(np.sort(column * column)))) for column in table.T]


def axis_errors(errors: Sequence[PoseError]) -> AxisErrors:
    """Summarise pose errors axis by axis."""
    if not errors:
        return AxisErrors(None, None, None)
    return AxisErrors(
        position_rms_mm=root_mean_square(1e3 * np.array([error.position_m for error in errors])),
        euler_rms_deg=root_mean_square([error.euler_deg for error in errors]),
        rotation_vector_rms_deg=root_mean_square([e.rotation_vector_deg for e in errors]),
    )


def error_vector(error: PoseError) -> Floats:
    """Return (6,): rotation vector in rad, then position in m, as covariances are ordered."""
    return np.concatenate([np.deg2rad(error.rotation_vector_deg), error.position_m])


def frame_nees(estimate: PoseEstimate, truth: RigidTransform) -> float | None:
    """Return the normalised estimation error squared ``e^T P^-1 e`` of one frame.

    Chi-square with six degrees of freedom for an honest covariance (Bar-Shalom, Li and Kirubarajan
    2001, section 5.4). None where none is stated, or it cannot be inverted.
    """
    if estimate.covariance is None:
        return None
    error = error_vector(pose_error(estimate.cam_from_target, truth))
    try:
        return float(error @ np.linalg.solve(estimate.covariance, error))
    except np.linalg.LinAlgError:
        return None


def consistency(nees: Sequence[float]) -> Nees:
    """Summarise the NEES of many frames."""
    if not nees:
        return Nees(None, None, None)
    dof = POSE_DOF * len(nees)
    tail = 0.5 * (1.0 - NEES_CONFIDENCE)
    low, high = (chi_square_quantile(p, dof) / dof for p in (tail, 1.0 - tail))
    mean = float(np.mean(np.sort(nees)) / POSE_DOF)
    return Nees(mean, [low, high], low <= mean <= high)
