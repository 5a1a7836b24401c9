"""The search along normals and its step, on edges drawn where they are known to be."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from scipy.special import ndtr

from models.arrays import Floats, Mask
from models.camera import Camera
from models.pose import RigidTransform
from pipelines.detection.edge_map import EdgeMap, find_edges
from pipelines.detection.target_region import TargetRegion
from pipelines.tracking import edge_fit
from pipelines.tracking.edge_fit import EdgeImage, EdgeSteps, search_steps
from pipelines.tracking.model_edges import EdgeSamples

CAMERA = Camera.from_fov(120, 120, 40.0)
MIDDLE = np.array([60.0, 60.0])
KNEE_DN = 6.0
SHARP_PX, ROUGH_PX = 0.2, 0.4  # with the light itself, and on a grid of a pixel
TURNS_DEG = [0.0, 40.0, 90.0, 155.0, 230.0, 310.0]


def image_of(signal: Floats) -> EdgeImage:
    own = signal.astype(np.float32)
    target = TargetRegion(
        own, np.arcsinh(own / KNEE_DN), np.ones(own.shape, bool), KNEE_DN / 4.0, KNEE_DN, 0.0
    )
    return EdgeImage(target, find_edges(target), CAMERA)


def ramp(turn_deg: float) -> Floats:
    """How far each pixel lies along a direction from the middle, px."""
    v, u = np.mgrid[:120, :120]
    turn = np.deg2rad(turn_deg)
    return (u - MIDDLE[0]) * np.cos(turn) + (v - MIDDLE[1]) * np.sin(turn)


def edge(along: Floats, at: float, before: float, after: float, blur: float = 0.8) -> Floats:
    return before + (after - before) * ndtr((along - at) / blur)


def samples(turn_deg: float, outline: bool = False, off_px: float = 0.0) -> EdgeSamples:
    """Five samples side by side on a line through the middle, ``off_px`` along the normal."""
    turn = np.deg2rad(turn_deg)
    normal = np.array([np.cos(turn), np.sin(turn)])
    aside = np.linspace(-8.0, 8.0, 5)[:, None] * np.array([-normal[1], normal[0]])
    return EdgeSamples(
        np.zeros((5, 3)), MIDDLE + aside + off_px * normal, np.tile(normal, (5, 1)),
        np.zeros(5, dtype=np.int64), np.full(5, outline),
    )  # fmt: skip


@pytest.mark.parametrize("turn_deg", TURNS_DEG)
@pytest.mark.parametrize(
    ("reach_px", "within_px"), [(4.0, SHARP_PX), (8.0, SHARP_PX), (14.0, ROUGH_PX)]
)
def test_a_step_is_found_as_far_along_the_normal_as_it_is(
    turn_deg: float, reach_px: float, within_px: float
) -> None:
    for at in (-3.3, 0.0, 2.6):
        image = image_of(edge(ramp(turn_deg), at, 400.0, 900.0))
        steps = search_steps(image, samples(turn_deg, off_px=0.4), reach_px)
        np.testing.assert_allclose(steps.distance_px, at - 0.4, atol=within_px)
        assert not steps.dark.any()
        assert steps.found.all()


def test_an_outline_is_where_light_ends_along_the_normal_not_where_it_begins() -> None:
    falling = image_of(edge(ramp(40.0), 1.5, 900.0, 0.0))
    for turn_deg, outline, found in (
        (40.0, True, True),
        (220.0, True, False),
        (220.0, False, True),
    ):
        steps = search_steps(falling, samples(turn_deg, outline), 8.0)
        assert steps.found.all() == steps.found.any() == found
        if found:
            expected = 1.5 if turn_deg == 40.0 else -1.5
            np.testing.assert_allclose(steps.distance_px, expected, atol=SHARP_PX)


def test_the_nearest_of_several_clear_steps_is_taken() -> None:
    """A weak one is not: below 0.3 of the strongest on the normal, which counts to ten gates."""
    along = ramp(0.0)
    two = edge(along, -6.0, 40.0, 300.0) + edge(along, 3.0, 0.0, 600.0)
    steps = search_steps(image_of(two), samples(0.0), 10.0)
    np.testing.assert_allclose(steps.distance_px, 3.0, atol=SHARP_PX)
    faint = edge(along, -6.0, 300.0, 600.0) + edge(along, 2.0, 0.0, 9.0)
    steps = search_steps(image_of(faint), samples(0.0), 10.0)
    np.testing.assert_allclose(steps.distance_px, -6.0, atol=0.5)


def test_beyond_its_reach_or_its_gate_there_is_no_step() -> None:
    image = image_of(edge(ramp(0.0), 9.0, 40.0, 900.0))
    assert not search_steps(image, samples(0.0), 4.0).found.any()
    assert search_steps(image, samples(0.0), 9.0).found.all()
    even = search_steps(image_of(np.full((120, 120), 400.0)), samples(0.0), 8.0)
    assert not even.found.any()
    assert not even.dark.any()


@pytest.mark.parametrize(("level", "dark"), [(0.9, True), (1.4, False)])
def test_it_is_dark_where_nothing_shines_above_the_knee(level: float, dark: bool) -> None:
    """A level of sinh(arcsinh(1)), which is one knee, anywhere on the normal."""
    steps = search_steps(image_of(np.full((120, 120), level * KNEE_DN)), samples(0.0), 6.0)
    assert steps.dark.all() == steps.dark.any() == dark


@pytest.mark.parametrize(
    ("turned_rad", "found"), [(0.40, True), (0.50, False), (-0.40, True), (-0.50, False)]
)
def test_a_wide_search_takes_only_steps_across_the_normal(turned_rad: float, found: bool) -> None:
    """Gradients within 0.45 rad of the normal; a search of 5 px and less takes any."""
    image = image_of(edge(ramp(30.0), 1.0, 40.0, 900.0))
    turned = samples(30.0 + np.rad2deg(turned_rad)).subset(np.array([2]))
    assert search_steps(image, turned, 6.0).found[0] == found
    assert search_steps(image, turned, 5.0).found[0]


@pytest.mark.parametrize("angle_deg", [3.0, 50.0, 90.0, 140.0, 177.0])
def test_directions_are_compared_by_half_turns(angle_deg: float) -> None:
    flat = np.full((120, 120), np.deg2rad(angle_deg), dtype=np.float32)
    edge_map = EdgeMap(flat, flat > 9.0, flat, flat)
    for off_deg, near in ((0.0, True), (25.0, True), (-25.0, True), (27.0, False), (-27.0, False)):
        for half_turn in (0.0, 180.0):
            own = samples(angle_deg + off_deg + half_turn)
            x, y = own.points_px[:, :1], own.points_px[:, 1:]
            assert edge_fit._aligned(edge_map, own, x, y).all() == near, (off_deg, half_turn)


def test_directions_are_read_at_their_own_pixel_and_no_further_than_the_rim() -> None:
    angle = np.zeros((120, 120), dtype=np.float32)
    angle[30, 100] = np.pi / 2.0
    angle[119, 0] = np.pi / 2.0
    edge_map = EdgeMap(angle, angle > 9.0, angle, angle)
    own = samples(90.0).subset(np.array([0, 1, 2]))
    x, y = np.array([[100.4], [30.0], [-3.0]]), np.array([[29.6], [100.0], [140.0]])
    assert edge_fit._aligned(edge_map, own, x, y)[:, 0].tolist() == [True, False, True]


@pytest.mark.parametrize("contrast", [3.0, 30.0, 400.0])
def test_a_step_lies_where_light_is_steepest_not_its_logarithm(contrast: float) -> None:
    """Stretched, a bright edge of 1.2 px of blur seems up to 2 px out on its dark side."""
    signal = edge(ramp(0.0), 0.7, 2.0, 2.0 + contrast * KNEE_DN, blur=1.2)
    image = image_of(signal)
    begun = np.array([0.7, -0.6, 2.0, 0.2, 1.2])
    moved = edge_fit._sharpened(image, samples(0.0), begun)
    np.testing.assert_allclose(moved[[0, 3, 4]], 0.7, atol=0.12)
    assert (np.abs(moved - 0.7) < np.maximum(np.abs(begun - 0.7), 0.12)).all()
    flat = edge_fit._sharpened(image_of(np.full((120, 120), 9.0)), samples(0.0), begun)
    np.testing.assert_allclose(flat, begun)


def test_tukeys_weights_are_his() -> None:
    residual = np.array([0.0, 1.0, -2.0, 9.36, -9.38, 50.0])
    expected = (1.0 - (residual / (4.685 * 2.0)) ** 2) ** 2
    expected[4:] = 0.0
    np.testing.assert_allclose(edge_fit._tukey(residual, 2.0), expected)


def made_up(count: int = 60, seed: int = 1) -> tuple[RigidTransform, EdgeSamples, Floats]:
    rng = np.random.default_rng(seed)
    pose = RigidTransform(np.eye(3), np.array([0.2, -0.1, 12.0])).perturbed(
        [0.5, -0.8, 0.3], np.zeros(3)
    )
    points = rng.uniform(-2.0, 2.0, (count, 3))
    turn = rng.uniform(0.0, 2.0 * np.pi, count)
    normals = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    own = EdgeSamples(
        points, CAMERA.project(pose @ points), normals, np.arange(count), np.zeros(count, bool)
    )
    return pose, own, edge_fit.normal_jacobian(CAMERA, pose, own)


def test_the_step_is_that_of_weighted_least_squares() -> None:
    """Weights by Tukey at 1.48 of the median residual; steps not found weigh nothing."""
    pose, own, jacobian = made_up()
    rng = np.random.default_rng(2)
    residual = jacobian @ [2e-3, -1e-3, 3e-3, 0.01, -0.02, 0.1] + 0.9 * rng.standard_normal(60)
    residual[7] = 30.0
    residual[[3, 40]] = np.nan
    steps = EdgeSteps(residual, np.zeros(60, bool))
    solved = edge_fit._solve(CAMERA, pose, own, steps, 20.0)
    assert solved is not None
    change, weights, information, rms = solved
    known = np.nan_to_num(residual)
    scale = 1.4826 * np.nanmedian(np.abs(residual))
    assert scale > 0.5
    np.testing.assert_allclose(
        weights, np.where(np.isnan(residual), 0.0, edge_fit._tukey(known, scale))
    )
    assert weights[7] == 0.0
    np.testing.assert_allclose(information, jacobian.T @ np.diag(weights) @ jacobian)
    root = np.sqrt(weights)[:, None]
    expected = np.linalg.lstsq(root * jacobian, root[:, 0] * known, rcond=None)[0]
    np.testing.assert_allclose(change, expected, rtol=1e-3, atol=1e-6)
    assert rms == pytest.approx(np.sqrt((weights * known**2).sum() / weights.sum()))


@pytest.mark.parametrize(("size", "reach", "scale"), [(0.1, 20.0, 0.5), (4.0, 8.0, 4.0)])
def test_the_scale_is_no_less_than_half_a_pixel_and_no_more_than_half_the_reach(
    size: float, reach: float, scale: float
) -> None:
    pose, own, _ = made_up()
    residual = size * np.where(np.arange(60) % 2 == 0, 1.0, -1.0)
    solved = edge_fit._solve(CAMERA, pose, own, EdgeSteps(residual, residual > 99.0), reach)
    assert solved is not None
    np.testing.assert_allclose(solved[1], edge_fit._tukey(residual, scale))


def test_thirty_steps_are_the_fewest_and_what_determines_nothing_gives_none() -> None:
    for count, enough in ((29, False), (30, True)):
        pose, own, jacobian = made_up(count)
        steps = EdgeSteps(jacobian @ np.full(6, 1e-3), np.zeros(count, bool))
        assert (edge_fit._solve(CAMERA, pose, own, steps, 8.0) is not None) == enough
    pose, own, _ = made_up()
    aside = replace(own, normals_px=np.zeros((60, 2)))
    assert (
        edge_fit._solve(CAMERA, pose, aside, EdgeSteps(np.ones(60), np.zeros(60, bool)), 8.0)
        is None
    )


def test_samples_that_no_longer_project_are_left_out() -> None:
    pose, own, _ = made_up()
    nearer = RigidTransform(pose.rotation, np.array([0.0, 0.0, 1.0]))
    moved = edge_fit._moved(own, CAMERA, nearer)
    in_cam = nearer @ own.points_in_target
    assert 0 < len(moved) == (in_cam[:, 2] > 0.0).sum() < 60
    np.testing.assert_allclose(moved.points_px, CAMERA.project(in_cam[in_cam[:, 2] > 0.0]))


def test_an_edge_maps_noise_is_counted_in_the_stretch() -> None:
    """Four sigmas of a gradient that is a fifth of a pixel's noise, or two percent of a level."""
    signal = np.full((60, 60), 50.0, dtype=np.float32)
    for sigma in (1.5, 0.01):
        target = TargetRegion(
            signal, np.arcsinh(signal / KNEE_DN), signal > 0.0, sigma, KNEE_DN, 0.0
        )
        expected = max(4.0 * 0.2 * sigma / np.hypot(50.0, KNEE_DN), 0.02)
        np.testing.assert_allclose(find_edges(target).noise, expected, rtol=1e-4)


@pytest.mark.parametrize("turn_deg", [0.0, 90.0, 180.0, 270.0])
def test_edges_are_kept_within_four_pixels_of_the_target(turn_deg: float) -> None:
    """On all its sides alike: an edge with four pixels to the first that is lit, not with five."""
    along = ramp(turn_deg)
    signal = cv2.GaussianBlur(np.where(along > 0.0, 900.0, 5.0).astype(np.float32), (0, 0), 0.8)

    def edges_of(lit: Mask) -> Mask:
        target = TargetRegion(signal, np.arcsinh(signal / KNEE_DN), lit, 1.5, KNEE_DN, 0.0)
        return find_edges(target).edges

    place = round(float(along[edges_of(along > -90.0)].max()))
    assert edges_of(along > place + 3.5).any()
    assert not edges_of(along > place + 4.5).any()
