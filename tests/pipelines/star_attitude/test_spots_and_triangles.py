"""Spots' shares of light against quadrature, and triangles against every three stars there are."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, permutations

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.stats import norm

from models.camera import Camera
from models.sky.hipparcos import hipparcos_stars
from pipelines.star_attitude.onboard_catalogue import OnboardCatalogue, onboard_catalogue
from pipelines.star_attitude.options import StarAttitudeOptions
from pipelines.star_attitude.spot_model import spot_shares
from pipelines.star_attitude.triangle_search import same_triangles, triangles

STEP = 1e-5
OPTIONS = StarAttitudeOptions()


def test_a_still_spots_shares_are_its_gaussians_over_the_pixels() -> None:
    offset = np.array([[0.2, -0.4], [-0.5, 0.1]])
    shares, _ = spot_shares(offset, np.zeros((2, 2)), 0.7, 5)
    edges = np.arange(-5.5, 6.0)
    for own, (x, y) in zip(shares, offset, strict=True):
        column = np.diff(norm.cdf(edges, x, 0.7))
        row = np.diff(norm.cdf(edges, y, 0.7))
        np.testing.assert_allclose(own, np.outer(row, column), atol=1e-12)
        assert own.sum() == pytest.approx(1.0, abs=1e-9)


def test_a_smeared_spot_is_the_mean_of_spots_along_its_way() -> None:
    """Its middle in the middle; a line drawn out in steps of half a pixel."""
    offset, smear = np.array([[0.2, -0.4]]), np.array([[3.0, -1.5]])
    shares, _ = spot_shares(offset, smear, 0.7, 7)
    fine = [
        spot_shares(offset + part * smear, np.zeros((1, 2)), 0.7, 7)[0]
        for part in (np.arange(400) + 0.5) / 400 - 0.5
    ]
    np.testing.assert_allclose(shares, np.mean(fine, axis=0), atol=1.5e-3)
    columns = np.arange(-7, 8)
    assert (shares[0].sum(axis=0) * columns).sum() == pytest.approx(0.2, abs=1e-6)
    assert (shares[0].sum(axis=1) * columns).sum() == pytest.approx(-0.4, abs=1e-5)
    spread = (shares[0].sum(axis=0) * (columns - 0.2) ** 2).sum()
    assert spread == pytest.approx(0.49 + 1 / 12 + 9 / 12, rel=0.02)


@pytest.mark.parametrize("smear", [(0.0, 0.0), (1.8, 0.7)])
def test_its_slopes_are_those_of_the_shares(smear) -> None:
    offset, way = np.array([[0.3, -0.2]]), np.array([smear])
    _, slopes = spot_shares(offset, way, 0.8, 4)
    for axis in (0, 1):
        step = STEP * np.eye(2)[axis]
        ends = [spot_shares(offset + sign * step, way, 0.8, 4)[0] for sign in (1.0, -1.0)]
        np.testing.assert_allclose(slopes[:, axis], (ends[0] - ends[1]) / (2 * STEP), atol=1e-9)


@pytest.mark.parametrize("count", [3, 5, 9])
def test_every_three_come_once_those_next_in_brightness_first(count: int) -> None:
    order = list(triangles(count))
    assert sorted(order) == list(combinations(range(count), 3))
    assert order[0] == (0, 1, 2)
    spans = [third - first for first, _, third in order if _ - first == 1]
    assert spans == sorted(spans)
    assert list(triangles(2)) == []


def made_catalogue(seed: int, count: int = 22) -> OnboardCatalogue:
    rng = np.random.default_rng(seed)
    ways = np.array([0.0, 0.0, 1.0]) + 0.12 * rng.standard_normal((count, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    pairs = np.array(list(combinations(range(count), 2)))
    chord = np.linalg.norm(ways[pairs[:, 0]] - ways[pairs[:, 1]], axis=1)
    order = np.argsort(chord)
    return OnboardCatalogue(
        np.arange(count), ways, rng.uniform(1.0, 5.0, count), np.zeros(count, bool),
        cKDTree(ways), chord[order], pairs[order, 0], pairs[order, 1],
    )  # fmt: skip


@pytest.mark.parametrize("seed", range(2))
def test_triangles_found_are_all_those_that_fit(seed: int) -> None:
    """Three sides, three magnitudes and the handedness, over every ordered three of the sky."""
    catalogue = made_catalogue(seed)
    options = replace(OPTIONS, side_arcsec=900.0, magnitude_tolerance=0.9)
    rng = np.random.default_rng([7, seed])
    three = tuple(rng.choice(22, 3, replace=False).tolist())
    spots = catalogue.directions + 2e-4 * rng.standard_normal((22, 3))
    spots /= np.linalg.norm(spots, axis=1, keepdims=True)
    magnitude = catalogue.magnitude + 0.1
    found = same_triangles(spots, magnitude, three, catalogue, options)
    tolerance = np.deg2rad(900.0 / 3600.0)
    a, b, c = (spots[k] for k in three)
    expected = set()
    for i, j, k in permutations(range(22), 3):
        p, q, r = (catalogue.directions[n] for n in (i, j, k))
        sides = [
            abs(np.linalg.norm(p - q) - np.linalg.norm(a - b)),
            abs(np.linalg.norm(p - r) - np.linalg.norm(a - c)),
            abs(np.linalg.norm(q - r) - np.linalg.norm(b - c)),
        ]
        bright = np.abs(catalogue.magnitude[[i, j, k]] - magnitude[list(three)]).max() <= 0.9
        same = np.sign(np.linalg.det([p, q, r])) == np.sign(np.linalg.det([a, b, c]))
        if max(sides) < tolerance and bright and same:
            expected.add((i, j, k))
    assert found is not None
    assert {tuple(row) for row in found.tolist()} == expected
    assert three in expected


def test_triangles_too_flat_too_wide_or_too_narrow_are_none() -> None:
    catalogue = made_catalogue(5)
    magnitude = catalogue.magnitude

    def of(*ways: list[float]) -> bool:
        spots = np.array(ways)
        spots = spots / np.linalg.norm(spots, axis=1, keepdims=True)
        return same_triangles(spots, magnitude[:3], (0, 1, 2), catalogue, OPTIONS) is not None

    low, high = catalogue.chord[0], catalogue.chord[-1]
    assert of([0, 0, 1.0], [0.1, 0, 1.0], [0, 0.1, 1.0])
    assert not of([0, 0, 1.0], [0.1, 0, 1.0], [0.2, 1e-3, 1.0])
    assert not of([0, 0, 1.0], [0.1, 0, 1.0], [0, 1.3 * high, 1.0])
    assert not of([0, 0, 1.0], [0.3, 0, 1.0], [0, 0.5 * low, 1.0])


def test_the_catalogue_on_board_is_the_skys_bright_pairs_and_knows_who_is_crowded() -> None:
    """Stars against all others of the sky, and pairs against all distances, by brute force."""
    camera = Camera.from_fov(1024, 1024, 20.0)
    options = replace(OPTIONS, pattern_mag=3.2)
    board, sky = onboard_catalogue(camera, options), hipparcos_stars()
    rows = np.random.default_rng(6).choice(len(board.numbers), 60, replace=False)
    close = np.flatnonzero(board.crowded)[:40]
    for row in [*rows.tolist(), *close.tolist()]:
        apart = np.linalg.norm(sky.directions_in_icrs - board.directions[row], axis=1)
        near = (apart < options.crowded_px / camera.fx) & (apart > 0.0)
        spoils = sky.magnitude[near] - board.magnitude[row] < options.crowded_mag
        assert board.crowded[row] == spoils.any()
    bright = np.flatnonzero((board.magnitude <= 3.2) & ~board.crowded)
    apart = np.linalg.norm(board.directions[bright][:, None] - board.directions[bright], axis=2)
    widest, narrowest = (
        2.0 * np.sin(0.5 * np.deg2rad(each)) for each in (options.widest_deg, options.narrowest_deg)
    )
    upper = apart[np.triu_indices(len(bright), 1)]
    np.testing.assert_allclose(
        board.chord, np.sort(upper[(upper >= narrowest) & (upper <= widest)])
    )
    np.testing.assert_allclose(
        np.linalg.norm(board.directions[board.first] - board.directions[board.second], axis=1),
        board.chord,
    )
    one, other = board.pairs(0.2, 1e-3)
    assert {(a, b) for a, b in zip(one.tolist(), other.tolist(), strict=True)} == {
        (b, a) for a, b in zip(one.tolist(), other.tolist(), strict=True)
    }
    assert len(one) == 2 * ((upper > 0.199) & (upper < 0.201)).sum()
