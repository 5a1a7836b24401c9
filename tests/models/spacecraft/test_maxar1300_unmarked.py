"""The Maxar-1300 without markers is the one with them, moved, and free to turn about its origin."""

from __future__ import annotations

import numpy as np

from models.spacecraft.maxar1300 import CENTRE_OF_MASS_M, maxar1300
from models.spacecraft.maxar1300_unmarked import MARKER_SUPPORTS, maxar1300_unmarked

ROUNDING_M = 1e-12


def test_nothing_is_left_of_the_markers() -> None:
    assert maxar1300_unmarked().markers is None
    marked, unmarked = maxar1300().part_names, maxar1300_unmarked().part_names
    assert set(marked) - set(unmarked) == {MARKER_SUPPORTS}


def test_it_turns_about_its_origin_and_is_the_same_but_for_that() -> None:
    assert not maxar1300_unmarked().centre_of_mass.any()
    kept = [part for part in maxar1300().parts if part.name != MARKER_SUPPORTS]
    for moved, part in zip(maxar1300_unmarked().parts, kept, strict=True):
        assert (moved.name, moved.material) == (part.name, part.material)
        off_m = np.asarray(moved.mesh.vertices) + CENTRE_OF_MASS_M - np.asarray(part.mesh.vertices)
        assert np.abs(off_m).max() < ROUNDING_M
