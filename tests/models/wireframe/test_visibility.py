"""A corner is seen when nothing stands before it: closed forms for boxes and plates, and laws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.arrays import Floats, Mask
from models.pose import RigidTransform
from models.spacecraft.hull import Outline, box_outline, hiding, sheet_outline, wireframe
from models.spacecraft.solids import box
from models.spacecraft.wireframes import wireframe_by_name
from models.wireframe.visibility import visible_edge_pieces, visible_landmarks, visible_points
from models.wireframe.wireframe import Wireframe

SIZE = np.array([2.0, 3.0, 4.0])
CRATE = wireframe("crate", [box_outline("crate", -0.5 * SIZE, 0.5 * SIZE)])
THIN_M = 0.026  # the plate's corners lie 1.41 m out: twice a hundredth of it is one corner still
FACE_ON_M = 0.4  # nearer to a face's plane than this, a corner's own clearance blurs the answer


def looking_at_origin(direction: Floats, range_m: float) -> RigidTransform:
    """Return a camera at ``range_m`` along a direction, looking back."""
    z = -direction / np.linalg.norm(direction)
    helper = np.eye(3)[np.abs(z).argmin()]
    x = np.cross(helper, z)
    x /= np.linalg.norm(x)
    return RigidTransform(np.stack([x, np.cross(z, x), z]), np.array([0.0, 0.0, range_m]))


def seen_of_a_convex_box(camera: Floats) -> Mask:
    """Tell which corners are seen: those with one of their three faces turned to the camera."""
    signs = np.sign(CRATE.points_in_target)
    faces = signs * (camera - CRATE.points_in_target) > 0.0
    return np.asarray(faces.any(axis=1))


@given(st.integers(0, 10_000), st.floats(5.0, 60.0))
def test_a_box_shows_the_corners_of_the_faces_it_turns_to_the_camera(
    seed: int, range_m: float
) -> None:
    direction = Rotation.random(random_state=seed).as_matrix()[0]
    camera = range_m * direction
    if (np.abs(np.abs(camera) - 0.5 * SIZE) < FACE_ON_M).any():
        return
    seen = visible_landmarks(CRATE, looking_at_origin(direction, range_m))
    assert (seen == seen_of_a_convex_box(camera)).all()
    assert seen.sum() in {4, 6, 7}  # one, two or three faces


def test_behind_the_camera_nothing_is_seen() -> None:
    pose = RigidTransform(np.eye(3), np.array([0.0, 0.0, -30.0]))
    assert not visible_landmarks(CRATE, pose).any()
    assert not visible_edge_pieces(CRATE, pose).visible.any()


def plate(z: float) -> Outline:
    return sheet_outline(
        "plate", ("a", "b", "c", "d"), [[-1, -1, z], [1, -1, z], [1, 1, z], [-1, 1, z]]
    )


@pytest.mark.parametrize(("screen_z", "hidden"), [(-5.0, True), (5.0, False), (-40.0, False)])
def test_a_screen_hides_only_from_between(screen_z: float, hidden: bool) -> None:
    screen = hiding(box((6.0, 6.0, 0.1), (0.0, 0.0, screen_z)))
    frame = wireframe("plate", [plate(0.0), screen])
    pose = RigidTransform(np.eye(3), np.array([0.0, 0.0, 30.0]))
    assert (visible_landmarks(frame, pose) == (not hidden)).all()
    assert (visible_edge_pieces(frame, pose).visible == (not hidden)).all()


def test_a_narrow_screen_hides_the_middle_of_an_edge_and_not_its_ends() -> None:
    screen = hiding(box((0.5, 6.0, 0.1), (0.0, 0.0, -10.0)))
    frame = wireframe("plate", [plate(0.0), screen])
    pieces = visible_edge_pieces(frame, RigidTransform(np.eye(3), np.array([0.0, 0.0, 30.0])), 41)
    (across,) = np.flatnonzero((frame.edges == [0, 1]).all(axis=1))
    x = pieces.points_in_target[across, :, 0]
    # Seen from 30 m, a screen 10 m nearer throws a shadow half as wide again.
    assert (pieces.visible[across] == (np.abs(x) > 0.25 * 30.0 / 19.95)).all()


def test_a_sheet_is_seen_from_both_sides_and_hides_neither_side_of_itself() -> None:
    frame = wireframe("plate", [plate(0.0)])
    for side in (1.0, -1.0):
        direction = np.array([0.3, 0.2, side])
        assert visible_landmarks(frame, looking_at_origin(direction, 30.0)).all()


@given(st.integers(0, 10_000), st.sampled_from(["xmm", "hispasat"]))
def test_edges_are_judged_as_the_points_on_them(seed: int, name: str) -> None:
    frame = wireframe_by_name(name)
    turn = Rotation.random(random_state=seed).as_matrix()
    pose = RigidTransform(turn, np.array([1.0, -2.0, 30.0]))
    pieces = visible_edge_pieces(frame, pose, 5)
    alone = visible_points(frame, pieces.points_in_target.reshape(-1, 3), pose)
    assert (pieces.visible.ravel() == alone).all()
    ends = visible_landmarks(frame, pose)[frame.edges]
    assert (pieces.visible[:, [0, -1]] == ends).all()


@given(st.integers(0, 10_000))
def test_what_is_seen_does_not_hang_on_the_frame(seed: int) -> None:
    # Turning target and camera together changes nothing.
    frame = wireframe_by_name("hispasat")
    pose = looking_at_origin(Rotation.random(random_state=seed).as_matrix()[1], 40.0)
    roll = Rotation.from_euler("z", 0.1 + seed).as_matrix()
    rolled = RigidTransform(roll @ pose.rotation, roll @ pose.translation)
    assert (visible_landmarks(frame, pose) == visible_landmarks(frame, rolled)).all()


def test_one_sample_is_no_edge() -> None:
    pose = RigidTransform(np.eye(3), np.array([0.0, 0.0, 30.0]))
    with pytest.raises(ValueError, match="at least 2 samples along an edge, got 1"):
        visible_edge_pieces(CRATE, pose, 1)


def between_two_sides(thickness_m: float) -> Wireframe:
    """Return a panel of two sides, its corners midway between them, as one is found on a mesh."""
    flat = wireframe("panel", [plate(0.0)])
    shift = np.array([0.0, 0.0, 0.5 * thickness_m])
    sides = [flat.triangles_in_target + shift, flat.triangles_in_target - shift]
    return replace(flat, triangles_in_target=np.concatenate(sides))


@given(st.floats(6.0, 85.0), st.floats(0.0, 360.0), st.sampled_from([1.0, -1.0]))
def test_the_sides_of_a_thin_panel_do_not_hide_its_edges(
    height_deg: float, around_deg: float, side: float
) -> None:
    """From any height above it: no ray's length within a side may decide."""
    height, around = np.deg2rad([height_deg, around_deg])
    level = np.cos(height) * np.array([np.cos(around), np.sin(around)])
    pose = looking_at_origin(np.array([*level, side * np.sin(height)]), 30.0)
    assert visible_edge_pieces(between_two_sides(THIN_M), pose).visible.all()


def test_of_a_thick_one_the_near_side_hides_the_two_edges_beyond_it() -> None:
    pose = looking_at_origin(np.array([0.3, 0.2, 1.0]), 30.0)
    shown = visible_edge_pieces(between_two_sides(0.2), pose).visible.mean(axis=1)
    assert sorted(np.round(shown)) == [0.0, 0.0, 1.0, 1.0]
