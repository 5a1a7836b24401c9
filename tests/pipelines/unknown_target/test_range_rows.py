"""What a range is taken to be to: the hull where silhouettes tell it, else the facet."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pipelines.unknown_target.arrow_equations import ArrowEquations
from pipelines.unknown_target.facet_in_sight import Facets
from pipelines.unknown_target.hull_planes import HullPlanes
from pipelines.unknown_target.options import BatchOptions
from pipelines.unknown_target.range_rows import hull_sigma_m, range_rows
from pipelines.unknown_target.sightings import Ranges
from pipelines.unknown_target.start_guess import StartGuess
from pipelines.unknown_target.unknowns import SHARED, Prior, Unknowns
from tests.pipelines.unknown_target.test_facet_in_sight import AWAY_M, POINTS, TURN, at

DISTANCE_M = float(np.linalg.norm(AWAY_M))
PX_RAD = 1e-3
EVERY = np.ones(len(POINTS), dtype=bool)
AT = Unknowns(np.zeros(SHARED), POINTS)


RANGE = Ranges.none().with_one(0, 7.5, 0.02, Facets.none(1), HullPlanes.none(1))


def test_without_a_hull_the_facet_speaks_and_here_there_is_none() -> None:
    options = replace(BatchOptions(), range_to="hull")
    facets, hull = range_rows(at(TURN, AWAY_M), RANGE, AT, EVERY, 0.1, options, PX_RAD)
    assert np.isnan(facets.error).all()
    assert len(hull.error) == 0


def test_a_range_to_the_centre_is_the_distance() -> None:
    options = replace(BatchOptions(), range_to="centre")
    rows, hull = range_rows(at(TURN, AWAY_M), RANGE, AT, EVERY, 0.1, options, PX_RAD)
    assert len(hull.error) == 0
    assert rows.error[0, 0] == pytest.approx((7.5 - DISTANCE_M) / 0.02, rel=1e-12)


def test_the_hull_is_as_well_known_as_its_corners_are_in_the_root_mean_square() -> None:
    """Each point is told by three rows of its own: no lever from what is shared."""
    prior = Prior(StartGuess(np.array([0.0, 0.0, 9.0]), 1.0, size_m=3.0), 0.3)
    sigmas_m = np.array([0.1, 0.2, 0.4])
    equations = ArrowEquations.empty(SHARED, 3)
    equations.A += np.eye(SHARED)
    equations.D += np.eye(3) * (sigmas_m**-2.0)[:, None, None]
    solved = equations.solve()
    every, two, none = np.ones(3, bool), np.array([True, False, True]), np.zeros(3, bool)
    assert hull_sigma_m(solved, every, prior) == pytest.approx(
        np.sqrt(3.0 * np.mean(sigmas_m**2)), rel=1e-12
    )
    assert hull_sigma_m(solved, two, prior) == pytest.approx(
        np.sqrt(1.5 * (0.01 + 0.16)), rel=1e-12
    )
    assert hull_sigma_m(solved, none, prior) == 0.0
    assert hull_sigma_m(solved, np.ones(4, bool), prior) == pytest.approx(3.0, rel=1e-12)
