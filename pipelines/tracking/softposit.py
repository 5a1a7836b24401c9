"""SoftPOSIT: pose and correspondence at once, from a pose that is roughly right.

Source: David, DeMenthon, Duraiswami and Samet 2004, "SoftPOSIT: Simultaneous Pose and
Correspondence Determination", International Journal of Computer Vision 59(3), with the constants
that its authors published. The assignment matrix ``M`` is never swept itself: Sinkhorn's method
only scales its rows and columns, so two vectors of factors are swept instead.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, sqrt

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotrs

from models.arrays import Floats, Indices
from models.camera import Camera
from models.pose import RigidTransform

CHI2_99 = 9.21  # 0.99 quantile of chi-square with two degrees of freedom
LEAST_BETA, MOST_BETA = 1e-5, 0.1
LARGEST_EXPONENT = 600.0  # its exponential is finite
CHECKED_EVERY = 2  # sweeps: looking whether they have settled costs as much as one


@dataclass(frozen=True)
class SoftPositOptions:
    """The published constants.

    Attributes
    ----------
    beta_final, beta_update : float
        The annealing ends at the one, and grows by the other at each iteration; 1/px^2.
    min_beta_count : int
        Iterations before convergence is believed.
    sinkhorn_sweeps : int
        Most sweeps of rows and columns in an iteration.
    sinkhorn_tolerance : float
        A sweep that changes the elements by less in all ends them.
    max_condition : float
        Of the pose's normal equations.
    """

    beta_final: float = 0.5
    beta_update: float = 1.05
    min_beta_count: int = 20
    sinkhorn_sweeps: int = 60
    sinkhorn_tolerance: float = 1e-3
    max_condition: float = 1e10


@dataclass(frozen=True, eq=False)
class SoftPositResult:
    """Where the annealing ended.

    Attributes
    ----------
    pose : RigidTransform or None
        ``cam_from_target``; None where the equations broke down.
    assignment : (n, m) array
        Weight of each pair of point and landmark, between 0 and 1; the slack is left out.
    converged : bool
    history : (iterations, 3) array
        beta in 1/px^2, the weighted root-mean-square distance in px, the share of landmarks
        assigned.
    """

    pose: RigidTransform | None
    assignment: Floats
    converged: bool
    history: Floats

    @property
    def matched(self) -> Indices:
        """(n,) array: the landmark of each point, or -1; heaviest both of row and of column."""
        matched = np.full(self.assignment.shape[0], -1, dtype=np.int64)
        if self.assignment.size:
            landmark = self.assignment.argmax(axis=1)
            point = self.assignment.argmax(axis=0)
            rows = np.arange(len(matched))
            weight = self.assignment[rows, landmark]
            mutual = (point[landmark] == rows) & (weight > 1.0 - self.assignment.sum(axis=1))
            matched[mutual] = landmark[mutual]
        return matched


def first_beta(mean_square_px2: float) -> float:
    """Return beta0 for an expected squared reprojection error of the initial pose, 1/px^2."""
    return float(np.clip(1.0 / max(mean_square_px2, 1e-12), LEAST_BETA, MOST_BETA))


def softposit(
    points_px: Floats,
    points_in_target: Floats,
    camera: Camera,
    start: RigidTransform,
    sigma_px: float,
    beta0: float,
    options: SoftPositOptions | None = None,
) -> SoftPositResult:
    """Find the pose and the correspondence near a pose.

    Parameters
    ----------
    points_px : (n, 2) array, px
        In no order; some may be no landmark at all.
    points_in_target : (m, 3) array, m
        Landmarks; some may have no point.
    camera : Camera
    start : RigidTransform
        ``cam_from_target``, with every landmark in front of the camera.
    sigma_px : float, px
        1-sigma of a point, per axis.
    beta0 : float, 1/px^2
        See ``first_beta``.
    options : SoftPositOptions, optional

    Returns
    -------
    SoftPositResult
        It never raises on what the points show.
    """
    options = options or SoftPositOptions()
    focal_px = 0.5 * (camera.fx + camera.fy)
    away = focal_px * camera.normalise(points_px)
    return _Annealing(away, points_in_target, focal_px, sigma_px, options).run(start, beta0)


class _Annealing:
    """One call: arrays that are filled in place, and the loop."""

    def __init__(
        self,
        away_px: Floats,
        landmarks: Floats,
        focal_px: float,
        sigma_px: float,
        options: SoftPositOptions,
    ) -> None:
        self._options = options
        self._focal_px = focal_px
        self._alpha = CHI2_99 * sigma_px**2 + 1.0
        self._homogeneous = np.column_stack([landmarks, np.ones(len(landmarks))])
        self._away = np.ascontiguousarray(away_px.T)
        count, known = len(away_px), len(landmarks)
        # d^2 = (a - w u)^2 + (b - w v)^2 is one product of (n, 4) and (4, m).
        u, v = self._away
        self._left = np.column_stack([u, v, u * u + v * v, np.ones(count)])
        self._right = np.empty((4, known))
        self._squared = np.empty((count, known))
        self._weights = np.empty((count, known))
        self._slack = 1.0 / (max(count, known) + 1)

    def run(self, start: RigidTransform, beta0: float) -> SoftPositResult:
        """Anneal from a pose."""
        options = self._options
        history: list[tuple[float, float, float]] = []
        known, count = len(self._homogeneous), self._away.shape[1]
        rows, columns = np.zeros(count), np.zeros(known)
        pose: tuple[Floats, Floats] | None = (start.rotation, start.translation)
        scaled = np.empty((2, 4))
        if min(known, count) < 4 or start.translation[2] <= 0.0:
            return SoftPositResult(None, self._weights * 0.0, False, np.zeros((0, 3)))
        scaled[:, :3] = start.rotation[:2] / start.translation[2]
        scaled[:, 3] = start.translation[:2] / start.translation[2]
        depth = self._depths(start.rotation[2], float(start.translation[2]))
        beta, converged = beta0, False
        while beta < options.beta_final and not (
            converged and len(history) > options.min_beta_count
        ):
            rows, columns = self._assign(scaled, depth, beta)
            mass = columns * (rows @ self._weights)
            pose = self._posed(rows, columns, mass, depth, scaled)
            if pose is None:
                break
            depth = self._depths(pose[0][2], float(pose[1][2]))
            np.multiply(self._squared, self._weights, out=self._squared)
            delta = sqrt(max(float(rows @ self._squared @ columns), 0.0) / known)
            converged = delta < 0.5 * sqrt(self._alpha)
            history.append((beta, delta, float(mass.sum()) / known))
            beta *= options.beta_update
        assignment = self._weights * rows[:, None] * columns
        finite = pose is not None and bool(np.isfinite(pose[0]).all())
        found = RigidTransform(*pose) if pose is not None and finite else None
        table = np.array(history).reshape(-1, 3)
        return SoftPositResult(found, assignment, converged and found is not None, table)

    def _depths(self, third_row: Floats, depth: float) -> Floats:
        """Return w: each landmark's depth over the origin's."""
        depths: Floats = self._homogeneous[:, :3] @ (third_row / depth)
        depths += 1.0
        return depths

    def _assign(self, scaled: Floats, depth: Floats, beta: float) -> tuple[Floats, Floats]:
        """Fill distances and weights, and return the factors of the rows and the columns."""
        a, b = scaled @ self._homogeneous.T * self._focal_px
        right = self._right
        np.multiply(a, depth, out=right[0])
        np.multiply(b, depth, out=right[1])
        right[:2] *= -2.0
        np.multiply(depth, depth, out=right[2])
        np.multiply(a, a, out=right[3])
        right[3] += b * b
        np.matmul(self._left, right, out=self._squared)
        np.multiply(self._squared, -beta, out=self._weights)
        self._weights += beta * self._alpha
        if beta * self._alpha > LARGEST_EXPONENT:
            np.minimum(self._weights, LARGEST_EXPONENT, out=self._weights)
        np.exp(self._weights, out=self._weights)
        self._weights *= self._slack
        return self._sinkhorn()

    def _sinkhorn(self) -> tuple[Floats, Floats]:
        """Balance rows and columns; a pair that is best both ways keeps its ratio to the slack.

        The pairs are moved to the first rows and columns, in one order, so that slices do.
        """
        slack, options = self._slack, self._options
        count, known = self._weights.shape
        row_order, column_order, pairs = self._pairs_first()
        weights = self._weights[row_order[:, None], column_order]
        by_row, by_column = np.ones((2, count)), np.ones((2, known))
        rows, columns = by_row[0], by_column[0]  # the factors; below them stands the slack
        by_row[1], by_column[1] = slack, slack
        slack_rows, slack_columns = by_row[1], by_column[1]
        paired_rows, paired_columns = rows[:pairs], columns[:pairs]
        paired_slack_rows, paired_slack_columns = slack_rows[:pairs], slack_columns[:pairs]
        total_rows, total_columns = np.empty(count), np.empty(known)
        moved = np.empty((count, known))
        for sweep in range(options.sinkhorn_sweeps):
            np.dot(rows, weights, out=total_columns)
            total_columns *= columns
            total_columns += slack_columns
            by_column /= total_columns
            # (slack / pair) * (row * pair * column): the pair itself cancels.
            np.multiply(paired_rows, paired_columns, out=paired_slack_rows)
            paired_slack_rows *= slack
            np.dot(weights, columns, out=total_rows)
            total_rows *= rows
            total_rows += slack_rows
            by_row /= total_rows
            np.multiply(paired_rows, paired_columns, out=paired_slack_columns)
            paired_slack_columns *= slack
            if sweep % CHECKED_EVERY:
                # The sweep has divided each element by the product of its two sums.
                np.multiply(total_rows[:, None], total_columns, out=moved)
                moved -= 1.0
                np.abs(moved, out=moved)
                moved *= weights
                if rows @ moved @ columns < options.sinkhorn_tolerance:
                    break
        row_factors, column_factors = np.empty(count), np.empty(known)
        row_factors[row_order], column_factors[column_order] = rows, columns
        return row_factors, column_factors

    def _pairs_first(self) -> tuple[Indices, Indices, int]:
        """Order rows and columns so that the pairs that are best both ways come first."""
        weights = self._weights
        count, known = weights.shape
        point, landmark = weights.argmax(axis=0), weights.argmax(axis=1)
        every = np.arange(known)
        paired = (landmark[point] == every) & (weights[point, every] > self._slack)
        columns, partners = every[paired], point[paired]
        alone = np.ones(count, dtype=np.bool_)
        alone[partners] = False
        row_order = np.concatenate([partners, np.flatnonzero(alone)])
        return row_order, np.concatenate([columns, every[~paired]]), len(columns)

    def _posed(
        self, rows: Floats, columns: Floats, mass: Floats, depth: Floats, scaled: Floats
    ) -> tuple[Floats, Floats] | None:
        """Solve for the scaled rows of the pose, and make a rotation of them."""
        points = self._homogeneous
        factor, info = dpotrf((points.T * mass) @ points, lower=1)
        diagonal = np.abs(np.diagonal(factor))
        least = float(diagonal.min())
        if info or not least > 0.0:
            return None
        if (float(diagonal.max()) / least) ** 2 > self._options.max_condition:
            return None
        drawn = (self._away * rows) @ self._weights
        drawn *= columns * depth / self._focal_px
        solved, _ = dpotrs(factor, (drawn @ points).T, lower=1)
        rotation, translation = _rotation_of(solved.T)
        if rotation is None:
            return None
        scaled[:, :3] = rotation[:2] / translation[2]
        scaled[:, 3] = translation[:2] / translation[2]
        return rotation, translation


def _rotation_of(scaled: Floats) -> tuple[Floats | None, Floats]:
    """Return the rotation nearest to the scaled rows (2, 4), and the translation.

    The polar factor of two columns in closed form: with ``G`` their (2, 2) product,
    ``sqrt(G) = (G + sqrt(det G)) / sqrt(tr G + 2 sqrt(det G))``.
    """
    first, second = scaled[0, :3], scaled[1, :3]
    g11, g12, g22 = float(first @ first), float(first @ second), float(second @ second)
    determinant = g11 * g22 - g12 * g12
    if not (isfinite(determinant) and determinant > 0.0):
        return None, np.zeros(3)
    root = sqrt(determinant)
    both = sqrt(g11 + g22 + 2.0 * root)  # sum of the singular values
    inverse = 1.0 / (both * root)
    r1 = ((g22 + root) * first - g12 * second) * inverse
    r2 = ((g11 + root) * second - g12 * first) * inverse
    r3 = np.array(
        [
            r1[1] * r2[2] - r1[2] * r2[1],
            r1[2] * r2[0] - r1[0] * r2[2],
            r1[0] * r2[1] - r1[1] * r2[0],
        ]
    )
    depth = 2.0 / both
    translation = np.array([scaled[0, 3] * depth, scaled[1, 3] * depth, depth])
    return np.array([r1, r2, r3]), translation
