"""Nearest neighbour as printed, and one-to-one where it fails."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from models.arrays import Floats, Indices
from pipelines.pnp.identification import nearest_neighbour, one_to_one

coordinates = st.tuples(st.floats(0.0, 500.0), st.floats(0.0, 500.0))


def squared_gaps(points: Floats, markers: Floats) -> Floats:
    return ((points[:, None] - markers[None, :]) ** 2).sum(axis=-1)


def assigned(points: Floats, markers: Floats, gate_px: float) -> Indices:
    gaps = squared_gaps(points, markers)
    return one_to_one(gaps / gate_px**2, gaps < gate_px**2)


def test_both_match_what_is_plain() -> None:
    markers = np.array([[10.0, 10.0], [100.0, 10.0], [50.0, 90.0]])
    points = markers[[2, 0, 1]] + 3.0
    assert nearest_neighbour(points, markers, 20.0).tolist() == [2, 0, 1]
    assert assigned(points, markers, 20.0).tolist() == [2, 0, 1]


def test_a_common_shift_defeats_the_nearest_neighbour_but_not_the_assignment() -> None:
    """A row of markers 60 px apart, seen 40 px aside: each stands nearest to its neighbour."""
    markers = np.stack([60.0 * np.arange(5), np.zeros(5)], axis=-1)
    points = markers + np.array([40.0, 0.0])
    nearest = nearest_neighbour(points, markers, 131.0)
    assert nearest.tolist() != [0, 1, 2, 3, 4]
    assert assigned(points, markers, 131.0).tolist() == [0, 1, 2, 3, 4]


def test_of_two_claims_the_nearer_stands() -> None:
    markers = np.array([[0.0, 0.0]])
    points = np.array([[5.0, 0.0], [2.0, 0.0]])
    assert nearest_neighbour(points, markers, 20.0).tolist() == [-1, 0]


def test_beyond_the_gate_there_is_no_match() -> None:
    markers, points = np.zeros((1, 2)), np.array([[20.0, 0.0]])
    assert nearest_neighbour(points, markers, 20.0).tolist() == [-1]
    assert assigned(points, markers, 20.0).tolist() == [-1]


def test_markers_that_cannot_be_seen_match_nothing() -> None:
    markers, points = np.array([[np.nan, np.nan], [1.0, 1.0]]), np.array([[0.0, 0.0]])
    assert nearest_neighbour(points, markers, 20.0).tolist() == [1]
    assert nearest_neighbour(points, markers[:1], 20.0).tolist() == [-1]


@given(st.lists(coordinates, max_size=12), st.lists(coordinates, max_size=10))
def test_the_assignment_is_one_to_one_within_the_gate(
    points_px: list[tuple[float, float]], markers_px: list[tuple[float, float]]
) -> None:
    points, markers = np.reshape(points_px, (-1, 2)), np.reshape(markers_px, (-1, 2))
    for matched in (assigned(points, markers, 80.0), nearest_neighbour(points, markers, 80.0)):
        taken = matched[matched >= 0]
        assert len(matched) == len(points)
        assert len(set(taken.tolist())) == len(taken)
        gaps = np.linalg.norm(points[matched >= 0] - markers[taken], axis=-1)
        assert (gaps < 80.0).all()


@given(st.lists(coordinates, min_size=1, max_size=7), st.lists(coordinates, min_size=1, max_size=7))
def test_the_assignment_matches_no_fewer_than_the_nearest_neighbour(
    points_px: list[tuple[float, float]], markers_px: list[tuple[float, float]]
) -> None:
    points, markers = np.array(points_px), np.array(markers_px)
    best = np.count_nonzero(assigned(points, markers, 80.0) >= 0)
    assert best >= np.count_nonzero(nearest_neighbour(points, markers, 80.0) >= 0)
