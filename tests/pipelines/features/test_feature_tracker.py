"""Features of a tumbling cube with a texture: tracks stay on their places, and say how well."""

import cv2
import numpy as np
import pytest

from pipelines.features.feature_tracker import FeatureTracker
from pipelines.features.klt_step import follow
from pipelines.features.rigid_motion_check import moves_rigidly
from tests.support.textured_cube import CAMERA, drawn, place_of, pose_at, textures

FRAMES = 30
FACES = textures()


@pytest.fixture(scope="module")
def seen():
    tracker = FeatureTracker(CAMERA)
    return [tracker.track(drawn(pose_at(k), FACES, k)) for k in range(FRAMES)]


def errors_px(seen):
    """Return each sighting's distance from its place, in px and in sigmas, and its track's age."""
    places, ages, rows = {}, {}, []
    for frame, features in enumerate(seen):
        for name, point, sigma in zip(
            features.names.tolist(), features.points_px, features.sigma_px, strict=True
        ):
            if name not in places:
                places[name], ages[name] = place_of(pose_at(frame), point), frame
            expected = CAMERA.project(pose_at(frame) @ places[name])
            away = np.linalg.norm(point - expected)
            rows.append((away, away / (sigma * np.sqrt(2.0)), frame - ages[name]))
    return np.array(rows)


def test_many_tracks_live_long(seen):
    assert min(len(features.names) for features in seen) > 60
    ages = errors_px(seen)[:, 2]
    assert np.quantile(ages, 0.9) > 12


def test_tracks_stay_on_their_places(seen):
    away = errors_px(seen)
    away = away[away[:, 2] > 0]
    assert np.nanmedian(away[:, 0]) < 0.12
    assert np.nanquantile(away[:, 0], 0.9) < 1.5  # beside an edge a patch is of two faces


def test_stated_sigmas_are_of_the_size_of_errors(seen):
    away = errors_px(seen)
    old = away[away[:, 2] >= 5]
    assert 0.4 < np.nanmedian(old[:, 1]) < 2.5  # 0.83 of an honest Gaussian


def test_a_track_has_one_place_at_a_time(seen):
    for features in seen:
        assert len(np.unique(features.names)) == len(features.names)


def test_places_are_known_again_after_darkness():
    """Five black frames, then the same view as before: names come back, to their own places."""
    tracker = FeatureTracker(CAMERA)
    before = [tracker.track(drawn(pose_at(0), FACES, k)) for k in range(2)][-1]
    dark = np.full((CAMERA.height, CAMERA.width), 200, dtype=np.uint16)
    for _ in range(5):
        assert len(tracker.track(dark).names) == 0
    after = tracker.track(drawn(pose_at(1), FACES, 9))
    places = {
        name: place_of(pose_at(0), point)
        for name, point in zip(before.names.tolist(), before.points_px, strict=True)
    }
    found = [
        np.linalg.norm(CAMERA.project(pose_at(1) @ places[name]) - point)
        for name, point in zip(after.names.tolist(), after.points_px, strict=True)
        if name in places
    ]
    assert len(found) > 0.25 * len(before.names)
    assert np.mean(np.array(found) < 2.0) > 0.9


def test_a_step_there_and_back_refuses_what_is_gone():
    grey = np.zeros((120, 120), dtype=np.uint8)
    rng = np.random.default_rng(0)
    rough = cv2.GaussianBlur(rng.standard_normal((80, 80)), (0, 0), 2.0)
    grey[20:100, 20:100] = (150.0 + 60.0 * rough / rough.std()).clip(1.0, 255.0)
    gone = grey.copy()
    gone[20:100, 60:100] = 0
    points = np.array([[40.0, 60.0], [85.0, 60.0]])
    step = follow(grey, gone, points, points)
    assert step.kept.tolist() == [True, False]
    np.testing.assert_allclose(step.points_px[0], points[0], atol=0.05)
    assert len(follow(grey, gone, np.zeros((0, 2)), np.zeros((0, 2))).points_px) == 0


def test_what_slides_is_told_from_what_turns():
    rng = np.random.default_rng(1)
    places = rng.uniform(-1.0, 1.0, (60, 3))
    before, after = (CAMERA.project(pose_at(k) @ places) for k in (0, 6))
    after[:12] += rng.uniform(5.0, 12.0, (12, 2)) * [[0.3, 1.0]]
    rigid = moves_rigidly(before, after, CAMERA.matrix)
    assert rigid[12:].mean() > 0.95
    assert rigid[:12].mean() < 0.4
    assert moves_rigidly(before[:5], after[:5], CAMERA.matrix).all()
