"""From images to a shape: own tracks of a tumbling cube, and a range to its surface."""

import numpy as np
import pytest

from models.motion.clohessy_wiltshire import mean_motion, state_on_inclined_ellipse
from models.motion.watched_tumble import WatchedTumble
from pipelines.features.feature_tracker import FeatureTracker
from pipelines.unknown_target.batch_estimator import BatchEstimator
from pipelines.unknown_target.options import BatchOptions
from pipelines.unknown_target.start_guess import StartGuess
from pipelines.unknown_target.tracked_frame import TrackedFrame
from tests.support.textured_cube import CAMERA, HALF_M, drawn, place_of, textures

FRAMES = 45
N = mean_motion(7.0e6)
OMEGA = np.deg2rad([0.8, 1.6, 0.5])
RANGE_SIGMA_M = 0.01


def motion():
    start = state_on_inclined_ellipse(N, 8.0, 8.0, 0.3)
    return WatchedTumble(7.0e6, start, OMEGA, np.diag([1.0, 1.1, 1.3]), float(FRAMES))


def distance_to_cube(points):
    """Return how far points are from the cube's surface, (n,) m."""
    outside = np.maximum(np.abs(points) - HALF_M, 0.0)
    inside = np.minimum(HALF_M - np.abs(points).max(axis=1), HALF_M)
    return np.where(outside.any(axis=1), np.linalg.norm(outside, axis=1), np.abs(inside))


@pytest.mark.slow
def test_a_cube_is_found_from_its_images_alone():
    own, faces, camera = motion(), textures(), CAMERA
    rng = np.random.default_rng(4)
    guess = StartGuess(
        own.start[:3] + 0.3 * rng.standard_normal(3),
        0.3,
        omega_in_target=OMEGA + 2e-3 * rng.standard_normal(3),
        sigma_rad_s=2e-3,
        size_m=1.0,
    )
    tracker = FeatureTracker(camera)
    estimator = BatchEstimator(camera, N, guess, BatchOptions())
    middle = np.array([camera.cx, camera.cy])
    for frame in range(FRAMES):
        state = own.state(float(frame))
        pose = state.cam_from_target
        seen = tracker.track(drawn(pose, faces, frame))
        met = np.linalg.norm(pose @ place_of(pose, middle))
        estimator.add(
            TrackedFrame(
                frame, float(frame), state.R_cam_from_lvlh, seen.names, seen.points_px,
                seen.sigma_px, met + RANGE_SIGMA_M * rng.standard_normal(), RANGE_SIGMA_M,
            )
        )  # fmt: skip
    found = estimator.solution()
    distance = np.linalg.norm(found.motion[:3]) / np.linalg.norm(state.rho_in_lvlh) - 1.0
    rate_deg_s = np.rad2deg(np.linalg.norm(found.motion[6:] - state.omega_in_target))
    away_m = distance_to_cube(found.unknowns.points[found.live])
    assert abs(distance) < 0.01
    assert rate_deg_s < 0.05
    assert np.median(away_m) < 0.03  # fine detail is half of so coarse a texture
