"""Batched three-point poses against OpenCV, PoseLib and exact data."""

from __future__ import annotations

import cv2
import numpy as np
import poselib
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from pipelines.acquisition.three_point_poses import (
    LandmarkTriples,
    real_quartic_roots,
    three_point_poses,
)
from tests.support.point_targets import CAMERA, any_pose, telescope_target

TARGET = telescope_target()
POINTS = TARGET.points_in_target
TRIPLES = LandmarkTriples.among(POINTS, np.arange(len(TARGET)))
ON_RAY = 1e-6  # normalised: two Newton steps from a quartic's rounding
SAME_POSE = 1e-4  # relative: near a double root the peers differ among themselves
FOUND_SHARE = 0.99  # of the peers' poses; what is missing are double roots
REPROJECTED_SHARE = 0.98


def rays_of(rng: np.random.Generator) -> tuple[Floats, Floats, Floats]:
    """Return three rays to image points, and the landmarks and the pose that are behind them."""
    pose = any_pose(rng)
    chosen = rng.choice(len(TARGET), 3, replace=False)
    pixels = CAMERA.project(pose @ POINTS[chosen]) + rng.standard_normal((3, 2))
    return CAMERA.rays(pixels), CAMERA.normalise(pixels), chosen


def peers(known: Floats, normalised: Floats, rays: Floats) -> list[tuple[Floats, Floats]]:
    """Return the poses of OpenCV and of PoseLib that keep the points in front, on their rays."""
    _, turns, shifts = cv2.solveP3P(
        known[:, None], normalised[:, None], np.eye(3), None, flags=cv2.SOLVEPNP_P3P
    )
    found = [
        (Rotation.from_rotvec(turn.ravel()).as_matrix(), shift.ravel())
        for turn, shift in zip(turns, shifts, strict=True)
        if np.isfinite(turn).all()
    ]
    found += [(pose.R, pose.t) for pose in poselib.p3p(list(rays), list(known))]
    kept = []
    for rotation, shift in found:
        in_cam = known @ rotation.T + shift
        if (in_cam[:, 2] > 0).all():
            gap = np.abs(in_cam[:, :2] / in_cam[:, 2:] - normalised).max()
            if gap < ON_RAY:
                kept.append((rotation, shift))
    return kept


def test_they_find_what_opencv_and_poselib_find() -> None:
    found = wanted = 0
    for seed in range(12):
        rng = np.random.default_rng([11, seed])
        rays, normalised, _ = rays_of(rng)
        rotations, translations, of_triple = three_point_poses(rays, TRIPLES)
        for row in rng.choice(len(TRIPLES), 25, replace=False):
            known = POINTS[TRIPLES.landmarks[row]]
            own = of_triple == row
            for rotation, shift in peers(known, normalised, rays):
                turned = np.abs(rotations[own] - rotation).max(axis=(1, 2), initial=0.0)
                moved = np.abs(translations[own] - shift).max(axis=1, initial=0.0) / shift[2]
                wanted += 1
                found += bool(((turned < SAME_POSE) & (moved < SAME_POSE)).any())
    assert wanted > 100
    assert found >= FOUND_SHARE * wanted


@pytest.mark.parametrize("seed", range(4))
def test_every_pose_brings_its_landmarks_onto_the_rays(seed: int) -> None:
    rays, normalised, _ = rays_of(np.random.default_rng([12, seed]))
    rotations, translations, of_triple = three_point_poses(rays, TRIPLES)
    known = POINTS[TRIPLES.landmarks[of_triple]]
    in_cam = np.einsum("pij,pnj->pni", rotations, known) + translations[:, None]
    assert (in_cam[..., 2] > 0.0).all()
    gap = np.abs(in_cam[..., :2] / in_cam[..., 2:] - normalised).max(axis=(1, 2))
    # What is left are pairs of complex roots whose real part noise may have meant.
    assert np.mean(gap < ON_RAY) > REPROJECTED_SHARE
    np.testing.assert_allclose(np.linalg.det(rotations), 1.0, atol=1e-9)


def test_rays_of_each_triple_give_what_one_at_a_time_gives() -> None:
    rng = np.random.default_rng(13)
    few = LandmarkTriples.of(POINTS, TRIPLES.landmarks[rng.choice(len(TRIPLES), 20)])
    rays = np.stack([rays_of(rng)[0] for _ in range(20)])
    together = three_point_poses(rays, few)
    for row in range(20):
        alone = three_point_poses(
            rays[row], LandmarkTriples.of(POINTS, few.landmarks[row : row + 1])
        )
        own = together[2] == row
        np.testing.assert_allclose(together[0][own], alone[0], atol=1e-9)
        np.testing.assert_allclose(together[1][own], alone[1], atol=1e-6)


def test_flat_triples_are_left_out() -> None:
    line = np.array([[0.0, 0, 0], [1.0, 0, 0], [2.0, 0.01, 0], [0.0, 1, 0]])
    triples = LandmarkTriples.among(line, np.arange(4))
    assert not any(set(row) == {0, 1, 2} for row in triples.landmarks.tolist())
    assert len(triples) == 18


@settings(max_examples=60, deadline=None)
@given(roots=st.lists(st.floats(-3.0, 3.0), min_size=4, max_size=4, unique=True))
def test_quartics_with_four_roots(roots: list[float]) -> None:
    ordered = np.sort(roots)
    if np.diff(ordered).min() < 1e-2:
        return
    found = np.sort(real_quartic_roots(np.poly(ordered)[:, None])[:, 0])
    np.testing.assert_allclose(found, ordered, atol=1e-4)


@settings(max_examples=60, deadline=None)
@given(
    middle=st.floats(-2.0, 2.0),
    height=st.floats(0.3, 2.0),
    roots=st.tuples(st.floats(-3.0, -0.1), st.floats(0.1, 3.0)),
)
def test_quartics_with_two_roots(middle: float, height: float, roots: tuple[float, float]) -> None:
    polynomial = np.polymul([1.0, -2.0 * middle, middle**2 + height**2], np.poly(roots))
    found = real_quartic_roots(polynomial[:, None])[:, 0]
    real = found[np.isfinite(found)]  # with the real part of a pair that is nearly real
    assert all(np.abs(real - root).min() < 1e-4 for root in roots)


def test_quartics_without_real_roots_and_without_odd_powers() -> None:
    lonely = real_quartic_roots(np.poly([2.0 + 3j, 2.0 - 3j, -1.0 + 2j, -1.0 - 2j]).real[:, None])
    assert np.isnan(lonely).all()
    even = real_quartic_roots(np.array([1.0, 0.0, 0.0, 0.0, -1.0])[:, None])[:, 0]
    np.testing.assert_allclose(np.sort(even[np.isfinite(even)]), [-1.0, 1.0], atol=1e-9)
