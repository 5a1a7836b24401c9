"""The unknowns of ``best``: fourteen shared ones, and a place for every point.

All hold at the start and never change, because nothing disturbs the motion: where both are later
follows from them. There is no attitude among them (the body's axes are the first camera's), no
scale of the inertia, and no second set of points.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from pipelines.unknown_target import inertia_chart
from pipelines.unknown_target.arrow_equations import ArrowEquations
from pipelines.unknown_target.start_guess import StartGuess

RHO, RHO_DOT, OMEGA, CHART = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 14)
PLACE, TURN = slice(0, 6), slice(6, 14)
SHARED = 9 + inertia_chart.SIZE
LONGEST_OMEGA, LONGEST_CHART = 0.02, 0.4  # of one step, rad/s and 1: beyond, no line is straight


@dataclass(frozen=True, eq=False)
class Unknowns:
    """Values of all unknowns.

    Attributes
    ----------
    shared : (14,) array
        rho and its rate (m, m/s, local frame) and the inertial rate (rad/s, body axes) at the
        start, then the inertia's chart.
    points : (n, 3) array, m
        From the centre of mass, body axes.
    """

    shared: Floats
    points: Floats

    def moved(self, shared: Floats, points: Floats) -> Unknowns:
        """Return the sum.

        Parameters
        ----------
        shared : (14,) array
        points : (n, 3) array, m
        """
        return Unknowns(self.shared + shared, self.points + points)

    def with_points(self, points: Floats) -> Unknowns:
        """Return the same with more points, (k, 3) m."""
        return Unknowns(self.shared, np.concatenate([self.points, points]))


class Prior:
    """What is known before the first measurement.

    Parameters
    ----------
    start : StartGuess
    inertia_sigma : float
        1 sigma of each number of the inertia's chart about a ball's.
    """

    def __init__(self, start: StartGuess, inertia_sigma: float) -> None:
        sigmas = [start.sigma_m, start.sigma_m_s, start.sigma_rad_s]
        self.sigma = np.concatenate(
            [np.repeat(sigmas, 3), np.full(inertia_chart.SIZE, inertia_sigma)]
        )
        self.mean = np.concatenate(
            [
                start.rho_in_lvlh,
                start.rho_dot_in_lvlh,
                start.omega_in_target,
                np.zeros(inertia_chart.SIZE),
            ]
        )
        self.point_information = start.size_m**-2.0

    def equations(self, at: Unknowns) -> ArrowEquations:
        """Return what the prior says about a place."""
        equations = ArrowEquations.empty(SHARED, len(at.points))
        information = self.sigma**-2.0
        equations.A += np.diag(information)
        equations.a += information * (self.mean - at.shared)
        equations.D += self.point_information * np.eye(3)
        equations.d -= self.point_information * at.points
        return equations

    def cost(self, at: Unknowns) -> float:
        """Return the square of the distance from it, in sigmas."""
        shared = float(np.sum(((at.shared - self.mean) / self.sigma) ** 2))
        return shared + self.point_information * float(np.sum(at.points**2))


def within_reach(shared: Floats, points: Floats) -> tuple[Floats, Floats]:
    """Return a step, (14,) and (n, 3), shortened to where its direction still means something.

    Parameters
    ----------
    shared : (14,) array
    points : (n, 3) array, m
    """
    far = max(
        float(np.linalg.norm(shared[OMEGA])) / LONGEST_OMEGA,
        float(np.abs(shared[CHART]).max()) / LONGEST_CHART,
        1.0,
    )
    return shared / far, points / far
