"""Patches that move, turn and fade as they are told to, and what the fit says of them."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from models.arrays import Floats, Labels
from pipelines.detection.target_region import TargetRegion
from pipelines.features import anchored_patch, appearance, fine_detail, klt_step
from pipelines.features.anchored_patch import GRID, HALF_PX, Anchors, fitted

PLACES = np.array([[60.0, 50.0], [90.3, 72.6], [45.5, 88.2]])
MOVED_PX = np.array([2.4, -1.3])
SLIP_PX = 0.03  # of eight bits interpolated


def texture(seed: int = 1, size: tuple[int, int] = (130, 140), blur: float = 2.0) -> Labels:
    noise = np.random.default_rng(seed).standard_normal(size).astype(np.float32)
    smooth = cv2.GaussianBlur(noise, (0, 0), blur)
    return np.clip(128.0 + 45.0 * smooth / smooth.std(), 0, 255).astype(np.uint8)


def warped(image: Labels, matrix: Floats, about: Floats, shift: Floats) -> Labels:
    """Move an image so that ``about + d`` comes to ``about + shift + matrix d``."""
    offset = about + shift - matrix @ about
    return cv2.warpAffine(
        image, np.column_stack([matrix, offset]), image.shape[::-1], flags=cv2.INTER_CUBIC,
        borderMode=cv2.BORDER_REFLECT,
    )  # fmt: skip


def test_a_first_look_is_of_mean_0_and_length_1_with_slopes_by_all_six() -> None:
    """Descents against differences of the normalised look itself, by shift and affine map."""
    image = texture(blur=4.0)
    anchors = Anchors.of(image, PLACES)
    np.testing.assert_allclose(anchors.patches.mean(axis=1), 0.0, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(anchors.patches, axis=1), 1.0)
    assert GRID.shape == (2, (2 * HALF_PX + 1) ** 2)
    looks = anchored_patch._sampled(image, PLACES, np.tile(np.eye(2), (3, 1, 1)))
    u, v = (PLACES[0] + GRID[:, 5]).astype(int)
    assert looks[0, 5] == image[v, u]
    length = np.linalg.norm(looks - looks.mean(axis=1, keepdims=True), axis=1)
    for number in range(6):
        ends = []
        for sign in (1.0, -1.0):
            step = np.zeros(6)
            step[number] = sign * (1.0 if number < 2 else 0.1)
            maps = np.tile(np.eye(2) + step[2:].reshape(2, 2), (3, 1, 1))
            ends.append(anchored_patch._sampled(image, PLACES + step[:2], maps))
        slope = (ends[0] - ends[1]) / (2.0 if number < 2 else 0.2) / length[:, None]
        slope -= slope.mean(axis=1, keepdims=True)
        for own, found in zip(slope, anchors.descents[:, :, number], strict=True):
            assert np.corrcoef(own, found)[0, 1] > 0.97
            assert np.linalg.norm(found) == pytest.approx(np.linalg.norm(own), rel=0.08)
    assert len(Anchors.none().patches) == 0
    both = anchors.take(np.array([True, False, True])).followed_by(Anchors.none())
    np.testing.assert_array_equal(both.patches, anchors.patches[[0, 2]])
    np.testing.assert_array_equal(both.descents, anchors.descents[[0, 2]])


@pytest.mark.parametrize("shift", [(0.0, 0.0), (1.6, -0.7), (-2.3, 1.1)])
@pytest.mark.parametrize("matrix", [np.eye(2), np.array([[0.96, -0.10], [0.07, 1.05]])])
def test_a_patch_is_found_where_it_went_and_as_it_was_stretched(shift, matrix) -> None:
    image, about = texture(), PLACES[0]
    moved = warped(image, matrix, about, np.array(shift))
    dimmer = np.clip(0.6 * moved.astype(float) + 20.0, 0, 255).astype(np.uint8)
    found = fitted(dimmer, Anchors.of(image, PLACES[:1]), PLACES[:1], np.eye(2)[None])
    np.testing.assert_allclose(found.points_px[0], about + shift, atol=2.0 * SLIP_PX)
    np.testing.assert_allclose(found.maps[0], matrix, atol=0.015)
    assert 0.98 < found.likeness[0] <= 1.0 + 1e-12
    assert found.sigma_px[0] < 0.06


def test_its_sigma_is_that_of_the_noise() -> None:
    """Of 60 draws of noise the scatter is what each fit says of itself.

    At pixels' middles: between them interpolation makes the noise that is left look smaller.
    """
    image, rng = texture(), np.random.default_rng(2)
    whole = np.rint(PLACES)
    anchors = Anchors.of(image, whole)
    errors, sigmas = [], []
    for _ in range(60):
        noisy = np.clip(image + 6.0 * rng.standard_normal(image.shape), 0, 255).astype(np.uint8)
        found = fitted(noisy, anchors, whole, np.tile(np.eye(2), (3, 1, 1)))
        errors.append(found.points_px - whole)
        sigmas.append(found.sigma_px)
    scatter = np.sqrt(np.mean(np.square(errors), axis=(0, 2)))
    np.testing.assert_allclose(np.sqrt(np.mean(np.square(sigmas), axis=0)), scatter, rtol=0.25)


def test_no_patches_give_none_and_other_places_are_unlike() -> None:
    image = texture()
    none = fitted(image, Anchors.none(), np.zeros((0, 2)), np.zeros((0, 2, 2)))
    assert none.likeness.shape == none.sigma_px.shape == (0,)
    elsewhere = fitted(texture(9), Anchors.of(image, PLACES), PLACES, np.tile(np.eye(2), (3, 1, 1)))
    assert (elsewhere.likeness < 0.6).all()
    assert (elsewhere.sigma_px > 0.1).all()
    flat = np.full((130, 140), 90, np.uint8)
    assert (Anchors.of(flat, PLACES).patches == 0.0).all()


def test_what_was_followed_comes_back_and_tells_its_steps_sigma() -> None:
    image = texture(blur=1.5)
    moved = warped(image, np.eye(2), np.zeros(2), MOVED_PX)
    followed = klt_step.follow(image, moved, PLACES, PLACES)
    assert followed.kept.all()
    np.testing.assert_allclose(followed.points_px, PLACES + MOVED_PX, atol=0.08)
    rng = np.random.default_rng(3)
    places = rng.uniform(25.0, 105.0, (60, 2))
    noisy = np.clip(moved + 8.0 * rng.standard_normal(moved.shape), 0, 255).astype(np.uint8)
    rough = klt_step.follow(image, noisy, places, places + MOVED_PX)
    back, _ = klt_step._step(noisy, image, rough.points_px, places)
    apart = ((back - places) ** 2).sum(axis=1)[rough.kept]
    # The median of chi-square of two degrees is 2 ln 2; there and back are two steps.
    assert rough.step_sigma_px == pytest.approx(
        np.sqrt(np.median(apart) / (2.0 * np.log(2.0)) / 2.0), rel=1e-3
    )
    assert (apart < 0.25).all()
    unlike = klt_step.follow(image, texture(8), places, places)
    assert unlike.kept.mean() < 0.5
    none = klt_step.follow(image, moved, np.zeros((0, 2)), np.zeros((0, 2)))
    assert (none.points_px.shape, none.step_sigma_px) == ((0, 2), 0.0)


def test_points_that_left_the_image_are_not_kept() -> None:
    image = texture()
    moved = warped(image, np.eye(2), np.zeros(2), np.array([-6.0, 0.0]))
    places = np.array([[4.0, 60.0], [70.0, 60.0]])
    followed = klt_step.follow(image, moved, places, places - [6.0, 0.0])
    assert followed.kept.tolist() == [False, True]


def test_only_pairs_that_are_alike_both_ways_and_like_no_other_are_recognised() -> None:
    base = np.eye(128)[:4] * 400.0
    lost = base[:3] + 10.0 * np.eye(128)[20]
    found = np.concatenate([base[[2, 0]], base[[3]]])
    assert list(appearance.recognised(lost, found)) == [(0, 1), (2, 0)]
    twin = np.concatenate([found, base[[0]] + 8.0 * np.eye(128)[30]])
    assert list(appearance.recognised(lost, twin)) == [(2, 0)]  # 10 is more than 0.7 of 12.8
    far = base[:2] + 111.0 * np.eye(128)[20]
    assert list(appearance.recognised(far, base[:2])) == []
    near = base[:2] + 109.0 * np.eye(128)[20]
    assert list(appearance.recognised(near, base[:2])) == [(0, 0), (1, 1)]
    assert list(appearance.recognised(lost[:1], found)) == []
    gone = np.full((2, 128), np.inf)
    assert list(appearance.recognised(np.concatenate([lost, gone]), found)) == [(0, 1), (2, 0)]


@pytest.mark.parametrize("turn_deg", [0.0, 70.0, 135.0, 250.0])
def test_a_place_is_described_by_the_way_it_brightens(turn_deg: float) -> None:
    turn = np.deg2rad(turn_deg)
    v, u = np.mgrid[:60, :60]
    ramp = np.clip(120.0 + 2.0 * ((u - 30) * np.cos(turn) + (v - 30) * np.sin(turn)), 0, 255)
    assert appearance._up(ramp.astype(np.uint8), 30.0, 30.0) == pytest.approx(turn_deg, abs=2.0)
    assert appearance._up(ramp.astype(np.uint8), 0.0, 0.0) == pytest.approx(turn_deg, abs=4.0)
    assert appearance.described(ramp.astype(np.uint8), np.zeros((0, 2))).shape == (0, 128)


def region(signal: Floats, sigma: float = 2.0) -> TargetRegion:
    own = signal.astype(np.float32)
    return TargetRegion(own, np.arcsinh(own / (4 * sigma)), own > 0.0, sigma, 4 * sigma, 0.0)


def test_fine_detail_is_what_a_blur_leaves_of_the_root_in_eight_bits() -> None:
    signal = 400.0 + 40.0 * np.random.default_rng(5).standard_normal((60, 70))
    root = np.sqrt(signal.astype(np.float32) + 8.0)
    detail = root - cv2.GaussianBlur(root, (0, 0), 2.5)
    top = np.percentile(np.abs(detail), 99.0)
    expected = np.clip(128.0 + 127.0 * detail / top, 0, 255)
    assert np.abs(fine_detail.fine_detail(region(signal)) - expected).max() <= 1.0
    smooth = np.add.outer(np.linspace(100.0, 900.0, 60), np.zeros(70))
    assert np.abs(fine_detail.fine_detail(region(smooth)).astype(int)[12:-12] - 128).max() < 40
    dark = fine_detail.fine_detail(region(np.zeros((20, 20))))
    assert set(dark.ravel().tolist()) == {128}


def test_corners_are_where_there_is_structure_both_ways() -> None:
    grey = np.full((80, 80), 128, np.uint8)
    grey[20:60, 20:60] = 160
    grey[:, 70] = 200
    lit = np.ones((80, 80), bool)
    found = fine_detail.has_corners(grey, lit)
    assert found[18:23, 18:23].any()
    assert found[58:62, 58:62].any()
    assert not found[36:44, 18:22].any()  # an edge
    assert not found[30:50, 68:73].any()
    assert not found[36:44, 36:44].any()
    assert not fine_detail.has_corners(grey, ~lit).any()
