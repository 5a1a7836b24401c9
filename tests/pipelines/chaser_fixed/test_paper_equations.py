"""The paper's own numbers, and each step of its detection against an independent peer."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from skimage.filters import threshold_otsu
from skimage.measure import label, perimeter, perimeter_crofton, regionprops

from models.arrays import Floats, Mask
from pipelines.chaser_fixed.options import options_for
from pipelines.detection.area_opening import area_threshold_px, expected_radius_px, open_areas
from pipelines.detection.binarisation import (
    LEVELS,
    binarise,
    histogram,
    otsu_threshold,
    threshold_dn,
)
from pipelines.detection.blobs import find_blobs
from pipelines.detection.border_margin import border_margin_px, inside_margin
from pipelines.detection.centroids import weighted_centroids
from pipelines.detection.circularity import chain_perimeters, circularity, crofton_perimeters
from pipelines.pnp.identification import identification_gate_px
from tests.support.synthetic_pair import CAMERA_2048

PAPER = options_for("paper")
RANGE_M, RADIUS_M, SEPARATION_M = 6.7, 0.0127, 0.2


def random_blobs(seed: int, share: float = 0.3) -> Mask:
    """Smooth noise, cut: blobs of many shapes, holes among them."""
    noise = cv2.GaussianBlur(np.random.default_rng(seed).standard_normal((60, 70)), (0, 0), 1.5)
    return np.asarray(noise > np.quantile(noise, 1.0 - share))


def disc(radius: float, centre: tuple[float, float], size: int = 48) -> Mask:
    y, x = np.mgrid[:size, :size]
    return np.asarray((x - centre[0]) ** 2 + (y - centre[1]) ** 2 < radius**2)


def test_the_thresholds_at_the_start_of_the_approach() -> None:
    """At f = 2195.98 px, 6.7 m and Table 11: what equations 3, 4, 7 and 8 give."""
    radius = expected_radius_px(RADIUS_M, RANGE_M, CAMERA_2048.fx)
    assert radius == pytest.approx(4.1625, abs=1e-3)
    assert area_threshold_px(radius, PAPER.s_ao) == 33
    assert border_margin_px(radius, PAPER.s_bord) == pytest.approx(4.8)
    gate = identification_gate_px(SEPARATION_M, RANGE_M, CAMERA_2048.fx, PAPER.s_id)
    assert gate == pytest.approx(131.1, abs=0.1)


def test_area_opening_discards_what_is_smaller() -> None:
    image = np.zeros((20, 40), np.bool_)
    image[2:8, 2:8] = True  # 36 px
    image[2:8, 20:25] = True  # 30 px
    kept = open_areas(find_blobs(image), 33)
    assert kept.area_px.tolist() == [36.0]
    assert open_areas(find_blobs(image), 36).area_px.tolist() == [36.0]


@pytest.mark.parametrize("seed", range(4))
def test_blobs_areas_and_crofton_perimeters_are_scikit_images(seed: int) -> None:
    image = random_blobs(seed)
    theirs = label(image, connectivity=2)
    blobs = find_blobs(image)
    assert len(blobs) == theirs.max()
    crofton = crofton_perimeters(blobs)
    boxes = blobs.bounding_boxes()
    for index in range(len(blobs)):
        first = np.flatnonzero(blobs.label == index)[0]
        own = theirs == theirs[blobs.rows[first], blobs.columns[first]]
        assert blobs.area_px[index] == own.sum()
        assert crofton[index] == pytest.approx(perimeter_crofton(own, directions=4))
        rows, columns = np.nonzero(own)
        assert boxes[index].tolist() == [rows.min(), rows.max(), columns.min(), columns.max()]


def test_the_chain_round_a_disc_is_scikit_images_perimeter() -> None:
    rng = np.random.default_rng(3)
    for radius in (3.0, 6.0, 15.5):
        image = disc(radius, tuple(24.0 + rng.uniform(-0.5, 0.5, 2)))
        theirs = perimeter(image, neighborhood=4)
        assert chain_perimeters(find_blobs(image))[0] == pytest.approx(theirs, abs=1e-4)


@pytest.mark.parametrize("radius", [2.1, 3.0, 4.16, 8.0, 15.5])
def test_discs_of_every_size_pass_for_round(radius: float) -> None:
    """From 1024 px at 6.7 m to 2048 px at 1.8 m, wherever between the pixels."""
    rng = np.random.default_rng(1)
    for _ in range(30):
        blob = find_blobs(disc(radius, tuple(24.0 + rng.uniform(-0.5, 0.5, 2))))
        assert 0.85 < circularity(blob, "crofton")[0] < 1.15


def test_a_line_does_not_pass_for_round() -> None:
    image = np.zeros((30, 60), np.bool_)
    image[10:12, 5:50] = True
    image[20, 5:50] = True
    for measure in ("crofton", "chain"):
        assert (circularity(find_blobs(image), measure) < 0.5).all()


def test_centroids_are_weighted_by_intensity() -> None:
    image = random_blobs(9)
    intensity = np.random.default_rng(2).uniform(1.0, 4000.0, image.shape)
    blobs = find_blobs(image)
    ours = weighted_centroids(blobs, intensity)
    theirs = [
        region.centroid_weighted[::-1]
        for region in regionprops(label(image, connectivity=2), intensity_image=intensity)
    ]
    np.testing.assert_allclose(np.sort(ours, axis=0), np.sort(np.array(theirs), axis=0), atol=1e-9)


def test_the_border_margin_counts_from_the_images_edge() -> None:
    points: Floats = np.array([[4.2, 1000.0], [4.4, 1000.0], [1000.0, 2042.8], [1000.0, 2042.6]])
    assert inside_margin(points, CAMERA_2048, 4.8).tolist() == [False, True, False, True]


@settings(max_examples=25)
@given(st.integers(0, 1000), st.integers(50, 4000), st.integers(5, 400))
def test_no_threshold_parts_better_than_otsus(seed: int, bright: int, share: int) -> None:
    """Otsu's is the least variance within both parts; scikit-image looks among 256 bins."""
    rng = np.random.default_rng(seed)
    image = rng.poisson(20.0, (40, 40)).astype(np.uint16)
    image.reshape(-1)[:share] = rng.poisson(bright, share)

    def within(threshold: float) -> float:
        above = image > threshold
        return sum(float(np.var(part) * part.size) for part in (image[above], image[~above]))

    ours, theirs = otsu_threshold(histogram(image)), float(threshold_otsu(image))
    assert within(ours) <= within(theirs) * (1.0 + 1e-9)


def test_the_threshold_rules() -> None:
    image = np.zeros((32, 32), np.uint16)
    image[:] = 10
    image[4:8, 4:8] = 2000
    image[20, 20] = 3000
    fraction = threshold_dn(image, None, 0.2, "fraction_of_max")
    otsu = threshold_dn(image, None, 0.2, "otsu")
    assert fraction == 600.0
    assert otsu == 10.0
    assert threshold_dn(image, None, 0.2, "larger_of_both") == 600.0
    excluded = np.zeros(image.shape, np.bool_)
    excluded[19:22, 19:22] = True
    assert threshold_dn(image, excluded, 0.2, "fraction_of_max") == 400.0
    assert binarise(image, 600.0).sum() == 17


def test_an_image_of_one_level_has_no_foreground() -> None:
    for level in (0, 7, LEVELS - 1):
        image = np.full((8, 8), level, np.uint16)
        assert not binarise(image, otsu_threshold(histogram(image))).any()
    everything = np.ones((8, 8), np.bool_)
    assert threshold_dn(np.full((8, 8), 9, np.uint16), everything, 0.2, "larger_of_both") == 0.0
