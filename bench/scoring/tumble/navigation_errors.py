"""How wrong one estimate of an uncooperative target is: raw pose, filtered state, and consistency.

Errors are sizes: of the position error (Pesce et al. 2019, equation 15), of the turn between
estimated and true attitude (equation 16, taken as a rotation's magnitude, which does not lose its
digits near zero), of the velocity error in the local frame, and of the rate error in target axes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.estimate import Estimate
from models.motion.relative_state import ROTATION, TRANSLATION, RelativeState, relative_state
from models.pose import RigidTransform

NONE = float("nan")


@dataclass(frozen=True)
class NavigationError:
    """The errors of one frame; NaN where there is nothing to judge.

    Attributes
    ----------
    raw_position_m, raw_attitude_deg : float
        Of the pose from this image alone.
    position_m, attitude_deg, velocity_m_s, rate_deg_s : float
        Of the filtered state.
    sigma_position_m, sigma_attitude_deg : float
        Root of the trace of what the filter states of position and attitude.
    nees_translation, nees_rotation : float
        ``e' P^-1 e``, six degrees of freedom each.
    nis_translation, nis_rotation : float
        The innovation's, three degrees of freedom each.
    """

    raw_position_m: float
    raw_attitude_deg: float
    position_m: float
    attitude_deg: float
    velocity_m_s: float
    rate_deg_s: float
    sigma_position_m: float
    sigma_attitude_deg: float
    nees_translation: float
    nees_rotation: float
    nis_translation: float
    nis_rotation: float

    def row(self) -> tuple[float, ...]:
        """Return the numbers in the order above."""
        return astuple(self)


def navigation_error(
    estimate: Estimate,
    truth: RelativeState,
    cam_from_lvlh: RigidTransform,
    true_cam_from_target: RigidTransform | None = None,
) -> NavigationError:
    """Hold one estimate against the truth of its instant.

    Parameters
    ----------
    estimate : Estimate
    truth : RelativeState
    cam_from_lvlh : RigidTransform
        The mount, as told.
    true_cam_from_target : RigidTransform, optional
        The true pose; where it is left out, the mount is taken to be true.
    """
    raw_position, raw_attitude = NONE, NONE
    if estimate.pose is not None:
        true_pose = true_cam_from_target or truth.cam_from_target(cam_from_lvlh)
        raw_position, raw_attitude = pose_error_sizes(estimate.pose.cam_from_target, true_pose)
    state = relative_state(estimate)
    if state is None:
        return NavigationError(raw_position, raw_attitude, *([NONE] * 10))
    translation = translation_error(state, truth)
    rotation = rotation_error(state, truth)
    stated = estimate.states[TRANSLATION].covariance, estimate.states[ROTATION].covariance
    nis = innovation_nis(estimate, cam_from_lvlh)
    return NavigationError(
        raw_position,
        raw_attitude,
        float(np.linalg.norm(translation[:3])),
        float(np.rad2deg(np.linalg.norm(rotation[:3]))),
        float(np.linalg.norm(translation[3:])),
        float(np.rad2deg(np.linalg.norm(rotation[3:]))),
        _root_trace(stated[0]),
        float(np.rad2deg(_root_trace(stated[1]))),
        normalised_square(translation, stated[0]),
        normalised_square(rotation, stated[1]),
        *nis,
    )


def pose_error_sizes(estimate: RigidTransform, truth: RigidTransform) -> tuple[float, float]:
    """Return the size of a pose's position error, m, and of its attitude error, deg.

    Unlike ``models.pose.pose_error`` it takes no Euler angles, which a tumble brings to their pole.
    """
    moved = float(np.linalg.norm(estimate.translation - truth.translation))
    turned = Rotation.from_matrix(estimate.rotation @ truth.rotation.T).magnitude()
    return moved, float(np.rad2deg(turned))


def symmetric_attitude_deg(
    estimate: RigidTransform, truth: RigidTransform, symmetries: Sequence[Floats]
) -> float:
    """Return the attitude error up to the target's symmetries, deg.

    Parameters
    ----------
    estimate, truth : RigidTransform
        ``cam_from_target``.
    symmetries : sequence of (3, 3) arrays
        As ``Wireframe`` has them.
    """
    turns = np.array([truth.rotation @ own for own in (np.eye(3), *symmetries)])
    sizes = Rotation.from_matrix(estimate.rotation @ turns.swapaxes(1, 2)).magnitude()
    return float(np.rad2deg(np.min(sizes)))


def translation_error(state: RelativeState, truth: RelativeState) -> Floats:
    """Return (6,): truth minus estimate of (rho, rho_dot), m and m/s."""
    return np.concatenate(
        [truth.rho_in_lvlh - state.rho_in_lvlh, truth.rho_dot_in_lvlh - state.rho_dot_in_lvlh]
    )


def rotation_error(state: RelativeState, truth: RelativeState) -> Floats:
    """Return (6,): the turn that makes the estimate true, and truth minus estimate of the rate.

    In target axes, rad and rad/s: ``R_true = R exp([turn]x)``.
    """
    turn = Rotation.from_matrix(state.R_lvlh_from_target.T @ truth.R_lvlh_from_target).as_rotvec()
    rate = truth.omega_target_wrt_lvlh_in_target - state.omega_target_wrt_lvlh_in_target
    return np.concatenate([turn, rate])


def innovation_nis(estimate: Estimate, cam_from_lvlh: RigidTransform) -> tuple[float, float]:
    """Return the NIS of translation and of rotation, from what stands in the estimate alone.

    A filter that has taken a measurement z of covariance R leaves a residual ``z - H x`` of
    covariance ``R - H P H'``, P being the covariance after; for the gain of a Kalman filter the
    square of that residual over that covariance is the innovation's square over its own
    (Bar-Shalom, Li and Kirubarajan 2001, section 5.2: residual ``= R S^-1 innovation``). NaN where
    there was no pose to take, or the pose's covariance is not what the filter took for it.
    """
    pose, state = estimate.pose, relative_state(estimate)
    if pose is None or pose.covariance is None or state is None or estimate.mode == "predicted":
        return NONE, NONE
    translation = estimate.states[TRANSLATION].covariance
    rotation = estimate.states[ROTATION].covariance
    if translation is None or rotation is None:
        return NONE, NONE
    lvlh_from_target = cam_from_lvlh.inverse() @ pose.cam_from_target
    R_lvlh_from_cam = cam_from_lvlh.rotation.T
    R_target_from_cam = pose.cam_from_target.rotation.T
    moved = lvlh_from_target.translation - state.rho_in_lvlh
    turned = Rotation.from_matrix(state.R_lvlh_from_target.T @ lvlh_from_target.rotation)
    position = R_lvlh_from_cam @ pose.covariance[3:, 3:] @ R_lvlh_from_cam.T
    attitude = R_target_from_cam @ pose.covariance[:3, :3] @ R_target_from_cam.T
    return (
        normalised_square(moved, position - translation[:3, :3]),
        normalised_square(turned.as_rotvec(), attitude - rotation[:3, :3]),
    )


def normalised_square(error: Floats, covariance: Floats | None) -> float:
    """Return ``e' P^-1 e``.

    Parameters
    ----------
    error : (n,) array
    covariance : (n, n) array or None
        In the squares of the error's units.

    Returns
    -------
    float
        NaN where the covariance is absent or not positive definite.
    """
    if covariance is None:
        return NONE
    try:
        whitened = np.linalg.solve(np.linalg.cholesky(covariance), error)
    except np.linalg.LinAlgError:
        return NONE
    return float(whitened @ whitened)


def _root_trace(covariance: Floats | None) -> float:
    return NONE if covariance is None else float(np.sqrt(np.trace(covariance[:3, :3])))
