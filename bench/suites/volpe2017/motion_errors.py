"""How wrong an estimate of an unknown target is, number by number."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.motion.boresight_pointing import HILL_FROM_LVLH
from models.motion.watched_tumble import WatchedState
from models.spacecraft.simple_target import inertia_kg_m2
from pipelines.unknown_target.target_estimate import TargetEstimate

ENTRIES = ([0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2])  # 11, 22, 33, 12, 13, 23
MOTION_DOF = 12
COLUMNS = (
    "position_m_1", "position_m_2", "position_m_3",
    "velocity_m_s_1", "velocity_m_s_2", "velocity_m_s_3",
    "attitude_deg_1", "attitude_deg_2", "attitude_deg_3",
    "rate_deg_s_1", "rate_deg_s_2", "rate_deg_s_3",
    "first_from_chaser_m_1", "first_from_chaser_m_2", "first_from_chaser_m_3",
    "first_from_centre_m_1", "first_from_centre_m_2", "first_from_centre_m_3",
    "inertia_percent_1", "inertia_percent_2", "inertia_percent_3",
    "inertia_percent_4", "inertia_percent_5", "inertia_percent_6",
    "inertia_kg_m2_1", "inertia_kg_m2_2", "inertia_kg_m2_3",
    "inertia_kg_m2_4", "inertia_kg_m2_5", "inertia_kg_m2_6",
    "shape_m", "shape_scaled_m", "points", "scale", "nees_motion",
    "sigma_position_m", "sigma_velocity_m_s", "sigma_attitude_deg", "sigma_rate_deg_s",
    "lost_inertia_ratios", "scale_lost",
)  # fmt: skip
"""Of one frame. 1, 2, 3 are the paper's Hill axes, body axes or camera axes, as the quantity has;
``shape_m`` is the root mean square distance of points, ``shape_scaled_m`` the same after the
estimate was scaled as the distance to the target wants; ``inertia_percent`` is of the trace."""


def motion_errors(known: TargetEstimate, truth: WatchedState, points: Floats) -> Floats:
    """Return the errors of one frame, (columns,) as ``COLUMNS``; NaN for what is not told.

    Parameters
    ----------
    known : TargetEstimate
    truth : WatchedState
    points : (n, 3) array, m
        The true ones, by name of the track.
    """
    position = known.rho_in_lvlh - truth.rho_in_lvlh
    velocity = known.rho_dot_in_lvlh - truth.rho_dot_in_lvlh
    pose = truth.cam_from_target
    turn = Rotation.from_matrix(pose.rotation.T @ known.R_cam_from_target).as_rotvec()
    rate = known.omega_in_target - truth.omega_in_target
    whole = np.concatenate([position, velocity, turn, rate])
    spread = _root_sizes(known.covariance)
    true_inertia = inertia_kg_m2()
    ratio = (known.inertia - true_inertia / np.trace(true_inertia))[ENTRIES]
    inertia = np.full(6, np.nan)
    if known.inertia_kg_m2 is not None:
        inertia = (known.inertia_kg_m2 - true_inertia)[ENTRIES]
    names = list(known.names)
    own, theirs = known.points_in_target, points[names]
    scale = float(known.rho_in_lvlh @ truth.rho_in_lvlh / (truth.rho_in_lvlh @ truth.rho_in_lvlh))
    first = np.full((2, 3), np.nan)
    if 0 in names:
        there = own[names.index(0)]
        origin = -truth.R_cam_from_lvlh @ known.rho_in_lvlh
        first[0] = known.R_cam_from_target @ there + origin - (pose @ points[0])
        first[1] = there - points[0]
    return np.concatenate(
        [
            HILL_FROM_LVLH @ position,
            HILL_FROM_LVLH @ velocity,
            np.rad2deg(turn),
            np.rad2deg(rate),
            first.ravel(),
            100.0 * ratio,
            inertia,
            [
                _distance(own, theirs),
                _distance(own / scale, theirs),
                len(names),
                scale,
                _nees(whole, known.covariance),
                spread[0],
                spread[1],
                np.rad2deg(spread[2]),
                np.rad2deg(spread[3]),
                np.nan if known.lost_inertia_ratios is None else known.lost_inertia_ratios,
                np.nan if known.scale_lost is None else known.scale_lost,
            ],
        ]
    )


def _root_sizes(covariance: Floats) -> Floats:
    """Return the roots of the traces of the four blocks, (4,)."""
    variances = np.maximum(np.diag(covariance), 0.0).reshape(4, 3)
    return np.asarray(np.sqrt(variances.sum(axis=1)))


def _distance(own: Floats, theirs: Floats) -> float:
    if len(own) == 0:
        return float(np.nan)
    return float(np.sqrt(np.mean(np.sum((own - theirs) ** 2, axis=1))))


def _nees(error: Floats, covariance: Floats) -> float:
    scale = np.sqrt(np.maximum(np.diag(covariance), np.finfo(float).tiny))
    scaled = covariance / np.outer(scale, scale)
    try:
        root = np.linalg.solve(np.linalg.cholesky(scaled), error / scale)
    except np.linalg.LinAlgError:
        return float(np.nan)
    return float(root @ root)
