"""References are there for every row, of the light that is traced today, and read back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from bench.grain.reference import BITS, SAMPLES, Reference, rounded
from bench.grain.rows import REFERENCED, TILE_PX, Row
from models.errors import RvbenchError
from renders.store.light_keys import PHYSICS_VERSION


@pytest.mark.parametrize("row", REFERENCED, ids=lambda row: row.name)
def test_every_row_has_one_of_todays_light(row: Row) -> None:
    reference = Reference.read(row)
    assert reference.samples == SAMPLES
    assert reference.electrons.shape == (len(reference.tiles), TILE_PX, TILE_PX)
    assert np.isfinite(reference.electrons).all()
    assert reference.electrons.max() > 0.0


def test_it_reads_back_and_is_refused_for_other_light(tmp_path: Path) -> None:
    row, light = REFERENCED[0], np.random.default_rng(1).gamma(1.0, 1e4, (2, TILE_PX, TILE_PX))
    for physics in (PHYSICS_VERSION, PHYSICS_VERSION - 1):
        Reference(np.array([[0, 32], [64, 96]]), light, physics, 8).write(row, tmp_path)
        if physics == PHYSICS_VERSION:
            back = Reference.read(row, tmp_path)
            assert back.electrons == pytest.approx(light, rel=2.0**-BITS)
    with pytest.raises(RvbenchError, match=f"of physics {PHYSICS_VERSION}, got"):
        Reference.read(row, tmp_path)
    with pytest.raises(RvbenchError, match="found none"):
        Reference.read(REFERENCED[1], tmp_path)


def test_rounding_keeps_so_many_digits() -> None:
    values = np.geomspace(1e-3, 1e6, 1000)
    assert rounded(values) == pytest.approx(values, rel=2.0**-BITS)
    assert rounded(np.zeros(3)).tolist() == [0.0, 0.0, 0.0]
