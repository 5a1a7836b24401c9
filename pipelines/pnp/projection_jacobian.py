"""Projection to normalised image coordinates, and its derivatives by the pose.

A pose is ``R = R_cam_from_target`` and ``t = t_cam_from_target``; a point projects to
``(X / Z, Y / Z)`` of ``R p + t`` (Opromolla et al. 2022, equations 11 and 12 put right).
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats


def project_normalised(rotation: Floats, translation: Floats, points_in_target: Floats) -> Floats:
    """Project points.

    Parameters
    ----------
    rotation : (3, 3) array
    translation : (3,) array, m
    points_in_target : (n, 3) array, m

    Returns
    -------
    (n, 2) array; NaN for points that are not in front of the camera.
    """
    points = points_in_target @ rotation.T + translation
    depth = np.where(points[:, 2:] > 0.0, points[:, 2:], np.nan)
    return points[:, :2] / depth


def jacobian_by_turn(rotation: Floats, translation: Floats, points_in_target: Floats) -> Floats:
    """Differentiate by a small left turn (rad) and a translation (m), both in camera axes.

    The perturbation is that of ``RigidTransform.perturbed``: ``R <- exp([w]x) R``, ``t <- t + dt``.

    Parameters
    ----------
    rotation : (3, 3) array
        ``R_cam_from_target``.
    translation : (3,) array, m
    points_in_target : (n, 3) array, m

    Returns
    -------
    (n, 2, 6) array, rotation first.
    """
    turned = points_in_target @ rotation.T
    points = turned + translation
    inverse_depth = 1.0 / points[:, 2]
    x, y = points[:, 0] * inverse_depth, points[:, 1] * inverse_depth

    jacobian = np.zeros((len(points), 2, 6))
    by_point = jacobian[:, :, 3:]
    by_point[:, 0, 0] = inverse_depth
    by_point[:, 1, 1] = inverse_depth
    by_point[:, 0, 2] = -x * inverse_depth
    by_point[:, 1, 2] = -y * inverse_depth
    # d(R p) = w x (R p), so each row a of the point's Jacobian becomes (R p) x a.
    q_x, q_y, q_z = turned[:, :1], turned[:, 1:2], turned[:, 2:]
    a_x, a_y, a_z = by_point[:, :, 0], by_point[:, :, 1], by_point[:, :, 2]
    jacobian[:, :, 0] = q_y * a_z - q_z * a_y
    jacobian[:, :, 1] = q_z * a_x - q_x * a_z
    jacobian[:, :, 2] = q_x * a_y - q_y * a_x
    return jacobian


def turn_from_euler_rates(euler_rad: Floats) -> Floats:
    """Return the (3, 3) matrix that maps small changes of (alpha, beta, gamma) to a left turn.

    With ``R = R1(alpha) R2(beta) R3(gamma)`` of passive turns, ``R_k(x) = exp(-x [e_k]x)``.
    """
    alpha, beta = euler_rad[0], euler_rad[1]
    sin_a, cos_a, sin_b, cos_b = np.sin(alpha), np.cos(alpha), np.sin(beta), np.cos(beta)
    return np.array(
        [
            [-1.0, 0.0, sin_b],
            [0.0, -cos_a, -sin_a * cos_b],
            [0.0, sin_a, -cos_a * cos_b],
        ]
    )
