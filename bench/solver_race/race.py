"""Who is how fast and how right: processor time a problem, poses found, error over the bound."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from bench.solver_race.problems import Problems
from bench.solver_race.solvers import PEER, Poses, Solver
from models.arrays import Floats
from pipelines.pnp.gauss_newton import linearised

FOUND = 1e-6  # a pose further off than noise takes it so seldom is another minimum


@dataclass(frozen=True)
class Standing:
    """How one solver did.

    Attributes
    ----------
    name : str
    microseconds : float
        Of processor time a problem, the least of all rounds.
    times_faster : float
        Than the peer, in the same rounds: the middle one's.
    found : float
        Share of problems that ended in the minimum by the truth.
    position_over_bound, attitude_over_bound : float
        Root mean square error of those over the Cramér-Rao bound's.
    """

    name: str
    microseconds: float
    times_faster: float
    found: float
    position_over_bound: float
    attitude_over_bound: float


def race(problems: Problems, solvers: Mapping[str, Solver], rounds: int) -> list[Standing]:
    """Let solvers take turns, on one thread, and judge what they found.

    Parameters
    ----------
    problems : Problems
    solvers : mapping of str to callable
        The peer among them.
    rounds : int
    """
    spent = {name: np.zeros(rounds) for name in solvers}
    found: dict[str, Poses] = {}
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        for turn in range(rounds):
            for name, solver in solvers.items():
                began = time.process_time()
                found[name] = solver(problems)
                spent[name][turn] = time.process_time() - began
    finally:
        cv2.setNumThreads(threads)
    bounds = bounds_of(problems)
    return [
        Standing(
            name,
            1e6 * float(spent[name].min()) / len(problems),
            float(np.median(spent[PEER] / spent[name])),
            *_judged(problems, found[name], bounds),
        )
        for name in solvers
    ]


def bounds_of(problems: Problems) -> Floats:
    """Return the Cramér-Rao bounds at the true poses, (b, 6, 6), rad and m, turn first."""
    _, jacobian = linearised(problems.rotations, problems.translations, problems.points_in_target)
    flat = jacobian.reshape(len(problems), 6, -1)
    return np.asarray(problems.sigma**2 * np.linalg.inv(flat @ flat.transpose(0, 2, 1)))


def _judged(problems: Problems, found: Poses, bounds: Floats) -> tuple[float, float, float]:
    turns = Rotation.from_matrix(found[0] @ problems.rotations.transpose(0, 2, 1)).as_rotvec()
    errors = np.concatenate([turns, found[1] - problems.translations], axis=1)
    there = np.isfinite(errors).all(axis=1)
    squares = np.full(len(errors), np.inf)
    solved = np.linalg.solve(bounds[there], errors[there, :, None])[..., 0]
    squares[there] = np.einsum("bi,bi->b", errors[there], solved)
    right = squares < chi2.isf(FOUND, 6)
    if not right.any():
        return 0.0, np.nan, np.nan
    position, attitude = (
        float(
            np.sqrt(
                np.sum(errors[right][:, own] ** 2)
                / np.trace(bounds[right][:, own, own], axis1=1, axis2=2).sum()
            )
        )
        for own in (slice(3, 6), slice(0, 3))
    )
    return float(right.mean()), position, attitude
