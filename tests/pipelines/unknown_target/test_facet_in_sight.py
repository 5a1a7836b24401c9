"""Ranges to the triangle about the beam: rays and planes by hand, derivatives by differences."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from pipelines.unknown_target.facet_in_sight import NONE, Facets, facet_in_sight, facet_rows
from pipelines.unknown_target.observation_rows import Placed
from pipelines.unknown_target.unknowns import SHARED

POINTS = np.array([[0.4, 0.1, -1.0], [-0.3, 0.5, -1.2], [-0.2, -0.6, -0.7], [2.0, 2.0, 2.0]])
TURN = Rotation.from_euler("xyz", [6.0, -4.0, 20.0], degrees=True).as_matrix()
AWAY_M = np.array([0.03, -0.02, 9.0])
EVERY = np.ones(4, dtype=bool)
FRAME = np.array([0])
SMALL = 1e-6


def at(turn: Floats, away_m: Floats, seed: int = 0) -> Placed:
    """One epoch, whose place and turn depend on the unknowns in some way."""
    rng = np.random.default_rng(seed)
    return Placed(
        R_cam_from_target=turn[None],
        t_cam_from_target=away_m[None],
        state=np.zeros((1, 6)),
        omega=np.zeros((1, 3)),
        origin_by_place=rng.normal(size=(1, 3, 6)),
        state_by_place=np.zeros((1, 6, 6)),
        turn_by_rest=rng.normal(size=(1, 3, 8)),
        omega_by_rest=np.zeros((1, 3, 8)),
    )


def in_image(points: Floats, turn: Floats = TURN, away_m: Floats = AWAY_M) -> Floats:
    in_cam = points @ turn.T + away_m
    return in_cam[:, :2] / in_cam[:, 2:]


def met_by_hand(points: Floats, turn: Floats, away_m: Floats) -> float:
    """Where the boresight meets the plane of three points, m."""
    a, b, c = points @ turn.T + away_m
    normal = np.cross(b - a, c - a)
    return float(normal @ a / normal[2])


def rows_of(where: Placed, facets: Facets, range_m: float = 8.0, **changes: object):
    used = changes.get("used", EVERY)
    return facet_rows(
        where, POINTS, used, facets, FRAME, np.array([range_m]), np.array([0.02]), 0.1
    )  # fmt: skip


def test_the_triangle_about_the_boresight_is_found_and_weighs_its_corners_to_zero() -> None:
    seen, who = in_image(POINTS[:3]), np.array([7, 4, 9])
    found = facet_in_sight(seen, who)
    assert sorted(found.corners[0]) == [4, 7, 9]
    order = [list(who).index(each) for each in found.corners[0]]
    assert found.share[0].sum() == pytest.approx(1.0)
    assert found.share[0].min() > 0.0
    np.testing.assert_allclose(found.share[0] @ seen[order], 0.0, atol=1e-15)


@pytest.mark.parametrize(
    "seen",
    [
        [[0.1, 0.1], [0.2, 0.1], [0.1, 0.2]],  # all on one side of the beam
        [[0.1, 0.1], [-0.1, -0.1]],
        [[-0.1, 0.0], [0.1, 0.0], [0.2, 0.0]],  # in a line
    ],
)
def test_there_is_none_where_no_triangle_holds_the_beam(seen: list[list[float]]) -> None:
    found = facet_in_sight(np.array(seen), np.arange(len(seen)))
    assert (found.corners == NONE).all()
    assert found.corners.shape == found.share.shape == (1, 3)


def test_the_range_is_to_where_the_beam_meets_the_plane_of_its_corners() -> None:
    facets = facet_in_sight(in_image(POINTS[:3]), np.arange(3))
    rows = rows_of(at(TURN, AWAY_M), facets)
    sides = [np.linalg.norm(POINTS[i] - POINTS[j]) for i, j in ((0, 1), (1, 2), (2, 0))]
    sigma_m = np.hypot(0.02, 0.1 * max(sides))
    expected = (8.0 - met_by_hand(POINTS[:3], TURN, AWAY_M)) / sigma_m
    assert rows.error[0, 0] == pytest.approx(expected, rel=1e-12)
    assert rows.who[0] == facets.corners[0][np.argmax(facets.share[0])]


def test_the_row_is_how_the_depth_of_the_nearest_corner_changes() -> None:
    """By the place, by the turn, which is of body axes, and by the corner itself."""
    facets = facet_in_sight(in_image(POINTS[:3]), np.arange(3))
    where = at(TURN, AWAY_M)
    rows = rows_of(where, facets)
    nearest = POINTS[rows.who[0]]
    sides = [np.linalg.norm(POINTS[i] - POINTS[j]) for i, j in ((0, 1), (1, 2), (2, 0))]
    sigma_m = np.hypot(0.02, 0.1 * max(sides))

    def depth_m(step: Floats, moved: Floats) -> float:
        now = where.moved(step)
        return float((now.R_cam_from_target[0] @ (nearest + moved) + now.t_cam_from_target[0])[2])

    for k in range(SHARED):
        step = np.zeros(SHARED)
        step[k] = SMALL
        slope = (depth_m(step, np.zeros(3)) - depth_m(-step, np.zeros(3))) / (2.0 * SMALL)
        assert rows.by_shared[0, 0, k] * sigma_m == pytest.approx(slope, abs=1e-8)
    for k in range(3):
        moved = SMALL * np.eye(3)[k]
        slope = (depth_m(np.zeros(SHARED), moved) - depth_m(np.zeros(SHARED), -moved)) / (2 * SMALL)
        assert rows.by_point[0, 0, k] * sigma_m == pytest.approx(slope, abs=1e-8)


@pytest.mark.parametrize("case", ["no facet", "a corner is not believed", "behind the camera"])
def test_nothing_is_said_without_a_facet(case: str) -> None:
    facets = facet_in_sight(in_image(POINTS[:3]), np.arange(3))
    used, away_m = EVERY.copy(), AWAY_M
    if case == "no facet":
        facets = Facets.none(1)
    elif case == "a corner is not believed":
        used[1] = False
    else:
        away_m = np.array([0.0, 0.0, 0.9])
    rows = rows_of(at(TURN, away_m), facets, used=used)
    assert np.isnan(rows.error).all()
