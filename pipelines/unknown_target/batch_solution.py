"""What ``best`` knows at one time: motion, shape and inertia, with what is lost told as lost."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models.arrays import Floats, Mask
from pipelines.unknown_target import inertia_chart
from pipelines.unknown_target.arrow_equations import ArrowEquations, Solved
from pipelines.unknown_target.observation_rows import Placed
from pipelines.unknown_target.unknowns import CHART, PLACE, RHO, SHARED, TURN, Prior, Unknowns


@dataclass(frozen=True, eq=False)
class BatchSolution:
    """A solution at the last frame.

    Attributes
    ----------
    linearised : Unknowns
        About which all was linearised.
    where : Placed
        The last frame, at those.
    equations : ArrowEquations
    solved : Solved
    prior : Prior
    names : tuple of int
        Track of each point.
    live : (n,) bool array
        Points that still go by it.
    lost_share, most_sigma_m, shape_sigma_m : float
        See ``BatchOptions``.
    """

    linearised: Unknowns
    where: Placed
    equations: ArrowEquations
    solved: Solved
    prior: Prior
    names: tuple[int, ...]
    live: Mask
    lost_share: float
    most_sigma_m: float = float(np.inf)
    shape_sigma_m: float = float(np.inf)

    @cached_property
    def unknowns(self) -> Unknowns:
        """All unknowns as they are thought to be at the start."""
        return self.linearised.moved(self.solved.shared, self.solved.points)

    @cached_property
    def placed(self) -> Placed:
        """The target at the last frame."""
        return self.where.moved(self.solved.shared)

    @cached_property
    def motion(self) -> Floats:
        """(9,) array: rho, its rate (m, m/s, local frame), inertial rate (rad/s, body)."""
        return np.concatenate([self.placed.state[0], self.placed.omega[0]])

    @cached_property
    def motion_covariance(self) -> Floats:
        """(12, 12) array: of rho, its rate, the turn in body axes (rad) and the rate (rad/s)."""
        return np.asarray(self.motion_by_shared @ self.solved.covariance @ self.motion_by_shared.T)

    @cached_property
    def motion_by_shared(self) -> Floats:
        """(12, 14) array: the motion at the last frame by the shared unknowns."""
        by_shared = np.zeros((12, SHARED))
        by_shared[:6, PLACE] = self.where.state_by_place[0]
        by_shared[6:9, TURN] = self.where.turn_by_rest[0]
        by_shared[9:, TURN] = self.where.omega_by_rest[0]
        return by_shared

    @cached_property
    def point_sigmas(self) -> Floats:
        """(n,) array, m: of each point, the root of its covariance's trace."""
        traces = np.trace(self.solved.point_covariances(), axis1=1, axis2=2)
        return np.asarray(np.sqrt(np.maximum(traces, 0.0)))

    @cached_property
    def inertia(self) -> Floats:
        """(3, 3) array: up to its scale, of trace 1."""
        return inertia_chart.inertia_of(self.unknowns.shared[CHART])

    @cached_property
    def inertia_covariance(self) -> Floats:
        """(9, 9) array: of that matrix, row by row."""
        by_chart = inertia_chart.derivatives(self.unknowns.shared[CHART]).reshape(-1, 9)
        return np.asarray(by_chart.T @ self.solved.covariance[CHART, CHART] @ by_chart)

    @cached_property
    def lost_inertia_ratios(self) -> int:
        """How many of the inertia's five ratios the motion has told nothing of."""
        left = self.solved.covariance[CHART, CHART]
        sigma = self.prior.sigma[CHART]
        shares = np.sqrt(np.linalg.eigvalsh(left / np.outer(sigma, sigma)))
        return int(np.sum(shares > self.lost_share))

    @cached_property
    def scale_sigma(self) -> float:
        """1 sigma of the geometric scale, relative."""
        rho = self.unknowns.shared[RHO]
        spread = float(rho @ self.solved.covariance[RHO, RHO] @ rho)
        return float(np.sqrt(spread) / (rho @ rho))

    @property
    def scale_lost(self) -> bool:
        """Whether no range has told the scale."""
        rho = self.unknowns.shared[RHO]
        before = float(self.prior.sigma[0] / np.linalg.norm(rho))
        return self.scale_sigma > self.lost_share * before

    def nees(self, truth: Unknowns) -> float:
        """Return the square of the error of all unknowns by the information stated of them."""
        own = self.unknowns
        return self.equations.square(truth.shared - own.shared, truth.points - own.points)
