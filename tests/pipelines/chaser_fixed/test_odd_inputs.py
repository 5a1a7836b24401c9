"""Priors that no camera could see, lenses that fold, one hot pixel: reasons, not exceptions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.arrays import Floats
from models.estimate import Estimate
from models.frame import Frame
from models.pose import RigidTransform, pose_error
from pipelines.chaser_fixed.pipeline import VARIANTS, ChaserFixed, options_for
from pipelines.detection.binarisation import threshold_dn
from pipelines.detection.disc_outline import disc_outlines
from pipelines.detection.image_difference import clipped_difference, saturated
from pipelines.detection.image_pair import image_pair
from tests.support.synthetic_pair import (
    CAMERA_1024,
    PATTERN,
    Scene,
    drawn_prior,
    facing_pose,
    knowledge_of,
    pair_frame,
    render_pair,
)

HOT_DN = 3900  # below saturation, above every marker
POSE = facing_pose(4.0, (178.6, 1.1, -1.0))
SCENE = Scene(CAMERA_1024, levels=np.linspace(0.25, 0.6, 10))
ON_MARKER_SIGMAS = 3.0
PRINTED_SIGMAS = 4.0  # a threshold twice as high cuts every blob anew: pixelation drawn once more


@pytest.fixture(scope="module")
def frame() -> Frame:
    return render_pair(SCENE, POSE)


def said(frame: Frame, prior: RigidTransform, variant: str) -> Estimate:
    return ChaserFixed(knowledge_of(SCENE, prior), options_for(variant)).process(frame)


def pose_of(estimate: Estimate) -> tuple[RigidTransform, Floats]:
    assert estimate.pose is not None, estimate.reason
    return estimate.pose.cam_from_target, estimate.pose.stated_covariance


def with_hot_pixel(frame: Frame, column: int, row: int) -> Frame:
    pair = image_pair(frame)
    image = pair.image_850.copy()
    image[row, column] = HOT_DN
    return pair_frame(frame.index, frame.time_s, pair.image_800, image)


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize(
    "translation",
    [[0.0, 0.0, 0.0], [0.0, 0.8, -4.0], [0.1, 0.0, 0.0], [0.0, 0.0, 1e-300], [0.0, 0.0, 1e300]],
)
def test_a_prior_that_no_camera_could_see_gives_a_reason(
    frame: Frame, variant: str, translation: list[float]
) -> None:
    estimate = said(frame, RigidTransform(POSE.rotation, np.array(translation)), variant)
    assert not estimate
    assert "out of sight" in str(estimate.reason)


def test_a_marker_beyond_the_fold_is_not_looked_for() -> None:
    """At 1.2 m the outer markers lie 43 deg off axis; this barrel folds at 40 deg."""
    camera = replace(CAMERA_1024, width=512, height=512, cx=255.5, cy=255.5, k1=-0.47)
    near = facing_pose(1.2)
    outlines = disc_outlines(camera, near, PATTERN)
    off_axis = np.linalg.norm((near @ PATTERN.points_in_target)[:, :2], axis=1) / 1.2
    np.testing.assert_array_equal(outlines.facing[:9], off_axis[:9] < camera.fold_radius)
    assert 0 < outlines.facing.sum() < 10
    assert np.isfinite(outlines.centres_px[outlines.facing]).all()
    assert np.isfinite(outlines.shapes_px2[outlines.facing]).all()
    assert np.isnan(outlines.centres_px[~outlines.facing]).all()


def test_a_hot_pixel_sets_the_papers_threshold_as_printed(frame: Frame) -> None:
    """tau_bin times the largest difference: one pixel doubles it, and every blob is cut higher."""
    tau_bin = options_for("paper").tau_bin
    levels = []
    for each in map(image_pair, (frame, with_hot_pixel(frame, 900, 100))):
        difference = clipped_difference(each)
        level = threshold_dn(
            difference, saturated(each, SCENE.detector), tau_bin, "fraction_of_max"
        )
        assert level == pytest.approx(tau_bin * difference.max())
        levels.append(level)
    assert levels[1] > 1.5 * levels[0]


@pytest.mark.parametrize("place", ["far from any marker", "beside a marker", "in a marker"])
def test_a_hot_pixel_moves_the_paper_by_its_noise_and_best_not_at_all(
    frame: Frame, place: str
) -> None:
    column, row = np.rint(CAMERA_1024.project(POSE @ PATTERN.points_in_target[4])).astype(int)
    aside = {"far from any marker": (-300, -300), "beside a marker": (12, 0)}.get(place, (2, 0))
    hot = with_hot_pixel(frame, int(column + aside[0]), int(row + aside[1]))
    prior = drawn_prior(POSE, 3)
    for variant in VARIANTS:
        calm, _ = pose_of(said(frame, prior, variant))
        moved, covariance = pose_of(said(hot, prior, variant))
        shift = np.abs(pose_error(moved, calm).position_m) / np.sqrt(np.diag(covariance)[3:])
        if variant == "best" and place != "in a marker":
            np.testing.assert_array_equal(moved.matrix(), calm.matrix())
        assert shift.max() < (PRINTED_SIGMAS if variant == "paper" else ON_MARKER_SIGMAS)
        if variant == "paper":
            assert shift.max() > 0.5  # printed is printed: it is not immune
