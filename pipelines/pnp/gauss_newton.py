"""Gauss-Newton for many poses at once, all points of one worth: cheap, near the minimum.

Where points have weights of their own, or the start is far, ``levenberg_marquardt`` serves.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Mask

LEAST_DEPTH_M = 1e-3
LARGEST_TURN = 1.0  # rad: beyond it the linearisation means nothing


def turned_by(rotations: Floats, turns: Floats) -> Floats:
    """Apply small left turns (b, 3), rad, to rotations (b, 3, 3): Rodrigues' formula."""
    angle2 = np.einsum("bi,bi->b", turns, turns)
    angle = np.sqrt(angle2)
    small = angle < 1e-4
    safe = np.where(small, 1.0, angle)
    first = np.where(small, 1.0 - angle2 / 6.0, np.sin(safe) / safe)
    second = np.where(small, 0.5 - angle2 / 24.0, (1.0 - np.cos(safe)) / (safe * safe))
    x, y, z = turns.T
    cross = np.zeros((len(turns), 3, 3))
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -z, y, -x
    cross[:, 1, 0], cross[:, 2, 0], cross[:, 2, 1] = z, -y, x
    matrix = first[:, None, None] * cross + second[:, None, None] * (cross @ cross)
    matrix += np.eye(3)
    return matrix @ rotations


def linearised(
    rotations: Floats, translations: Floats, points_in_target: Floats
) -> tuple[Floats, Floats]:
    """Project points by many poses, with the derivatives.

    Parameters
    ----------
    rotations : (b, 3, 3) array
    translations : (b, 3) array, m
    points_in_target : (m, 3) array, m
        The same for all poses, or (b, m, 3): each has its own.

    Returns
    -------
    predicted : (b, 2, m) array
        Normalised coordinates; points behind the camera are held in front of it.
    jacobian : (b, 6, 2, m) array
        By a left turn and a translation, as ``RigidTransform.perturbed`` applies them.
    """
    turned = rotations @ points_in_target.swapaxes(-1, -2)
    in_cam = turned + translations[:, :, None]
    inverse = 1.0 / np.maximum(in_cam[:, 2], LEAST_DEPTH_M)
    predicted = in_cam[:, :2] * inverse[:, None]
    x, y = predicted[:, 0], predicted[:, 1]
    jacobian = np.zeros((len(rotations), 6, 2, points_in_target.shape[-2]))
    jacobian[:, 3, 0] = inverse
    jacobian[:, 4, 1] = inverse
    np.multiply(x, inverse, out=jacobian[:, 5, 0])
    np.multiply(y, inverse, out=jacobian[:, 5, 1])
    np.negative(jacobian[:, 5], out=jacobian[:, 5])
    # d(R p) = w x (R p): each row a of the point's Jacobian becomes (R p) x a.
    q_x, q_y, q_z = (turned * inverse[:, None]).transpose(1, 0, 2)
    jacobian[:, 0, 0] = -q_y * x
    jacobian[:, 1, 0] = q_z + q_x * x
    jacobian[:, 2, 0] = -q_y
    jacobian[:, 0, 1] = -q_z - q_y * y
    jacobian[:, 1, 1] = q_x * y
    jacobian[:, 2, 1] = q_x
    return predicted, jacobian


def gauss_newton_step(
    rotations: Floats,
    translations: Floats,
    linear: tuple[Floats, Floats],
    observed: Floats,
    weights: Floats,
) -> tuple[Floats, Floats, Mask]:
    """Take one step for each of many poses.

    Parameters
    ----------
    rotations : (b, 3, 3) array
    translations : (b, 3) array, m
    linear : (b, 2, m) and (b, 6, 2, m) arrays
        What ``linearised`` returns at these poses.
    observed : (b, 2, m) array
        Undistorted normalised coordinates of the point that each pose matches with a landmark;
        anything finite where the weight is zero.
    weights : (b, m) array

    Returns
    -------
    rotations : (b, 3, 3) array
    translations : (b, 3) array, m
    moved : (b,) array of bool
        False where the points do not determine a step; the pose is then left as it was.
    """
    predicted, jacobian = linear
    count, _, _, known = jacobian.shape
    flat = jacobian.reshape(count, 6, 2 * known)
    weighted = (jacobian * weights[:, None, None, :]).reshape(count, 6, 2 * known)
    residuals = (observed - predicted).reshape(count, 2 * known, 1)
    hessian = weighted @ flat.transpose(0, 2, 1)
    gradient = weighted @ residuals
    scale = np.einsum("bii->bi", hessian)
    hessian[:, range(6), range(6)] += 1e-12 * scale + 1e-15
    step: Floats = np.asarray(np.linalg.solve(hessian, gradient)[:, :, 0], dtype=np.float64)
    moved = np.isfinite(step).all(axis=1) & (np.abs(step[:, :3]).max(axis=1) < LARGEST_TURN)
    step[~moved] = 0.0
    return turned_by(rotations, step[:, :3]), translations + step[:, 3:], moved
