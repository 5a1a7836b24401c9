"""Poses from one drawing, without any earlier one."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.motion.relative_state import ChaserState
from models.pose import RigidTransform
from pipelines.acquisition.from_image import (
    ImageAcquirer,
    ImageAcquisition,
    ImageAcquisitionOptions,
    reduced,
)
from pipelines.acquisition.view_sphere import (
    directions_all_around,
    look_from,
    pose_from_view,
    view_sphere,
)
from pipelines.uncooperative.image_pose_finder import ImagePoseFinder
from pipelines.uncooperative.knowledge import ImageFrame, UncooperativeKnowledge
from pipelines.uncooperative.options import options_for
from tests.support.drawn_targets import CAMERA, DETECTOR, drawn, target

WIREFRAME = target()
RUNS = (1, 2, 4)
RANGE_M = (9.0, 15.0)
OPTIONS = ImageAcquisitionOptions(directions=400, views=24, more_views=24)
RIGHT_DEG, RIGHT_M = 2.0, 0.1
VIEWS_APART_DEG = 9.0  # 800 directions, evenly, are 7.7 deg apart


def pose_of(run: int) -> RigidTransform:
    rng = np.random.default_rng([1, run])
    rotation = Rotation.random(random_state=rng).as_matrix()
    return RigidTransform(rotation, np.array([*rng.uniform(-0.5, 0.5, 2), rng.uniform(10, 13)]))


def is_right(found: RigidTransform, truth: RigidTransform) -> bool:
    turn = Rotation.from_matrix(found.rotation @ truth.rotation.T).magnitude()
    near = bool(np.linalg.norm(found.translation - truth.translation) < RIGHT_M)
    return bool(np.rad2deg(turn) < RIGHT_DEG) and near


def test_a_reduced_image_keeps_its_light_and_its_rays() -> None:
    """Light that grows along both axes, by what the camera says of where each pixel looks."""
    rows, columns = np.mgrid[0 : CAMERA.height, 0 : CAMERA.width]
    image = np.rint(500.0 + 2.0 * columns + 1.0 * rows).astype(np.uint16)
    small, camera = reduced(image, CAMERA, CAMERA.width // 4)
    assert small.dtype == np.uint16
    assert small.shape == (camera.height, camera.width) == (CAMERA.height // 4, CAMERA.width // 4)
    assert small.mean() == pytest.approx(image.mean(), abs=0.5)
    point = np.array([[0.1, -0.05, 1.0]])
    (x, y), (u, v) = CAMERA.project(point)[0], camera.project(point)[0]
    level = float(small[round(v), round(u)]) + 4.0 * (2.0 * (u - round(u)) + (v - round(v)))
    assert level == pytest.approx(500.0 + 2.0 * x + y, abs=1.0)
    same, whole = reduced(image, CAMERA, CAMERA.width)
    assert same is image
    assert whole is CAMERA


@pytest.fixture(scope="module")
def acquirer() -> ImageAcquirer:
    return ImageAcquirer(WIREFRAME, CAMERA, DETECTOR, RANGE_M, OPTIONS)


@pytest.fixture(scope="module")
def outcomes(acquirer: ImageAcquirer) -> list[ImageAcquisition]:
    return [acquirer.acquire(drawn(WIREFRAME, pose_of(run), seed=run)) for run in RUNS]


def test_most_poses_are_found_and_none_is_wrong(outcomes: list[ImageAcquisition]) -> None:
    right = [
        is_right(one.found.fit.cam_from_target, pose_of(run))
        for run, one in zip(RUNS, outcomes, strict=True)
        if one.found is not None
    ]
    assert all(right)
    assert len(right) >= len(RUNS) - 1
    assert all(one.found is not None or one.reason for one in outcomes)


def test_without_a_coarse_range_the_poses_are_the_same(outcomes: list[ImageAcquisition]) -> None:
    """How large it looks tells how far it is."""
    alone = ImageAcquirer(WIREFRAME, CAMERA, DETECTOR, None, OPTIONS)
    found = [one for one in outcomes if one.found is not None]
    run = RUNS[outcomes.index(found[0])]
    outcome = alone.acquire(drawn(WIREFRAME, pose_of(run), seed=run))
    assert outcome.found is not None, outcome.reason
    assert is_right(outcome.found.fit.cam_from_target, pose_of(run))


def test_an_empty_sky_gives_a_reason(acquirer: ImageAcquirer) -> None:
    sky = np.full((CAMERA.height, CAMERA.width), 100, dtype=np.uint16)
    outcome = acquirer.acquire(sky)
    assert outcome.found is None
    assert "stands out" in outcome.reason


def test_a_strange_target_is_refused(acquirer: ImageAcquirer) -> None:
    """A plain disc fits no view of a box with a block and a plate."""
    v, u = np.mgrid[0 : CAMERA.height, 0 : CAMERA.width]
    disc = np.where(np.hypot(u - 130.0, v - 120.0) < 40.0, 1500, 100)
    assert acquirer.acquire(disc.astype(np.uint16)).found is None


def test_directions_are_spread_evenly() -> None:
    directions = directions_all_around(800)
    near = np.sort(directions @ directions.T, axis=1)[:, -2]
    assert np.allclose(np.linalg.norm(directions, axis=1), 1.0)
    assert np.rad2deg(np.arccos(near)).max() < VIEWS_APART_DEG


def test_a_view_put_back_where_it_was_is_the_pose() -> None:
    range_m = float(np.sqrt(RANGE_M[0] * RANGE_M[1]))
    sphere = view_sphere(WIREFRAME, range_m, OPTIONS.directions)  # the acquirer's, kept
    view = sphere.views[100]
    same = pose_from_view(view, 0.0, view.centroid, view.gyration)
    assert np.allclose(same.rotation, view.cam_from_target.rotation)
    assert np.allclose(same.translation, [0.0, 0.0, range_m])
    half = pose_from_view(view, 0.3, np.zeros(2), 0.5 * view.gyration)
    assert np.linalg.norm(half.translation) == pytest.approx(2.0 * range_m)
    looking = look_from(np.array([0.0, 1.0, 0.0]), range_m)
    assert np.allclose(looking.inverse().translation, [0.0, range_m, 0.0])


def test_the_finder_says_a_pose_with_named_corners() -> None:
    still = ChaserState(0.0, np.zeros(3), np.zeros(3))
    mount = RigidTransform.identity()
    knowledge = UncooperativeKnowledge(CAMERA, WIREFRAME, mount, sigma_px=1.0, detector=DETECTOR)
    finder = ImagePoseFinder(knowledge, options_for("best"))
    run = 2
    frame = ImageFrame(0, 0.0, drawn(WIREFRAME, pose_of(run), seed=run), still)
    covariance = np.diag([0.02**2] * 3 + [0.05**2] * 3)
    estimate = finder.track(frame, pose_of(run), covariance)
    assert estimate.pose is not None
    assert is_right(estimate.pose.cam_from_target, pose_of(run))
    assert finder.matched_share(frame, estimate) > 0.8
    named = [k for k in estimate.detected.marker if k >= 0]
    assert len(named) == len(set(named)) >= 6
    truth_px = CAMERA.project(pose_of(run) @ WIREFRAME.points_in_target)
    for point, marker in zip(estimate.detected.points_px, estimate.detected.marker, strict=True):
        if marker >= 0:
            assert np.linalg.norm(point - truth_px[marker]) < 3.0
    dark = ImageFrame(1, 1.0, np.full((256, 256), 100, np.uint16), still)
    lost = finder.track(dark, pose_of(run), covariance)
    assert not lost
    assert lost.reason
    assert finder.matched_share(dark, lost) == 0.0
