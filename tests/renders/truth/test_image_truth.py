"""The truth of single images: it comes back, and says which landmarks the lens really sees."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from models.camera import Camera
from models.errors import DatasetError
from models.motion.relative_state import ChaserState, RelativeState
from models.pose import RigidTransform
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from models.wireframe.wireframe import Wireframe
from renders.truth.image_truth import ImageTruth, read_image_truths
from tests.support.small_scenes import activate_best

CAMERA = Camera.from_fov(64, 64, 50.0)
SIDE_M = 2.0
SIGNS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
NAMES = tuple("".join("-+"[int(s > 0)] for s in row) for row in SIGNS)
CUBE = Wireframe(
    "cube", NAMES, 0.5 * SIDE_M * SIGNS, np.zeros(8, dtype=bool), np.empty((0, 2), int),
    np.empty((0, 3, 3)),
)  # fmt: skip


def truth_of(frame: int) -> ImageTruth:
    state = RelativeState(
        frame / 3.0, np.array([0.0, 30.0, 1 / 3]), np.zeros(3), np.eye(3), np.ones(3) / 70.0
    )
    return ImageTruth(
        frame=frame,
        time_s=frame / 3.0,
        cam_from_target=RigidTransform.identity().perturbed([0.1, 0.2, 0.3], np.ones(3) / 3.0),
        state=state,
        chaser=ChaserState(frame / 3.0, np.array([7e6, 1 / 3, 0.0]), np.array([0.0, 7e3, 1.0])),
        sun_dir_in_target=np.array([0.6, 0.0, 0.8]),
        earth_dir_in_target=np.array([-1.0, 0.0, 0.0]),
        landmarks_px=np.array([[1 / 3, 2.0], [np.nan, np.nan]]),
        landmarks_visible=np.array([True, False]),
    )


def written(folder: Path, lines: list[str]) -> Path:
    (folder / "truth").mkdir()
    (folder / "truth" / "exposures.jsonl").write_text("".join(line + "\n" for line in lines))
    return folder


def test_truth_comes_back_to_the_last_bit(tmp_path: Path) -> None:
    truths = [truth_of(0), truth_of(7)]
    back = read_image_truths(written(tmp_path, [json.dumps(t.to_json()) for t in truths]))
    assert list(back) == [0, 7]
    for truth in truths:
        read = back[truth.frame]
        assert read.time_s == truth.time_s == read.chaser.time_s == read.state.time_s
        np.testing.assert_array_equal(read.cam_from_target.matrix(), truth.cam_from_target.matrix())
        np.testing.assert_array_equal(read.state.rho_in_lvlh, truth.state.rho_in_lvlh)
        np.testing.assert_array_equal(
            read.chaser.position_in_inertial, truth.chaser.position_in_inertial
        )
        np.testing.assert_array_equal(read.landmarks_px, truth.landmarks_px)
        np.testing.assert_array_equal(read.landmarks_visible, truth.landmarks_visible)
        assert read.landmarks_visible.dtype == np.bool_
        np.testing.assert_array_equal(read.sun_dir_in_target, truth.sun_dir_in_target)


def test_damaged_or_absent_truth_is_named(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="expected the truth half"):
        read_image_truths(tmp_path)
    folder = written(tmp_path, [json.dumps(truth_of(0).to_json()), '{"frame": 1}'])
    with pytest.raises(DatasetError, match=r"exposures\.jsonl:2: expected one exposure"):
        read_image_truths(folder)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("frame", 0.5),
        ("frame", -1),
        ("time_s", True),
        ("time_s", 1e200),
        ("R_cam_from_target", np.zeros((3, 3)).tolist()),
        ("sun_dir_in_target", [0.6, 0.0, 0.9]),
        ("landmarks_visible", [True]),
        ("landmarks_px", [[1.0, None, 2.0]]),
        ("landmarks_visible", [1, 0]),
        ("state", None),
    ],
)
def test_truth_that_cannot_be_is_refused_by_line_and_key(
    key: str, value: object, tmp_path: Path
) -> None:
    broken = truth_of(1).to_json() | {key: value}
    folder = written(tmp_path, [json.dumps(truth_of(0).to_json()), json.dumps(broken)])
    with pytest.raises(DatasetError, match=rf"exposures\.jsonl:2: expected one exposure: {key}"):
        read_image_truths(folder)


def test_a_frame_comes_once(tmp_path: Path) -> None:
    folder = written(tmp_path, 2 * [json.dumps(truth_of(0).to_json())])
    with pytest.raises(DatasetError, match=r"jsonl:2: expected each frame and band once.* line 1"):
        read_image_truths(folder)


def test_of_a_cube_the_lens_sees_the_corners_of_the_faces_towards_it() -> None:
    """A corner of a convex body is seen if any of its three faces looks at the lens."""
    activate_best()
    from renders.tracing.scene import build_geometry
    from renders.truth.landmark_truth import seen_landmarks

    mesh = trimesh.creation.box((SIDE_M, SIDE_M, SIDE_M))
    cube = Spacecraft("cube", (Part("cube", mesh, "white_paint"),), None, np.zeros(3))
    scene = build_geometry(cube, None, RetroreflectorOptics()).scene()
    counts = set()
    for turn in ([0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.5, 0.6, 0.1], [2.0, 1.0, -1.0]):
        pose = RigidTransform(np.eye(3), np.zeros(3)).perturbed(turn, [0.0, 0.0, 10.0])
        lens = pose.inverse().translation
        expected = [
            any(sign * lens[axis] > 0.5 * SIDE_M for axis, sign in enumerate(corner))
            for corner in SIGNS
        ]
        seen = seen_landmarks(scene, CUBE, CAMERA, pose)
        np.testing.assert_array_equal(seen, expected)
        counts.add(int(seen.sum()))
    assert counts == {4, 6, 7}  # facing one, two and three faces


def test_a_corner_beyond_the_lenss_fold_is_not_seen() -> None:
    """Corners of a cube 50 deg off axis, whose pixels would fold back into the image."""
    activate_best()
    from renders.tracing.scene import build_geometry
    from renders.truth.landmark_truth import seen_landmarks

    far = trimesh.creation.box((0.1, 0.1, 0.1)).apply_translation([0.0, 0.0, -50.0])
    speck = Spacecraft("speck", (Part("speck", far, "white_paint"),), None, np.zeros(3))
    scene = build_geometry(speck, None, RetroreflectorOptics()).scene()
    camera = replace(CAMERA, k1=-0.33)
    pose = RigidTransform(np.eye(3), np.array([2.0, 0.0, 2.2]))
    in_cam = pose @ CUBE.points_in_target
    ideal = in_cam[:, :2] / in_cam[:, 2:]
    folded = camera.distort(ideal) * [camera.fx, camera.fy] + [camera.cx, camera.cy]
    beyond = np.linalg.norm(ideal, axis=1) > camera.fold_radius
    assert (beyond & camera.contains(folded)).any()  # the polynomial alone brings some back
    seen = seen_landmarks(scene, CUBE, camera, pose)
    assert not (seen & beyond).any()
    np.testing.assert_array_equal(seen, camera.contains(camera.project(in_cam)))


def test_a_corner_beside_the_image_or_behind_the_lens_is_not_seen() -> None:
    activate_best()
    from renders.tracing.scene import build_geometry
    from renders.truth.landmark_truth import seen_landmarks

    far = trimesh.creation.box((0.1, 0.1, 0.1)).apply_translation([50.0, 0.0, 0.0])
    speck = Spacecraft("speck", (Part("speck", far, "white_paint"),), None, np.zeros(3))
    scene = build_geometry(speck, None, RetroreflectorOptics()).scene()
    aside = RigidTransform(np.eye(3), np.array([6.0, 0.0, 10.0]))
    in_image = CAMERA.contains(CAMERA.project(aside @ CUBE.points_in_target))
    np.testing.assert_array_equal(seen_landmarks(scene, CUBE, CAMERA, aside), in_image)
    assert 0 < in_image.sum() < 8
    behind = RigidTransform(np.eye(3), np.array([0.0, 0.0, -10.0]))
    assert not seen_landmarks(scene, CUBE, CAMERA, behind).any()
