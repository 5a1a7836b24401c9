"""Where a descent ended, and what a solution expects of measurements that come after it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from pipelines.unknown_target import robust_weights
from pipelines.unknown_target.arrow_equations import Solved
from pipelines.unknown_target.free_tumble import FreeTumble
from pipelines.unknown_target.observation_rows import Placed, Rows, sighting_rows
from pipelines.unknown_target.options import BatchOptions
from pipelines.unknown_target.sightings import Sightings
from pipelines.unknown_target.unknowns import Unknowns


@dataclass(frozen=True, eq=False)
class Descent:
    """Where one ended.

    Attributes
    ----------
    at : Unknowns
    tumble : FreeTumble
        Of these.
    rows : tuple of Rows
        Of sightings, of ranges by points and by the hull, and of outlines, there.
    opened : float
        How wide the gates still are.
    misfit : float
        How many sigmas most sightings err.
    """

    at: Unknowns
    tumble: FreeTumble
    rows: tuple[Rows, ...]
    opened: float
    misfit: float


def weights_of(rows: tuple[Rows, ...], options: BatchOptions, opened: float) -> list[Floats]:
    """Return the weights of the rows of a ``Descent``, one array of (m,) each.

    What errs alike counts as one, and the sightings of a track by its whole life.

    Parameters
    ----------
    rows : tuple of Rows
    options : BatchOptions
    opened : float
        Gates are no wider than that, in units of their own width.
    """
    tracks = robust_weights.of_tracks(rows[0].sizes, rows[0].who, options.track_gate)
    alike: tuple[Floats | float, ...] = (
        options.alike_sightings / tracks,
        options.alike_ranges,
        options.alike_ranges,
        options.alike_outlines,
    )
    return [
        robust_weights.of_most(each.sizes, each.error.shape[1], options.gate_sigmas, opened) / own
        for each, own in zip(rows, alike, strict=True)
    ]


def predicted_shift(rows: Rows, solved: Solved) -> Floats:
    """Return by how much a solution moves predictions from where they were linearised, (m, k)."""
    return np.asarray(
        rows.by_shared @ solved.shared
        + np.einsum("mki,mi->mk", rows.by_point, solved.points[rows.who])
    )


def bend(where: Placed, points: Floats, known: Sightings, solved: Solved) -> float:
    """Return how wrong the lines are by now: the square of what the last image misses them by.

    Each image so far misses them by about as much, and all of them count.

    Parameters
    ----------
    where : Placed
        Where all was linearised.
    points : (n, 3) array, m
        There.
    known : Sightings
        ``frame`` counts in ``where``.
    solved : Solved
    """
    own = known.frame, known.who, known.seen, known.sigma
    straight = sighting_rows(where, points, *own)
    curved = sighting_rows(where.moved(solved.shared), points + solved.points, *own)
    missed = curved.error - straight.error + predicted_shift(straight, solved)
    return float(np.nansum(missed**2))


def surprise(rows: Rows, solved: Solved) -> Floats:
    """Return how many sigmas measurements are from where they were expected, (m,)."""
    expected = solved.predicted_spread(rows.by_shared, rows.by_point, rows.who)
    error = rows.error - predicted_shift(rows, solved)
    whole = np.isfinite(error).all(axis=1)
    sizes = np.full(len(error), np.inf)
    spread = expected[whole] + np.eye(error.shape[1])
    normalised = np.linalg.solve(spread, error[whole, :, None])[..., 0]
    sizes[whole] = np.sqrt(np.sum(error[whole] * normalised, axis=1))
    return sizes
