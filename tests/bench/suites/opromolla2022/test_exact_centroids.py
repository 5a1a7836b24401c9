"""What draws alone do to a pose, against the geometry of a pinhole."""

from dataclasses import replace

import numpy as np
import pytest

from bench.suites.opromolla2022.exact_centroids import errors_of_exact_centroids
from tests.support.synthetic_pair import CAMERA_2048, PATTERN, facing_pose

POSE = facing_pose(5.0)
TRUE_PX = CAMERA_2048.project(POSE @ PATTERN.points_in_target)
SEEN = np.ones(len(PATTERN), dtype=bool)


def solved(cameras, points=None, seen=SEEN):
    told = np.repeat(PATTERN.points_in_target[None], len(cameras), axis=0)
    return errors_of_exact_centroids(
        cameras, told if points is None else points, TRUE_PX, seen, POSE
    )


def test_who_knows_everything_errs_by_nothing() -> None:
    assert np.abs(solved([CAMERA_2048, CAMERA_2048])).max() < 1e-9


def test_a_focal_length_is_a_range_and_a_principal_point_is_a_shift() -> None:
    off = 1.0
    longer = replace(CAMERA_2048, fx=CAMERA_2048.fx + off, fy=CAMERA_2048.fy + off)
    beside = replace(CAMERA_2048, cx=CAMERA_2048.cx + off)
    by_focus, by_centre = solved([longer, beside])
    depth = float((POSE @ PATTERN.points_in_target)[:9, 2].mean())
    # pose.md, 2.3: d/f a pixel; the markers' own depth and place about the axis leave per cents.
    assert by_focus[2] == pytest.approx(depth / CAMERA_2048.fx, rel=0.05)
    assert by_centre[0] == pytest.approx(-depth / CAMERA_2048.fx, rel=0.05)


def test_runs_do_not_know_of_each_other() -> None:
    points = np.repeat(PATTERN.points_in_target[None], 2, axis=0)
    points[1] += 1e-3 * np.random.default_rng(2).standard_normal(points[1].shape)
    first, second = solved([CAMERA_2048, CAMERA_2048], points)
    assert np.abs(first).max() < 1e-9 < 1e-5 < np.abs(second[:3]).max()


def test_two_markers_tell_no_pose() -> None:
    assert np.isnan(solved([CAMERA_2048], seen=np.arange(len(PATTERN)) < 2)).all()
