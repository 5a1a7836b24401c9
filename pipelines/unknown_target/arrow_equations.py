"""Normal equations of a few shared unknowns and many points that know of each other only by them.

The information is an arrow: ``A`` of the shared unknowns, ``D`` of every point by itself, ``B``
between the two. Points are eliminated one by one (Schur's complement), so that a solution costs as
many operations as there are points, not their cube.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Indices


@dataclass(eq=False)
class ArrowEquations:
    """``Lambda delta = gradient`` in blocks.

    Attributes
    ----------
    A : (g, g) array
    B : (n, g, 3) array
    D : (n, 3, 3) array
    a : (g,) array
    d : (n, 3) array
        The gradient's parts.
    """

    A: Floats
    B: Floats
    D: Floats
    a: Floats
    d: Floats

    @classmethod
    def empty(cls, shared: int, points: int = 0) -> ArrowEquations:
        """Return equations that say nothing."""
        return cls(
            np.zeros((shared, shared)),
            np.zeros((points, shared, 3)),
            np.zeros((points, 3, 3)),
            np.zeros(shared),
            np.zeros((points, 3)),
        )

    def copy(self) -> ArrowEquations:
        """Return equations that may be changed alone."""
        return ArrowEquations(*(part.copy() for part in (self.A, self.B, self.D, self.a, self.d)))

    def plus(self, other: ArrowEquations) -> ArrowEquations:
        """Return the sum of two of the same size."""
        return ArrowEquations(
            self.A + other.A, self.B + other.B, self.D + other.D, self.a + other.a,
            self.d + other.d,
        )  # fmt: skip

    def grow(self, points: int) -> None:
        """Make room for so many more points, of which nothing is known."""
        shared = len(self.a)
        self.B = np.concatenate([self.B, np.zeros((points, shared, 3))])
        self.D = np.concatenate([self.D, np.zeros((points, 3, 3))])
        self.d = np.concatenate([self.d, np.zeros((points, 3))])

    def add_rows(self, by_shared: Floats, by_point: Floats, error: Floats, who: Indices) -> None:
        """Take in whitened measurements, each of one point.

        Parameters
        ----------
        by_shared : (m, k, g) array
            Derivatives of k numbers by the shared unknowns, over their sigma.
        by_point : (m, k, 3) array
        error : (m, k) array
            Measured minus predicted, over sigma.
        who : (m,) int array
            Which point each is of.
        """
        rows = by_shared.reshape(-1, by_shared.shape[2])
        self.A += rows.T @ rows
        self.a += error.ravel() @ rows
        order = np.argsort(who, kind="stable")
        points, starts = np.unique(who[order], return_index=True)
        if points.size == 0:
            return
        turned = by_point[order].transpose(0, 2, 1)
        self.B[points] += np.add.reduceat(
            by_shared[order].transpose(0, 2, 1) @ by_point[order], starts
        )
        self.D[points] += np.add.reduceat(turned @ by_point[order], starts)
        self.d[points] += np.add.reduceat((turned @ error[order, :, None])[..., 0], starts)

    def moved(self, shared: Floats, points: Floats) -> ArrowEquations:
        """Return the same equations about another place.

        Parameters
        ----------
        shared : (g,) array
            How far it is away.
        points : (n, 3) array
        """
        change_a, change_d = self.times(shared, points)
        return ArrowEquations(self.A, self.B, self.D, self.a - change_a, self.d - change_d)

    def times(self, shared: Floats, points: Floats) -> tuple[Floats, Floats]:
        """Return ``Lambda`` times a vector: (g,) and (n, 3).

        Parameters
        ----------
        shared : (g,) array
        points : (n, 3) array
        """
        return (
            self.A @ shared + np.einsum("ngk,nk->g", self.B, points),
            np.einsum("ngk,g->nk", self.B, shared) + np.einsum("nkl,nl->nk", self.D, points),
        )

    def square(self, shared: Floats, points: Floats) -> float:
        """Return a vector's square by the information: the NEES of an error.

        Parameters
        ----------
        shared : (g,) array
        points : (n, 3) array
        """
        by_shared, by_points = self.times(shared, points)
        return float(shared @ by_shared + np.sum(points * by_points))

    def damped(self, amount: float) -> ArrowEquations:
        """Return the equations with each diagonal entry enlarged by a share (Marquardt 1963)."""
        eye = np.eye(3)
        return ArrowEquations(
            self.A + amount * np.diag(np.diag(self.A)),
            self.B,
            self.D + amount * self.D * eye,
            self.a,
            self.d,
        )

    def solve(self) -> Solved:
        """Eliminate the points.

        Raises
        ------
        numpy.linalg.LinAlgError
            If something is not determined at all.
        """
        inverse = np.asarray(np.linalg.inv(self.D), dtype=np.float64)
        lever = self.B @ inverse
        reduced = self.A - np.einsum("ngk,nhk->gh", lever, self.B)
        scale = 1.0 / np.sqrt(np.diag(self.A))
        scaled = reduced * np.outer(scale, scale)
        covariance = np.linalg.inv(0.5 * (scaled + scaled.T)) * np.outer(scale, scale)
        shared = covariance @ (self.a - np.einsum("ngk,nk->g", lever, self.d))
        points = np.einsum("nkl,nl->nk", inverse, self.d) - np.einsum("ngk,g->nk", lever, shared)
        return Solved(shared, points, 0.5 * (covariance + covariance.T), inverse, lever)


@dataclass(frozen=True, eq=False)
class Solved:
    """A solution with its covariance.

    Attributes
    ----------
    shared : (g,) array
    points : (n, 3) array
    covariance : (g, g) array
        Of the shared unknowns.
    """

    shared: Floats
    points: Floats
    covariance: Floats
    _inverse: Floats
    _lever: Floats

    def point_covariances(self) -> Floats:
        """Return (n, 3, 3): of every point by itself."""
        spread = self._lever.transpose(0, 2, 1) @ self.covariance @ self._lever
        return np.asarray(self._inverse + spread)

    def predicted_spread(self, by_shared: Floats, by_point: Floats, who: Indices) -> Floats:
        """Return the covariance of what is predicted of points, (m, k, k).

        Parameters
        ----------
        by_shared : (m, k, g) array
        by_point : (m, k, 3) array
        who : (m,) int array
        """
        through = by_shared - by_point @ self._lever[who].transpose(0, 2, 1)
        alone = by_point @ self._inverse[who] @ by_point.transpose(0, 2, 1)
        return np.asarray(through @ self.covariance @ through.transpose(0, 2, 1) + alone)
