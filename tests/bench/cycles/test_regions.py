"""Means over regions: rims are left out, errors are those of the scatter, one percent shows."""

from __future__ import annotations

import numpy as np
import pytest

from bench.cycles.neutral_scene import NeutralMaterial
from bench.cycles.regions import (
    BLEND,
    CONDUCTOR,
    DIFFUSE,
    RIM_PX,
    compare_regions,
    interiors,
    kind_of,
    region_means,
)

SEEDS = 6


def labels():
    image = np.zeros((60, 60), dtype=np.uint8)
    image[5:55, 5:30] = 1
    image[5:55, 30:55] = 2
    return image


def renders(scale_of_2=1.0, noise=0.02, seed=0):
    rng = np.random.default_rng(seed)
    truth = np.where(labels() == 1, 3.0, np.where(labels() == 2, 0.5 * scale_of_2, 0.0))
    return [truth * (1.0 + noise * rng.standard_normal(truth.shape)) for _ in range(SEEDS)]


@pytest.mark.parametrize(
    ("diffuse", "specular", "kind"),
    [(0.8, 0.01, DIFFUSE), (0.06, 0.7, CONDUCTOR), (0.3, 0.4, BLEND), (0.0, 0.5, CONDUCTOR)],
)
def test_kinds(diffuse, specular, kind):
    assert kind_of(NeutralMaterial(diffuse, specular, 0.2)) == kind


def test_the_rim_belongs_to_no_region():
    inside = interiors(labels())
    assert set(inside) == {1, 2}
    assert inside[1].sum() == (50 - 2 * RIM_PX) * (25 - 2 * RIM_PX)
    assert not (inside[1] & inside[2]).any()


def test_a_rim_that_differs_changes_nothing():
    theirs = renders(seed=1)
    shifted = [image.copy() for image in theirs]
    for image in shifted:
        image[:, 29:31] = 100.0
    first = compare_regions(labels(), ("a", "b"), {"a": DIFFUSE, "b": CONDUCTOR}, theirs, theirs)
    second = compare_regions(labels(), ("a", "b"), {"a": DIFFUSE, "b": CONDUCTOR}, shifted, theirs)
    assert first == second


@pytest.mark.parametrize(("scale", "agrees"), [(1.0, True), (1.02, False), (0.98, False)])
def test_two_percent_in_one_region_is_found_there_and_only_there(scale, agrees):
    kinds = {"a": DIFFUSE, "b": CONDUCTOR}
    totals, regions = compare_regions(
        labels(), ("a", "b"), kinds, renders(scale, seed=2), renders(seed=3)
    )
    by_name = {row.name: row for row in [*totals, *regions]}
    assert by_name["a"].agrees
    assert by_name[DIFFUSE].agrees
    assert by_name["b"].agrees is agrees
    assert by_name[CONDUCTOR].agrees is agrees
    assert all(row.telling for row in regions)


def test_the_error_is_that_of_the_scatter_between_seeds():
    """Over many trials the ratio strays from one by its stated standard error, within a tenth."""
    mask = labels() == 1
    pulls = []
    for trial in range(200):
        row = region_means(
            "a", mask, renders(noise=0.3, seed=2 * trial), renders(noise=0.3, seed=2 * trial + 1)
        )
        pulls.append((row.ratio - 1.0) / row.ratio_error)
    student = np.sqrt((2 * SEEDS - 2) / (2 * SEEDS - 4))  # spread of Student's t, 10 freedoms
    assert np.std(pulls) == pytest.approx(student, rel=0.2)  # four sigma of 200 trials


def test_a_noisy_or_dark_region_tells_nothing():
    mask = labels() == 2
    noisy = region_means("b", mask, renders(noise=3.0, seed=5), renders(noise=3.0, seed=6))
    assert not noisy.telling
    dark = [np.zeros((60, 60)) for _ in range(SEEDS)]
    assert not region_means("b", mask, dark, dark).telling
