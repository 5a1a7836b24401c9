"""Levenberg-Marquardt for the pose: the paper's rule for the damping, and Gavin's.

Sources: Opromolla et al. 2022, equations 9 to 14 and Table 2; Gavin 2020, "The Levenberg-Marquardt
algorithm for nonlinear least squares curve-fitting problems". The paper moves lambda the wrong
way round (up on success); with its lambda0 of 1e-8 both start as Gauss-Newton and agree.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.pose import RigidTransform, euler_321_from_rotation, rotation_from_euler_321
from pipelines.pnp.problem import PnpProblem
from pipelines.pnp.projection_jacobian import turn_from_euler_rates
from pipelines.pnp.solver_options import LevenbergMarquardtOptions, Parametrisation

StopReason: TypeAlias = Literal["gradient", "step", "chi2", "iterations", "singular"]

LAMBDA_MIN, LAMBDA_MAX = 1e-12, 1e7  # Gavin's limits; the lower one lets lambda0 = 1e-8 pass
ROUNDING = 1e-13  # relative, of a sum of squares in double precision
ZERO_ANGLE = 1e-12  # keeps the relative update finite where an angle crosses zero


@dataclass(frozen=True, eq=False)
class LevenbergMarquardtResult:
    """Where the iteration ended.

    Attributes
    ----------
    pose : RigidTransform
        ``cam_from_target``.
    chi2 : float
        Sum of squared whitened residuals; infinite if a point is behind the camera.
    iterations : int
    stopped_by : str
        Which condition of Table 2 ended it.
    """

    pose: RigidTransform
    chi2: float
    iterations: int
    stopped_by: StopReason


@dataclass(frozen=True, eq=False)
class _State:
    """A pose on its way, with the angles where they are the parameters."""

    rotation: Floats
    translation: Floats
    euler_rad: Floats | None

    @classmethod
    def start(cls, pose: RigidTransform, parametrisation: Parametrisation) -> _State:
        euler = None
        if parametrisation == "euler_321":
            euler = np.deg2rad(euler_321_from_rotation(pose.rotation))
        return cls(np.array(pose.rotation), np.array(pose.translation), euler)

    def moved(self, step: Floats) -> _State:
        """Update: by addition (equation 13), or by a left turn."""
        translation = self.translation + step[3:]
        if self.euler_rad is None:
            turn = Rotation.from_rotvec(step[:3]).as_matrix()
            return _State(turn @ self.rotation, translation, None)
        euler = self.euler_rad + step[:3]
        return _State(rotation_from_euler_321(np.rad2deg(euler)), translation, euler)

    def jacobian(self, problem: PnpProblem) -> Floats:
        jacobian = problem.jacobian(self.rotation, self.translation)
        if self.euler_rad is not None:
            jacobian[:, :3] = jacobian[:, :3] @ turn_from_euler_rates(self.euler_rad)
        return jacobian

    def magnitudes(self) -> Floats:
        """Return what an update is measured against, (6,)."""
        if self.euler_rad is None:
            return np.array([1.0, 1.0, 1.0, *3 * [float(np.linalg.norm(self.translation))]])
        return np.abs(np.concatenate([self.euler_rad, self.translation])) + ZERO_ANGLE


def _chi2(residuals: Floats) -> float:
    total = float(np.sum(residuals**2))
    return total if np.isfinite(total) else np.inf


def _damped_step(hessian: Floats, gradient: Floats, damping: float) -> Floats | None:
    """Equation 14; None where it has no finite solution."""
    try:
        damped = hessian + damping * np.diag(np.diag(hessian))
        step: Floats = np.linalg.solve(damped, gradient).astype(np.float64)
    except np.linalg.LinAlgError:
        return None
    # Beyond a turn of one radian or a kilometre the linearisation means nothing.
    sane = np.isfinite(step).all() and np.abs(step[:3]).max() < np.pi
    return step if sane and np.abs(step[3:]).max() < 1e3 else None


def solve_pose(
    problem: PnpProblem, start: RigidTransform, options: LevenbergMarquardtOptions
) -> LevenbergMarquardtResult:
    """Minimise the squared reprojection error from a guess.

    Parameters
    ----------
    problem : PnpProblem
        At least three matches that are not in a line.
    start : RigidTransform
        ``cam_from_target``, with every matched point in front of the camera.
    options : LevenbergMarquardtOptions

    Returns
    -------
    LevenbergMarquardtResult
        The best pose met; it never raises, look at ``chi2`` and ``stopped_by``.
    """
    paper = options.lambda_rule == "paper"
    # A step that made things better divides (Gavin) or multiplies (paper) the damping.
    after_success = options.lambda_up if paper else 1.0 / options.lambda_down
    after_failure = 1.0 / options.lambda_down if paper else options.lambda_up

    state = _State.start(start, options.parametrisation)
    residuals = problem.residuals(state.rotation, state.translation)
    chi2, damping = _chi2(residuals), options.lambda0
    freedom = max(2 * len(problem) - 6, 1)
    stopped_by: StopReason = "iterations"
    iteration = 0
    hessian = gradient = np.zeros(0)
    fresh = True
    if not np.isfinite(chi2):
        return LevenbergMarquardtResult(start, chi2, 0, "singular")

    while iteration < options.max_iterations:
        iteration += 1
        if fresh:
            jacobian = state.jacobian(problem)
            hessian, gradient = jacobian.T @ jacobian, jacobian.T @ residuals.reshape(-1)
            fresh = False
        if np.abs(gradient).max() < options.eps1:
            stopped_by = "gradient"
            break
        step = _damped_step(hessian, gradient, damping)
        if step is None:
            if paper or damping >= LAMBDA_MAX:
                stopped_by = "singular"
                break
            damping = max(damping * options.lambda_up, 1e-6)
            continue

        candidate = state.moved(step)
        new_residuals = problem.residuals(candidate.rotation, candidate.translation)
        new_chi2 = _chi2(new_residuals)
        decrease = chi2 - new_chi2
        small_step = bool(np.max(np.abs(step) / state.magnitudes()) < options.eps2)
        success = decrease > options.eps0
        if not paper:
            predicted = float(step @ (damping * np.diag(hessian) * step + gradient))
            success = predicted > 0.0 and decrease > options.eps0 * predicted
            # What is left to gain drowns in rounding: neither chi2 nor lambda can tell any more.
            small_step = small_step or predicted < ROUNDING * chi2
        if success:
            state, residuals, chi2 = candidate, new_residuals, new_chi2
            fresh = True
        damping *= after_success if success else after_failure
        damping = float(np.clip(damping, LAMBDA_MIN, LAMBDA_MAX))
        if small_step:
            stopped_by = "step"
            break
        if chi2 / freedom < options.eps3:
            stopped_by = "chi2"
            break

    pose = RigidTransform(state.rotation, state.translation)
    return LevenbergMarquardtResult(pose, chi2, iteration, stopped_by)
