"""Detection on synthetic pairs: what is found among sunlit clutter, and what must not hurt."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from models.arrays import Floats, Image
from models.camera import Camera
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector
from pipelines.chaser_fixed.options import options_for
from pipelines.detection.area_opening import expected_radius_px
from pipelines.detection.candidates import Candidates
from pipelines.detection.global_threshold import detect_by_global_threshold
from pipelines.detection.image_difference import (
    Region,
    clipped_difference,
    saturated,
    saturation_level_dn,
    signed_difference,
    swapped,
)
from pipelines.detection.image_pair import ImagePair, image_pair
from pipelines.detection.local_threshold import detect_in_region
from tests.support.synthetic_pair import (
    CAMERA_1024,
    CAMERA_2048,
    PATTERN,
    ExpectedPair,
    Scene,
    expected_pair,
    facing_pose,
    render_pair,
)

PAPER, BEST = options_for("paper"), options_for("best")
FOUND_PX = 0.3  # a coarse centroid this near to a marker is that marker
DETECTOR = Detector()


def pair_seen(scene: Scene, pose: RigidTransform) -> ImagePair:
    return image_pair(render_pair(scene, pose))


def by_paper(pair: ImagePair, scene: Scene, range_m: float) -> Candidates:
    radius = expected_radius_px(scene.markers.radius_m, range_m, scene.camera.fx)
    return detect_by_global_threshold(pair, scene.camera, scene.detector, radius, PAPER)


def by_best(pair: ImagePair, scene: Scene, range_m: float) -> Candidates:
    radius = expected_radius_px(scene.markers.radius_m, range_m, scene.camera.fx)
    whole = Region.whole(pair.image_850)
    return detect_in_region(pair, scene.detector, whole, (0.95 * radius, 1.05 * radius), BEST)


def recall_and_false(found: Candidates, scene: Scene, pose: RigidTransform) -> tuple[set[int], int]:
    """Return the markers found and the number of other candidates."""
    truth = scene.camera.project(pose @ scene.markers.points_in_target)
    gaps = np.linalg.norm(found.points_px[:, None] - truth[None], axis=-1).reshape(-1, len(truth))
    seen = set(np.flatnonzero((gaps < FOUND_PX).any(axis=0)).tolist())
    return seen, int((gaps >= FOUND_PX).all(axis=1).sum())


def visible(scene: Scene, pose: RigidTransform, range_m: float) -> set[int]:
    radius = scene.camera.fx * scene.markers.radius_m / range_m
    truth = scene.camera.project(pose @ scene.markers.points_in_target)
    return set(np.flatnonzero(scene.camera.contains(truth, 2.0 * radius)).tolist())


@cache
def cluttered(camera: Camera, range_m: float, clutter: int | None):
    scene = Scene(camera=camera, clutter=clutter)
    pose = facing_pose(range_m, (181.0, -1.0, 2.0))
    return scene, pose, pair_seen(scene, pose)


@pytest.mark.parametrize("detect", [by_paper, by_best])
@pytest.mark.parametrize(
    ("camera", "range_m", "clutter"),
    [
        (CAMERA_1024, 6.7, None),
        (CAMERA_1024, 6.7, 1),
        (CAMERA_1024, 3.5, 2),
        (CAMERA_1024, 1.8, 3),
        (CAMERA_2048, 6.7, 4),
    ],
)
def test_every_marker_is_found_in_clutter_and_nothing_else(
    detect, camera, range_m: float, clutter: int | None
) -> None:
    scene, pose, pair = cluttered(camera, range_m, clutter)
    seen, false = recall_and_false(detect(pair, scene, range_m), scene, pose)
    assert seen == visible(scene, pose, range_m)
    assert false == 0


def test_clutter_saturates_and_is_seen_by_both_images() -> None:
    """The premise of the test above: there are glints, and plates from dark to bright."""
    pair = pair_seen(Scene(clutter=1), facing_pose(6.7))
    mask = saturated(pair, DETECTOR)
    assert mask is not None
    assert 20 < mask.sum() < 0.02 * mask.size
    assert np.quantile(pair.image_800, 0.9) > 1000


def test_a_dim_marker_beside_bright_ones() -> None:
    """Case S7: one threshold for all loses the shadowed marker, its own threshold finds it."""
    levels = np.full(len(PATTERN), 0.7)
    levels[5] = 0.08
    scene, pose = Scene(levels=levels, clutter=5), facing_pose(4.0)
    pair = pair_seen(scene, pose)
    assert 5 not in recall_and_false(by_paper(pair, scene, 4.0), scene, pose)[0]
    assert recall_and_false(by_best(pair, scene, 4.0), scene, pose)[0] == set(range(10))


def glinting(pair: ImagePair, points_px: Floats, in_800: int, in_850: int) -> ImagePair:
    """Put glints of 5 x 5 pixels into a pair."""
    images: list[Image] = [pair.image_800.copy(), pair.image_850.copy()]
    for u, v in np.rint(points_px).astype(int):
        for image, level in zip(images, (in_800, in_850), strict=True):
            image[v - 2 : v + 3, u - 2 : u + 3] = level
    return replace(pair, image_800=images[0], image_850=images[1])


@pytest.mark.parametrize("detect", [by_paper, by_best])
def test_a_flickering_glint_does_not_set_the_threshold(detect) -> None:
    """Saturated in the second image alone, it would raise 0.2 max above markers at 15 %."""
    scene, pose = Scene(level=0.15), facing_pose(5.0)
    pair = pair_seen(scene, pose)
    glints = glinting(pair, np.array([[100.0, 100.0], [900.0, 120.0]]), 300, 3946)
    threshold = 0.2 * float(clipped_difference(glints).max())
    assert threshold > 0.15 * 3846  # the counter-trial: unmasked, every marker would be lost
    assert recall_and_false(detect(glints, scene, 5.0), scene, pose)[0] == set(range(10))


@pytest.mark.parametrize("detect", [by_paper, by_best])
def test_a_glint_beside_a_marker_does_not_cut_it(detect) -> None:
    scene, pose = Scene(), facing_pose(3.0)
    truth = CAMERA_1024.project(pose @ PATTERN.points_in_target)
    radius = CAMERA_1024.fx * PATTERN.radius_m / 3.0
    beside = truth[[4]] + np.array([radius + 4.5, 0.0])
    pair = glinting(pair_seen(scene, pose), beside, 3946, 3946)
    assert recall_and_false(detect(pair, scene, 3.0), scene, pose)[0] == set(range(10))


@pytest.mark.parametrize("detect", [by_paper, by_best])
def test_markers_that_saturate_are_found(detect) -> None:
    scene, pose = Scene(level=1.5), facing_pose(3.0)
    pair = pair_seen(scene, pose)
    assert recall_and_false(detect(pair, scene, 3.0), scene, pose)[0] == set(range(10))


def test_the_saturation_level_is_below_every_full_well_pixel() -> None:
    full = np.full((200, 200), 10.0)
    scene = Scene()
    pair = image_pair(ExpectedPair(scene, full, full).exposed(0))
    assert (pair.image_850 >= saturation_level_dn(DETECTOR)).all()
    assert saturation_level_dn(DETECTOR) > 0.99 * DETECTOR.saturation_dn


def test_a_saturated_pixel_takes_its_neighbours_along() -> None:
    image = np.full((9, 9), 100, np.uint16)
    bright = image.copy()
    bright[4, 4] = 4000
    pair = ImagePair(bright, image)
    mask = saturated(pair, DETECTOR)
    assert mask is not None
    assert mask[3:6, 3:6].all()
    assert mask.sum() == 9
    assert saturated(ImagePair(image, image), DETECTOR) is None


def test_differences_are_clipped_or_signed() -> None:
    dark, bright = np.full((4, 4), 100, np.uint16), np.full((4, 4), 300, np.uint16)
    pair = ImagePair(bright, dark)
    assert (clipped_difference(pair) == 0).all()
    assert (signed_difference(pair, Region(0, 2, 0, 3)) == -200.0).all()
    assert (clipped_difference(swapped(pair)) == 200).all()


def test_a_marker_at_the_border_is_refused() -> None:
    scene = Scene()
    pose = facing_pose(3.0, aim=np.array([1.3, -0.75, 0.0]))
    radius = CAMERA_1024.fx * PATTERN.radius_m / 3.0
    truth = CAMERA_1024.project(pose @ PATTERN.points_in_target)
    half_out = pose.translation + np.array([-0.5 - truth[4, 0], 0.0, 0.0]) * 3.0 / CAMERA_1024.fx
    pose = RigidTransform(pose.rotation, half_out)  # #5 is cut in half by the left edge
    pair = pair_seen(scene, pose)
    found = by_paper(pair, scene, 3.0)
    assert len(found) == 7
    assert (found.points_px[:, 0] > round(radius) * 1.2 - 0.5).all()


def test_regions_that_overlap_count_a_marker_once() -> None:
    scene, pose = Scene(), facing_pose(4.0)
    pair = pair_seen(scene, pose)
    radius = CAMERA_1024.fx * PATTERN.radius_m / 4.0
    parts = [
        detect_in_region(pair, DETECTOR, region, (radius, radius), BEST)
        for region in (Region(0, 600, 0, 1024), Region(300, 1024, 0, 1024))
    ]
    assert sum(len(part) for part in parts) > 10
    assert len(Candidates.merged(parts, same_px=1.0)) == 10


@pytest.mark.parametrize("share", [0.2, 0.5, 0.8])
@pytest.mark.parametrize(("axis", "beyond"), [(0, True), (0, False), (1, True), (1, False)])
def test_a_disc_that_a_region_cuts_is_left_to_another(
    share: float, axis: int, beyond: bool
) -> None:
    """Half a disc has a centroid of its own, pixels off: with the whole one it would be two."""
    pose = facing_pose(2.9)
    scene = Scene()
    pair = pair_seen(scene, pose)
    radius = CAMERA_1024.fx * PATTERN.radius_m / 2.9
    centre = CAMERA_1024.project(pose @ PATTERN.points_in_target)[9]
    low, high = np.floor(centre - 3.0 * radius), np.ceil(centre + 3.0 * radius)
    around = Region(int(low[1]), int(high[1]), int(low[0]), int(high[0]))
    edge = round(centre[axis] + (2.0 * share - 1.0) * radius)
    low[axis], high[axis] = (edge, high[axis]) if beyond else (low[axis], edge)
    cutting = Region(int(low[1]), int(high[1]), int(low[0]), int(high[0]))
    radii = (0.95 * radius, 1.05 * radius)
    parts = [detect_in_region(pair, DETECTOR, r, radii, BEST) for r in (cutting, around)]
    assert len(parts[0]) == 0
    np.testing.assert_allclose(parts[1].points_px, centre[None], atol=FOUND_PX)


def test_nothing_is_found_in_an_empty_region() -> None:
    pair = image_pair(expected_pair(Scene(), facing_pose(4.0)).exposed(0))
    for region in (Region(0, 0, 0, 0), Region(0, 40, 0, 40)):
        assert len(detect_in_region(pair, DETECTOR, region, (3.0, 3.0), BEST)) == 0
    assert len(Candidates.merged([], same_px=1.0)) == 0
