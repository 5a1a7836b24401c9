"""Wireframe and mesh of a target are one thing: corners, edges, what hides what, and symmetry."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from models.arrays import Floats, Mask
from models.errors import ScenarioError
from models.pose import RigidTransform
from models.spacecraft import hispasat_layout, solar_wing, xmm_layout
from models.spacecraft.catalogue import SPACECRAFT, spacecraft_by_name
from models.spacecraft.hull import box_outline, is_appendage, sheet_outline, wireframe
from models.spacecraft.wireframes import WIREFRAMES, wireframe_by_name
from models.wireframe.visibility import CLEAR_M, visible_landmarks
from models.wireframe.wireframe import Wireframe

# Landmarks of a sheet lie in the middle of its thickness, its edge members a millimetre outside.
WINGS = (xmm_layout.WING, hispasat_layout.WING, solar_wing.WING)
SHEET_M = 0.5 * max(wing.thickness_m for wing in WINGS) + 0.0011
CORNER_M = 0.005  # of a solid: a third of a pixel at 30 m
AGREED = 0.95  # of the decisions: yokes, antennas, doors and creases are left out of the hull
RANGES_M = {"xmm": 30.0, "hispasat": 40.0, "maxar1300_unmarked": 60.0}
VIEWS = 12
TOWER_TWIN_M = 0.5  # half a turn about z: what stands 0.3 m off the axis is found 0.6 m away
TURNS = [np.diag(2.0 * np.eye(3)[axis] - 1.0) for axis in range(3)]  # half a turn about each axis


@pytest.fixture(scope="module", params=sorted(RANGES_M))
def frame(request: pytest.FixtureRequest) -> Wireframe:
    return wireframe_by_name(request.param)


def triangles_of(name: str) -> Floats:
    parts = spacecraft_by_name(name).parts
    return np.concatenate([np.asarray(part.mesh.triangles) for part in parts])


def distances_to_mesh(triangles: Floats, points: Floats, reach_m: float) -> Floats:
    """Return each point's distance from the mesh, (n,) m; inf for more than ``reach_m``."""
    columns = [triangles[:, :, axis] for axis in range(3)]
    low = [column.min(axis=1) - reach_m for column in columns]
    high = [column.max(axis=1) + reach_m for column in columns]
    found = []
    for point in points:
        near = np.ones(len(triangles), dtype=bool)
        for axis in range(3):
            near &= (low[axis] <= point[axis]) & (point[axis] <= high[axis])
        feet = trimesh.triangles.closest_point(
            triangles[near], np.broadcast_to(point, (int(near.sum()), 3))
        )
        found.append(np.linalg.norm(feet - point, axis=1).min(initial=np.inf))
    return np.array(found)


def is_sheet(names: tuple[str, ...]) -> Mask:
    return np.array([name.startswith("wing") for name in names])


def seen_by_depth(triangles: Floats, points: Floats, cam_from_target: RigidTransform) -> Mask:
    """Tell which points are seen, as a rasteriser does: by depth on the image plane.

    Inverse depth is linear there, so each triangle that covers a point's image is met where the
    barycentric mean of its corners' inverse depths says.
    """
    in_cam = cam_from_target @ triangles.reshape(-1, 3)
    inverse = (1.0 / in_cam[:, 2]).reshape(-1, 3)
    x, y = (inverse * in_cam[:, axis].reshape(-1, 3) for axis in (0, 1))
    (left, right), (low, high) = ((a.min(axis=1), a.max(axis=1)) for a in (x, y))
    seen = []
    for point in cam_from_target @ points:
        u, v = point[:2] / point[2]
        over = (left <= u) & (u <= right) & (low <= v) & (v <= high)
        du, dv = x[over] - u, y[over] - v
        # Twice the areas that the point makes with the sides opposite to each corner.
        after, before = (1, 2, 0), (2, 0, 1)
        weights = du[:, after] * dv[:, before] - du[:, before] * dv[:, after]
        total = weights.sum(axis=1)
        covers = (weights * np.sign(total)[:, None] >= 0.0).all(axis=1) & (total != 0.0)
        depth = total[covers] / (weights[covers] * inverse[over][covers]).sum(axis=1)
        clear = (CLEAR_M + 0.02) * point[2] / np.linalg.norm(point)  # creases rise up to 2 cm
        seen.append(not (depth < point[2] - clear).any())
    return np.array(seen)


def looking(name: str, seed: int) -> RigidTransform:
    turn = Rotation.random(random_state=seed).as_matrix()
    return RigidTransform(turn, np.array([0.0, 0.0, RANGES_M[name]]))


def test_every_wireframe_is_of_a_spacecraft() -> None:
    assert set(WIREFRAMES) <= set(SPACECRAFT)
    assert all(wireframe_by_name(name).name == name for name in WIREFRAMES)


def test_an_unknown_name_is_answered_with_those_there_are() -> None:
    with pytest.raises(
        ScenarioError, match=r"maxar1300_grasp, maxar1300_unmarked, xmm, got 'chaser'"
    ):
        wireframe_by_name("chaser")


def test_landmarks_are_corners_of_the_mesh(frame: Wireframe) -> None:
    vertices = triangles_of(frame.name).reshape(-1, 3)
    distance, _ = cKDTree(vertices).query(frame.points_in_target)
    limit = np.where(is_sheet(frame.landmark_names), SHEET_M, CORNER_M)
    assert (distance <= limit + 1e-9).all()


def test_edges_run_along_the_mesh(frame: Wireframe) -> None:
    start, end = np.moveaxis(frame.points_in_target[frame.edges], 1, 0)
    points = np.concatenate([start + share * (end - start) for share in (0.19, 0.47, 0.83)])
    on_sheet = np.tile(is_sheet(frame.landmark_names)[frame.edges[:, 0]], 3)
    # Panels of a wing stand 4 cm apart: in such a gap an edge is 2 cm from either.
    limit = np.where(on_sheet, SHEET_M + 0.02, CORNER_M)
    assert (distances_to_mesh(triangles_of(frame.name), points, 0.05) <= limit + 1e-9).all()


def test_landmarks_lie_apart_and_all_have_edges(frame: Wireframe) -> None:
    pairs = cKDTree(frame.points_in_target).query_pairs(0.3)
    assert not pairs  # 0.3 m is 16 px at 40 m: no detector takes two for one
    assert set(frame.edges.ravel()) == set(range(len(frame)))


def test_hull_hides_what_the_mesh_hides_and_hardly_more(frame: Wireframe) -> None:
    triangles = triangles_of(frame.name)
    poses = [looking(frame.name, seed) for seed in range(VIEWS)]
    by_mesh = np.array([seen_by_depth(triangles, frame.points_in_target, pose) for pose in poses])
    by_hull = np.array([visible_landmarks(frame, pose) for pose in poses])
    assert 0.3 < by_hull.mean() < 0.9
    assert (by_mesh == by_hull).mean() > AGREED
    # A hull larger than the craft would hide corners that an image shows.
    assert (by_mesh & ~by_hull).mean() < 0.01


def test_appendages_are_wings_and_what_stands_as_far_out(frame: Wireframe) -> None:
    chosen = {
        name for name, apart in zip(frame.landmark_names, frame.appendage, strict=True) if apart
    }
    expected = ("wing", "focal_plane") if frame.name == "xmm" else ("wing",)
    assert chosen == {name for name in frame.landmark_names if name.startswith(expected)}


def test_a_component_is_apart_as_a_whole_or_not_at_all() -> None:
    points = np.array([[1.0, 0, 0], [9.0, 0, 0], [2.0, 0, 0], [2.5, 0, 0]])
    apart = is_appendage(points, ["wing", "wing", "body", "body"])
    assert apart.tolist() == [True, True, False, False]


def test_stated_symmetries_carry_the_wireframe_onto_itself(frame: Wireframe) -> None:
    for turn in frame.symmetries:
        assert misfit_m(frame, turn).max() < CORNER_M


def misfit_m(frame: Wireframe, turn: Floats) -> Floats:
    """How far each landmark, turned, lies from the nearest one, (m,) m."""
    distance, _ = cKDTree(frame.points_in_target).query(frame.points_in_target @ turn.T)
    return np.asarray(distance)


def test_no_half_turn_is_a_symmetry_though_some_come_near(frame: Wireframe) -> None:
    assert frame.symmetries == ()
    least_m = TOWER_TWIN_M if frame.name == "maxar1300_unmarked" else 0.9
    assert all(misfit_m(frame, turn).max() > least_m for turn in TURNS)
    nearest = {"xmm": TURNS[0], "hispasat": TURNS[1], "maxar1300_unmarked": TURNS[2]}[frame.name]
    assert misfit_m(frame, nearest).max() < 1.6
    assert np.median(misfit_m(frame, nearest)) < 0.5


def test_but_for_what_is_on_its_earth_deck_half_a_turn_carries_the_maxar_onto_itself() -> None:
    frame = wireframe_by_name("maxar1300_unmarked")
    off_m = misfit_m(frame, TURNS[2])
    of_tower = np.array([name.startswith("tower") for name in frame.landmark_names])
    assert of_tower.sum() == 2
    assert off_m[~of_tower].max() < 1e-9
    assert off_m[of_tower].min() > TOWER_TWIN_M


def test_xmm_mirrors_itself_in_the_plane_of_telescope_and_sun() -> None:
    frame = wireframe_by_name("xmm")
    assert misfit_m(frame, np.diag([1.0, -1.0, 1.0])).max() < 1e-9


def test_outlines_that_share_a_corner_share_a_landmark() -> None:
    square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    folded = [[1, 0, 0], [1, 0, 1], [1, 1, 1], [1, 1, 0]]
    joint = wireframe(
        "fold",
        [
            sheet_outline("fold", ("a", "b", "c", "d"), square),
            sheet_outline("fold", ("b", "e", "f", "c"), folded),
        ],
    )
    assert joint.landmark_names == ("a", "b", "c", "d", "e", "f")
    assert len(joint.edges) == 7
    assert joint.triangles_in_target.shape == (4, 3, 3)


def test_box_outline_has_edges_along_the_axes_and_closed_faces() -> None:
    outline = box_outline("crate", (-1, -2, -3), (1, 2, 3))
    assert outline.names[0] == "crate_minus_x_minus_y_minus_z"
    assert (outline.points[0] == [-1, -2, -3]).all()
    steps = outline.points[[i for i, _ in outline.edges]]
    steps = steps - outline.points[[j for _, j in outline.edges]]
    assert len(steps) == 12
    assert ((steps != 0.0).sum(axis=1) == 1).all()
    sides = outline.triangles[:, 1:] - outline.triangles[:, :1]
    area = 0.5 * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    assert area.sum() == pytest.approx(2 * (2 * 4 + 4 * 6 + 2 * 6))
