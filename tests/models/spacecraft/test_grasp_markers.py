from __future__ import annotations

import numpy as np
import pytest

from models.camera import camera_preset
from models.materials import MATERIALS
from models.spacecraft.grasp_markers import (
    BOARD,
    BOARD_M,
    CENTRE_M,
    GRASP_MARKERS,
    GRASPING_POINT_M,
    grasp_board_outline,
    maxar1300_grasp,
)
from models.spacecraft.in_colour import COLOURS, in_colour
from models.spacecraft.line_of_sight import is_hidden
from models.spacecraft.maxar1300 import maxar1300
from models.spacecraft.part import Spacecraft

POINTS = GRASP_MARKERS.points_in_target


@pytest.fixture(scope="module")
def craft() -> Spacecraft:
    return maxar1300_grasp()


def test_three_dots_as_the_paper_says() -> None:
    assert len(GRASP_MARKERS) == 3
    assert GRASP_MARKERS.radius_m == 0.01
    assert GRASP_MARKERS.min_separation_m >= 0.1
    assert BOARD_M[:2] == (0.30, 0.10)
    spread = POINTS - POINTS.mean(axis=0)
    assert np.linalg.svd(spread, compute_uv=False)[1] > 0.03  # not in a line
    assert np.ptp(POINTS[:, 2]) > 0.03  # not all in the plane of the face
    assert np.ptp(POINTS[:, 0]) > 3.0 * np.ptp(POINTS[:, 1])  # mostly along x
    inside = np.abs(POINTS[:, :2] - CENTRE_M) + GRASP_MARKERS.radius_m
    assert (inside <= 0.5 * np.array(BOARD_M[:2])).all()


def test_every_dot_is_seen_all_the_way_to_contact(craft: Spacecraft) -> None:
    camera = camera_preset("eye_in_hand")
    assert camera.fx * GRASP_MARKERS.radius_m / 1.4 > 15.0  # px, at the far end
    for place in ([0.0, 0.20, 0.4], [0.05, 0.26, 1.4]):
        lens = np.array(place)
        for point in POINTS:
            way = lens - point
            assert not is_hidden(craft, point + 1e-3 * way, way)


def test_the_frame_is_the_grasping_points(craft: Spacecraft) -> None:
    whole = maxar1300()
    offset = craft.centre_of_mass - whole.centre_of_mass
    assert offset == pytest.approx(-np.array(GRASPING_POINT_M))
    ring, moved = (
        next(part.mesh.bounds for part in each.parts if part.name == "launch_adaptor_ring")
        for each in (whole, craft)
    )
    assert moved == pytest.approx(ring - GRASPING_POINT_M)
    assert moved[1, 2] == pytest.approx(0.0, abs=1e-9)  # the ring's plane


def test_the_board_is_closed_and_black(craft: Spacecraft) -> None:
    board = next(part for part in craft.parts if part.name == BOARD)
    assert board.mesh.volume > 0.0
    paint = MATERIALS[board.material]
    total = np.array(paint.diffuse.bands) + np.array(paint.specular.bands)
    assert ((total > 0.03) & (total < 0.06)).all()  # the 3 to 6 %
    assert paint.is_dielectric  # ever glossier towards grazing


def test_the_outline_is_that_of_the_board(craft: Spacecraft) -> None:
    outline = grasp_board_outline()
    board = next(part for part in craft.parts if part.name == BOARD)
    low, high = board.mesh.bounds
    assert outline.points_in_target[:, :2].min(axis=0) == pytest.approx(low[:2])
    assert outline.points_in_target[:, :2].max(axis=0) == pytest.approx(high[:2])


def test_every_material_of_it_has_a_colour(craft: Spacecraft) -> None:
    coloured = in_colour(craft)
    assert {part.material for part in craft.parts} <= set(COLOURS)
    for name in COLOURS:
        paint = coloured.materials[name]
        assert paint.roughness == MATERIALS[name].roughness
    gold = coloured.materials["mli_gold"]
    red, _, blue = np.array(gold.diffuse.bands) + np.array(gold.specular.bands)
    assert red > 4.0 * blue
    white = coloured.materials["white_paint"].diffuse.bands
    assert max(white) < 1.1 * min(white)
