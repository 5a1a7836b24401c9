"""Circles among blobs: drawn whole, cut, too large, too far, and not on black."""

from __future__ import annotations

import numpy as np
import pytest

from models.arrays import Floats, Mask
from pipelines.detection import dot_candidates
from pipelines.detection.dot_candidates import DotCandidates, find_dots

SIZE = (120, 150)
PLACE_PX = 0.3  # of a circle through a boundary that is known to a pixel


def disc(
    centre: tuple[float, float], radius: float, size: tuple[int, int] = SIZE, finer: int = 4
) -> Floats:
    """Share of each pixel inside a disc."""
    v, u = (np.arange(n * finer) / finer + 0.5 / finer - 0.5 for n in size)
    inside = np.hypot(u[None] - centre[0], v[:, None] - centre[1]) < radius
    return inside.reshape(size[0], finer, size[1], finer).mean(axis=(1, 3))


def found_in(
    share: Floats, around: float = 0.05, radii=(9.0, 11.0), expected=((70.0, 60.0),), reach=20.0
) -> DotCandidates:
    grey = (around + (1.0 - around) * share).astype(np.float32)
    return find_dots(grey, share > 0.5, radii, np.array(expected), reach)


@pytest.mark.parametrize("centre", [(70.3, 60.8), (62.5, 55.5)])
@pytest.mark.parametrize("radius", [9.2, 10.7])
def test_a_whole_dot_is_a_whole_circle(centre: tuple[float, float], radius: float) -> None:
    found = found_in(disc(centre, radius))
    assert len(found) == 1
    np.testing.assert_allclose(found.centres[0], centre, atol=PLACE_PX)
    assert found.radii[0] == pytest.approx(radius, abs=PLACE_PX)
    assert found.arcs[0] == 1.0


@pytest.mark.parametrize("normal_deg", [0.0, 130.0, 250.0])
@pytest.mark.parametrize("through", [0.3, -0.1])
def test_a_dot_that_a_shadow_cuts_has_its_whole_circles_centre(
    through: float, normal_deg: float
) -> None:
    """Less of its circle is covered: what a chord at a share of the radius leaves."""
    normal = np.array([np.cos(np.deg2rad(normal_deg)), np.sin(np.deg2rad(normal_deg))])
    v, u = np.mgrid[: SIZE[0], : SIZE[1]]
    lit = (u - 70.3) * normal[0] + (v - 60.8) * normal[1] < through * 10.0
    found = found_in(disc((70.3, 60.8), 10.0) * lit, radii=(9.8, 10.2))
    assert len(found) == 1
    np.testing.assert_allclose(found.centres[0], [70.3, 60.8], atol=2.0 * PLACE_PX)
    covered = 1.0 - np.arccos(through) / np.pi
    assert found.arcs[0] == pytest.approx(covered, abs=0.13)  # three of 24 bins


def test_a_sliver_is_none() -> None:
    v, u = np.mgrid[: SIZE[0], : SIZE[1]]
    assert len(found_in(disc((70.3, 60.8), 10.0) * (u < 62))) == 0
    assert len(found_in(disc((70.3, 60.8), 10.0) * (v < 0))) == 0


@pytest.mark.parametrize(("around", "dots"), [(0.05, 1), (0.45, 1), (0.55, 0), (0.9, 0)])
def test_a_dot_stands_on_black(around: float, dots: int) -> None:
    """The median of what lies between 1.3 and 1.6 radii is below half of the dot's own."""
    assert len(found_in(disc((70.3, 60.8), 10.0), around)) == dots


def test_what_lies_within_or_beyond_the_ring_does_not_matter() -> None:
    own = disc((70.0, 60.0), 10.0)
    v, u = np.mgrid[: SIZE[0], : SIZE[1]]
    away = np.hypot(u - 70.0, v - 60.0) / 10.0
    for low, high, dots in ((1.05, 1.28, 1), (1.62, 3.0, 1), (1.3, 1.6, 0), (1.3, 1.44, 1)):
        grey = np.where((away > low) & (away < high), 0.9, 0.05 + 0.95 * own).astype(np.float32)
        found = find_dots(grey, own > 0.5, (9.0, 11.0), np.array([[70.0, 60.0]]), 20.0)
        assert len(found) == dots, (low, high)


def test_blobs_too_small_too_large_or_too_long_are_none() -> None:
    """Area from 0.15 of the smallest disc's to 1.5 of the largest's, and sides to 2.6 radii."""
    assert len(found_in(disc((70.3, 60.8), 3.0))) == 0  # 28 pixels of 0.15 * 254
    assert len(found_in(disc((70.3, 60.8), 13.6))) == 0  # 581 of 1.5 * 380
    bar = np.zeros(SIZE)
    bar[57:64, 54:86] = 1.0  # 32 long, of 2.6 * 11 + 2
    assert len(found_in(bar)) == 0
    assert (
        len(find_dots(np.zeros(SIZE, np.float32), bar > 2.0, (9.0, 11.0), np.ones((1, 2)), 9.0))
        == 0
    )


def test_dots_are_looked_for_where_they_are_expected() -> None:
    """The middle of a blob within the reach and a radius of any that is expected."""
    share = disc((70.0, 60.0), 10.0)
    for expected, dots in (
        ([[100.0, 60.0]], 1), ([[102.5, 60.0]], 0), ([[70.0, 90.0]], 1), ([[70.0, 92.5]], 0),
        ([[10.0, 10.0], [71.0, 60.0]], 1), ([[np.nan, np.nan], [71.0, 60.0]], 1),
        ([[np.nan, np.nan]], 0),
    ):  # fmt: skip
        assert len(found_in(share, expected=expected, reach=20.0)) == dots, expected


def test_several_dots_come_largest_first_each_with_its_own_circle() -> None:
    share = disc((40.2, 50.1), 9.3) + disc((90.7, 70.4), 10.8) + disc((60.0, 100.0), 2.0)
    found = found_in(share, expected=[(40.0, 50.0), (90.0, 70.0)])
    np.testing.assert_allclose(found.centres, [[90.7, 70.4], [40.2, 50.1]], atol=PLACE_PX)
    np.testing.assert_allclose(found.radii, [10.8, 9.3], atol=PLACE_PX)
    assert DotCandidates.none().centres.shape == (0, 2)


def test_a_dot_beside_the_images_edge_is_found() -> None:
    for centre in ((9.0, 60.0), (70.0, 9.0), (140.0, 60.0), (70.0, 110.0)):
        found = found_in(disc(centre, 10.0), expected=[centre])
        assert len(found) == 1, centre
        np.testing.assert_allclose(found.centres[0], centre, atol=2.0 * PLACE_PX)


def test_circles_through_pairs_go_through_both() -> None:
    """Two of a given radius through any two points no farther apart than twice that."""
    turn = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
    points = np.array([5.0, -2.0]) + 6.0 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    centres = dot_candidates._through_pairs(points, 7.0)
    gaps = np.abs(np.linalg.norm(points[None] - centres[:, None], axis=-1) - 7.0)
    assert (np.sort(gaps, axis=1)[:, 1] < 1e-9).all()
    assert len(centres) == 2 * 3 * 60
    true = dot_candidates._through_pairs(points, 6.0)
    assert (np.linalg.norm(true - [5.0, -2.0], axis=1) < 1e-9).mean() >= 0.5
    assert len(dot_candidates._through_pairs(points, 0.9)) == 0  # chords of 6 px and more


def boundary(mask: Mask) -> tuple[Floats, float, float] | None:
    return dot_candidates._circle(mask, (9.0, 11.0))


def test_a_blob_is_placed_in_its_own_box() -> None:
    """Pixel centres are integers, and the box's first pixel is its origin."""
    whole = disc((10.0, 10.0), 10.0, (21, 21)) > 0.5
    circle = boundary(whole)
    assert circle is not None
    np.testing.assert_allclose(circle[0], [10.0, 10.0], atol=0.1)
    assert circle[1] == pytest.approx(10.0, abs=PLACE_PX)
    assert boundary(np.ones((1, 3), bool)) is None  # a contour of four pixels, there and back
