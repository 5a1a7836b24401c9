"""Levenberg-Marquardt for many small problems at once: a hundred runs of a frame, a study's poses.

The iteration is that of ``levenberg_marquardt`` with Gavin's rule and a left turn, each problem
with a damping of its own. Problems lie along the last axis of every array, so that a step is some
hundred operations on long vectors, whatever the number of problems; those that are done drop out.

Source: Gavin 2020, "The Levenberg-Marquardt algorithm for nonlinear least squares curve-fitting
problems", update rule 1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Indices, Mask
from pipelines.pnp.levenberg_marquardt import LAMBDA_MAX, LAMBDA_MIN, ROUNDING
from pipelines.pnp.solver_options import LevenbergMarquardtOptions

TOGETHER = 512  # problems whose arrays stay in a core's cache
LARGEST_TURN, LARGEST_SHIFT_M = np.pi, 1e3  # of a step; beyond it the linearisation means nothing


@dataclass(frozen=True, eq=False)
class PoseBatch:
    """Where the iterations ended.

    Attributes
    ----------
    rotations : (b, 3, 3) array
        ``R_cam_from_target``.
    translations : (b, 3) array, m
    chi2 : (b,) array
        Sums of squared weighted residuals; infinite if a point is behind the camera.
    iterations : (b,) int array
    converged : (b,) bool array
        False where the iteration ran out, or had no step to take.
    """

    rotations: Floats
    translations: Floats
    chi2: Floats
    iterations: Indices
    converged: Mask


def solve_poses(
    points_in_target: Floats,
    observed: Floats,
    start_rotations: Floats,
    start_translations: Floats,
    options: LevenbergMarquardtOptions,
    weights: Floats | None = None,
) -> PoseBatch:
    """Minimise the squared reprojection errors of many problems from a guess each.

    Parameters
    ----------
    points_in_target : (m, 3) or (b, m, 3) array, m
        The same for all, or of each its own.
    observed : (b, m, 2) array
        Undistorted normalised image coordinates.
    start_rotations : (b, 3, 3) array
        ``R_cam_from_target``, with every point in front of the camera.
    start_translations : (b, 3) array, m
    options : LevenbergMarquardtOptions
        Of rule and parametrisation only ``gavin`` and ``rotation_vector`` are known here.
    weights : (b, m) array, optional
        One over each observation's sigma, normalised coordinates; 0 for a point that a problem
        has not. 1 unless given.

    Returns
    -------
    PoseBatch
        The best poses met, the same to rounding as ``solve_pose`` finds one by one.

    Raises
    ------
    ValueError
        If the options ask for the paper's rule or Euler angles.
    """
    if (options.lambda_rule, options.parametrisation) != ("gavin", "rotation_vector"):
        raise ValueError(
            "expected lambda_rule 'gavin' and parametrisation 'rotation_vector' of a batch, got "
            f"{options.lambda_rule!r} and {options.parametrisation!r}"
        )
    count = len(observed)
    found = PoseBatch(
        np.array(start_rotations, dtype=np.float64),
        np.array(start_translations, dtype=np.float64),
        np.full(count, np.inf),
        np.zeros(count, dtype=np.int64),
        np.zeros(count, dtype=np.bool_),
    )
    for first in range(0, count, TOGETHER):
        own = slice(first, first + TOGETHER)
        points = points_in_target if points_in_target.ndim == 2 else points_in_target[own]
        _iterate(
            _Problems.of(points, observed[own], None if weights is None else weights[own]),
            PoseBatch(
                found.rotations[own],
                found.translations[own],
                found.chi2[own],
                found.iterations[own],
                found.converged[own],
            ),
            options,
        )
    return found


@dataclass(frozen=True, eq=False)
class _Problems:
    """Points (3, m, b or 1), observations (2, m, b) and weights (m, b or 1)."""

    points: Floats
    observed: Floats
    weights: Floats

    @classmethod
    def of(cls, points: Floats, observed: Floats, weights: Floats | None) -> _Problems:
        last = points.T[:, :, None] if points.ndim == 2 else points.transpose(2, 1, 0)
        many = np.ones((len(observed[0]), 1)) if weights is None else weights.T
        return cls(*map(np.ascontiguousarray, (last, observed.transpose(2, 1, 0), many)))

    def some(self, keep: Mask) -> _Problems:
        each = (self.points, self.observed, self.weights)
        return _Problems(*(own[..., keep] if own.shape[-1] > 1 else own for own in each))

    def turned(self, rotations: Floats) -> Floats:
        """Return the points in camera axes, (3, m, b), before the shift."""
        if self.points.shape[-1] == 1:
            return np.tensordot(rotations, self.points[:, :, 0], (1, 0)).transpose(0, 2, 1)
        return np.einsum("ijb,jmb->imb", rotations, self.points)

    def residuals(self, turned: Floats, translations: Floats) -> tuple[Floats, Floats, Floats]:
        """Return weighted residuals and plain projections, (2, m, b) both, and 1 / depth."""
        in_cam = turned + translations[:, None]
        inverse = 1.0 / np.where(in_cam[2] > 0.0, in_cam[2], np.nan)
        predicted = in_cam[:2] * inverse
        return self.weights * (self.observed - predicted), predicted, inverse

    def jacobian(self, turned: Floats, predicted: Floats, inverse: Floats) -> Floats:
        """Return the weighted derivatives by a left turn and a shift, (6, 2, m, b)."""
        x, y = predicted
        scaled = self.weights * inverse
        q_x, q_y, q_z = turned * scaled
        jacobian = np.zeros((6, 2, *x.shape))
        np.multiply(-q_y, x, out=jacobian[0, 0])
        np.subtract(-q_z, q_y * y, out=jacobian[0, 1])
        np.add(q_z, q_x * x, out=jacobian[1, 0])
        np.multiply(q_x, y, out=jacobian[1, 1])
        jacobian[2, 0], jacobian[2, 1] = -q_y, q_x
        jacobian[3, 0] = jacobian[4, 1] = scaled
        np.multiply(predicted, -scaled, out=jacobian[5])
        return jacobian


def _iterate(problems: _Problems, found: PoseBatch, options: LevenbergMarquardtOptions) -> None:
    """Solve some problems; ``found`` holds their starts and is written into."""
    at = np.arange(len(found.chi2))  # places of those that still move
    rotations, translations = found.rotations.transpose(1, 2, 0), found.translations.T
    turned = problems.turned(rotations)
    residuals, predicted, inverse = problems.residuals(turned, translations)
    chi2 = _chi2(residuals)
    found.chi2[:] = chi2
    damping = np.full(len(at), options.lambda0)
    freedom = max(2 * problems.observed.shape[1] - 6, 1)
    for iteration in range(1, options.max_iterations + 1):
        alive = np.isfinite(chi2)
        jacobian = problems.jacobian(turned, predicted, inverse).reshape(6, -1, len(at))
        gradient = np.einsum("ikb,kb->ib", jacobian, residuals.reshape(-1, len(at)))
        hessian = _squared(jacobian)
        diagonal = hessian[range(6), range(6)]
        step = _solved(hessian, damping * diagonal, gradient)
        sane = (np.abs(step[:3]).max(axis=0) < LARGEST_TURN) & (
            np.abs(step[3:]).max(axis=0) < LARGEST_SHIFT_M
        )
        step[:, ~sane] = 0.0
        moved = np.einsum("ijb,jkb->ikb", _turns(step[:3]), rotations)
        shifted = translations + step[3:]
        new_turned = problems.turned(moved)
        new_residuals, new_predicted, new_inverse = problems.residuals(new_turned, shifted)
        new_chi2 = _chi2(new_residuals)
        gain = np.einsum("ib,ib->b", step, damping * diagonal * step + gradient)
        better = alive & (gain > 0.0) & (new_chi2 < chi2 - options.eps0 * gain)
        size = np.sqrt(np.einsum("ib,ib->b", translations, translations))
        small = np.abs(step[:3]).max(axis=0) < options.eps2
        small &= np.abs(step[3:]).max(axis=0) < options.eps2 * size
        flat = np.abs(gradient).max(axis=0) < options.eps1

        if better.all():
            rotations, translations, turned = moved, shifted, new_turned
            residuals, predicted, inverse = new_residuals, new_predicted, new_inverse
            chi2 = new_chi2
        else:
            rotations = np.where(better, moved, rotations)
            translations = np.where(better, shifted, translations)
            turned = np.where(better, new_turned, turned)
            residuals = np.where(better, new_residuals, residuals)
            predicted = np.where(better, new_predicted, predicted)
            inverse = np.where(better, new_inverse, inverse)
            chi2 = np.where(better, new_chi2, chi2)
        stuck = ~sane & (damping >= LAMBDA_MAX)
        retried = damping * options.lambda_up
        retried = np.where(sane, retried, np.maximum(retried, 1e-6))
        damping = np.where(better, damping / options.lambda_down, retried)
        damping = np.clip(damping, LAMBDA_MIN, LAMBDA_MAX)

        drowned = gain < ROUNDING * chi2  # neither chi2 nor the damping can tell any more
        right = alive & (flat | (sane & (small | drowned)) | (chi2 / freedom < options.eps3))
        ended = right | ~alive | stuck
        last = iteration == options.max_iterations
        if not (ended.any() or last):
            continue
        done = at if last else at[ended]
        keep = np.ones(len(at), dtype=np.bool_) if last else ended
        found.rotations[done] = rotations[..., keep].transpose(2, 0, 1)
        found.translations[done] = translations[:, keep].T
        found.chi2[done], found.converged[done] = chi2[keep], right[keep]
        found.iterations[done] = iteration
        go = ~ended
        if last or not go.any():
            return
        at, problems, damping, chi2 = at[go], problems.some(go), damping[go], chi2[go]
        rotations, translations, turned = rotations[..., go], translations[:, go], turned[..., go]
        residuals, predicted, inverse = residuals[..., go], predicted[..., go], inverse[..., go]


def _chi2(residuals: Floats) -> Floats:
    total = np.einsum("imb,imb->b", residuals, residuals)
    return np.where(np.isfinite(total), total, np.inf)


def _squared(jacobian: Floats) -> Floats:
    """Return ``J' J`` of each problem, (6, 6, b)."""
    hessian = np.empty((6, 6, jacobian.shape[-1]))
    for row in range(6):
        hessian[row, row:] = np.einsum("kb,jkb->jb", jacobian[row], jacobian[row:])
        hessian[row:, row] = hessian[row, row:]
    return hessian


def _solved(hessian: Floats, damping: Floats, gradient: Floats) -> Floats:
    """Solve ``(H + diag(d)) s = g`` of each problem by Cholesky's factors, or give NaN.

    Parameters
    ----------
    hessian : (6, 6, b) array
    damping, gradient : (6, b) array
    """
    left, solved = hessian.copy(), gradient.copy()
    left[range(6), range(6)] += damping
    with np.errstate(invalid="ignore", divide="ignore"):
        for k in range(6):
            left[k:, k] -= np.einsum("jb,ijb->ib", left[k, :k], left[k:, :k])
            left[k:, k] /= np.sqrt(left[k, k])
            solved[k] -= np.einsum("jb,jb->b", left[k, :k], solved[:k])
            solved[k] /= left[k, k]
        for k in reversed(range(6)):
            solved[k] -= np.einsum("jb,jb->b", left[k + 1 :, k], solved[k + 1 :])
            solved[k] /= left[k, k]
    return solved


def _turns(vectors: Floats) -> Floats:
    """Return the rotations (3, 3, b) of rotation vectors (3, b), rad: Rodrigues' formula."""
    angle2 = np.einsum("ib,ib->b", vectors, vectors)
    half = 0.5 * np.sqrt(angle2) / np.pi
    first, second = np.sinc(2.0 * half), 0.5 * np.sinc(half) ** 2
    turns = vectors[:, None] * (second * vectors)
    turns[range(3), range(3)] += 1.0 - second * angle2
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        about = first * vectors[k]
        turns[i, j] -= about
        turns[j, i] += about
    return turns
