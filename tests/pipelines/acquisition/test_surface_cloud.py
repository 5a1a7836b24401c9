"""What a cloud of surface points says is seen and lit, against geometry that anyone can check."""

from __future__ import annotations

import numpy as np
import pytest

from models.arrays import Floats
from models.wireframe.wireframe import Wireframe
from pipelines.acquisition.surface_cloud import nearest_in_cells, sunlight, surface_cloud

GAP_M = 1.0  # between two plates
SHADED = 0.98  # of a shadow's points: the cloud that throws it has a few holes
EDGE_M = 0.15  # a shadow's edge is this blurred: a few cells of the grid


def plates() -> Wireframe:
    """Return a plate of 2 m x 2 m, and half a plate 1 m above it over x > 0."""
    faces = []
    for left, height in ((-1.0, 0.0), (0.0, GAP_M)):
        a, b = np.array([left, -1.0, height]), np.array([1.0, -1.0, height])
        c, d = np.array([1.0, 1.0, height]), np.array([left, 1.0, height])
        faces += [[a, b, c], [a, c, d]]
    points = np.unique(np.array(faces).reshape(-1, 3), axis=0)
    return Wireframe(
        name="plates",
        landmark_names=tuple(f"corner_{k}" for k in range(len(points))),
        points_in_target=points,
        appendage=np.zeros(len(points), dtype=bool),
        edges=np.array([[0, 1]]),
        triangles_in_target=np.array(faces),
    )


WIREFRAME = plates()
CLOUD = surface_cloud(WIREFRAME)
LOWER = CLOUD.points[:, 2] < 0.5 * GAP_M


def unit(x: float, y: float, z: float) -> Floats:
    vector = np.array([x, y, z])
    return np.asarray(vector / np.linalg.norm(vector))


def test_points_are_spread_by_area() -> None:
    assert LOWER.mean() == pytest.approx(2.0 / 3.0, abs=0.001)
    share = (CLOUD.points[LOWER][:, 0] > 0.0).mean()
    assert share == pytest.approx(0.5, abs=0.005)


@pytest.mark.parametrize("tilt", [0.0, 0.4, -0.4])
def test_a_plate_shades_what_lies_behind_it(tilt: float) -> None:
    """Its shadow is moved by the gap times the tangent of the Sun's tilt."""
    sun = unit(tilt, 0.0, 1.0)
    light = sunlight(CLOUD, sun)
    x = CLOUD.points[:, 0]
    shaded = (x > -tilt * GAP_M) & (x < 1.0 - tilt * GAP_M)
    clear = np.minimum(np.abs(x + tilt * GAP_M), np.abs(x - 1.0 + tilt * GAP_M)) > EDGE_M
    clear &= np.abs(CLOUD.points[:, 1]) < 1.0 - EDGE_M
    assert (light[LOWER & clear & shaded] == 0.0).mean() > SHADED
    lit = np.abs(light[LOWER & clear & ~shaded])
    assert (np.abs(lit - sun[2]) < 1e-9).mean() > 0.99
    assert (np.abs(np.abs(light[~LOWER]) - sun[2]) < 1e-9).mean() > 0.99


def test_from_below_the_lower_plate_shines_on_its_other_side() -> None:
    above, below = sunlight(CLOUD, unit(0.0, 0.0, 1.0)), sunlight(CLOUD, unit(0.0, 0.0, -1.0))
    clear = LOWER & (CLOUD.points[:, 0] < -EDGE_M)
    assert np.sign(above[clear]).tolist() == (-np.sign(below[clear])).tolist()
    assert (below[~LOWER] == 0.0).mean() > 0.95


def test_the_nearest_of_a_cell_is_seen() -> None:
    column, row = np.array([0, 0, 1, 5]), np.array([0, 0, 1, 0])
    found = nearest_in_cells(column, row, np.array([2.0, 1.0, 3.0, 0.1]), 2, 2)
    assert found.tolist() == [1, -1, -1, 2]
