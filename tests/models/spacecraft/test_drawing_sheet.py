"""Every part measures what its drawing says: see ``drawing_sheet``, which also measures anew."""

from __future__ import annotations

import csv

import numpy as np
import pytest
import trimesh

from tests.models.spacecraft.drawing_sheet import (
    COLUMNS,
    COUNTS,
    DRAWN,
    SHEET,
    SIZES,
    measured,
    rows_of,
)

# Sums over 1e5 triangles in another order: 1e-9. A coat of paint on a panel is 1e-5 m.
SIZE_M = 1e-6
REDRAWN = "redrawn on purpose? python -m tests.models.spacecraft.drawing_sheet, and look at why"


def sheet_of(assembly: str) -> list[dict[str, str]]:
    with SHEET.open() as file:
        return [row for row in csv.DictReader(file) if row["assembly"] == assembly]


@pytest.mark.parametrize("assembly", DRAWN)
def test_every_part_measures_what_its_drawing_says(assembly: str) -> None:
    drawn, found = sheet_of(assembly), rows_of(assembly)
    words = [column for column in COLUMNS if column not in SIZES]
    assert [[row[w] for w in words] for row in found] == [[row[w] for w in words] for row in drawn]
    sizes = [np.array([[float(row[s]) for s in SIZES] for row in rows]) for rows in (found, drawn)]
    off = np.abs(sizes[0] - sizes[1]) > SIZE_M * np.maximum(1.0, np.abs(sizes[1]))
    told = [f"{drawn[i]['part']}, {drawn[i]['material']}: {SIZES[j]}" for i, j in np.argwhere(off)]
    assert not told, f"{told}; {REDRAWN}"


def test_the_measure_is_that_of_a_box_by_hand() -> None:
    """A box of 2, 4, 6 m about (1, 0, 0): 88 m2, 48 m3, gyration by its three pairs of faces."""
    box = trimesh.creation.box(extents=(2.0, 4.0, 6.0))
    box.apply_translation([1.0, 0.0, 0.0])
    size = dict(zip(SIZES, measured(np.asarray(box.triangles)), strict=True))
    assert size["area_m2"] == pytest.approx(88.0)
    assert size["volume_m3"] == pytest.approx(48.0)
    assert [size[f"low_{a}"] for a in "xyz"] == [0.0, -2.0, -3.0]
    assert [size[f"high_{a}"] for a in "xyz"] == [2.0, 2.0, 3.0]
    assert [size[f"centroid_{a}"] for a in "xyz"] == pytest.approx([1.0, 0.0, 0.0])
    # x: 48 m2 lie 1 m away, 40 m2 are spread over 2 m, whose variance is 1/3.
    assert size["gyration_x"] ** 2 == pytest.approx((48.0 + 40.0 / 3.0) / 88.0)
    assert set(COUNTS) < set(COLUMNS)
