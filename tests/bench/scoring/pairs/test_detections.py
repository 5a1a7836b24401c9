"""What counts as found, and what as a mismatch, one case at a time."""

import numpy as np
import pytest

from bench.scoring.pairs.detections import detection_score, judge, visible_markers
from models.camera import camera_preset
from models.estimate import Detections
from models.spacecraft.retroreflector_layout import RETROREFLECTORS
from renders.truth.exposure_truth import ExposureTruth
from tests.support.synthetic_dataset import true_exposure, true_pose

CAMERA = camera_preset("chaser_fixed")


def seen_from(range_m: float, **changes: object) -> ExposureTruth:
    truth = true_exposure(0, 850, 0.0, true_pose(range_m, 0.0), CAMERA)
    return ExposureTruth(**{**vars(truth), **changes})


def found(points: np.ndarray, marker: list[int], used: list[bool] | None = None) -> Detections:
    kept = tuple(used or [index >= 0 for index in marker])
    return Detections(points.reshape(-1, 2), np.full((len(marker), 2), 0.1), tuple(marker), kept)


def score(truth: ExposureTruth, detections: Detections):
    markers = visible_markers(truth, CAMERA, RETROREFLECTORS)
    return detection_score([(judge(detections, markers), markers)])


def test_the_truth_is_all_found():
    truth = seen_from(6.0)
    result = score(truth, found(truth.markers_px, list(range(10))))
    assert (result.precision, result.recall, result.mismatches) == (1.0, 1.0, 0)
    assert (result.blobs, result.blob_precision, result.expected) == (10, 1.0, 10)


def test_swapped_markers_are_two_mismatches():
    truth = seen_from(6.0)
    result = score(truth, found(truth.markers_px, [1, 0, *range(2, 10)]))
    assert result.mismatches == 2
    assert result.precision == pytest.approx(0.8)
    assert result.recall == pytest.approx(0.8)
    assert result.blob_precision == 1.0


def test_a_mismatch_that_the_solver_threw_out_is_told_apart():
    truth = seen_from(6.0)
    used = [False, True, *[True] * 8]
    result = score(truth, found(truth.markers_px, [1, 0, *range(2, 10)], used))
    assert (result.mismatches, result.mismatches_used) == (2, 1)


def test_an_unmatched_glint_costs_blob_precision_alone():
    truth = seen_from(6.0)
    points = np.vstack([truth.markers_px, [30.0, 30.0]])
    result = score(truth, found(points, [*range(10), -1]))
    assert (result.precision, result.recall, result.mismatches) == (1.0, 1.0, 0)
    assert result.blob_precision == pytest.approx(10 / 11)


@pytest.mark.parametrize(("range_m", "gate_px"), [(12.0, 1.5), (2.0, 6.97)])
def test_the_gate_is_pixels_far_off_and_half_a_radius_near(range_m, gate_px):
    """At 12 m a marker's radius is 2.3 px, so 1.5 px hold; at 2 m it is 13.9 px, so half of it."""
    truth = seen_from(range_m)
    seen = int(np.flatnonzero(truth.visible)[4])
    for share, true in ((0.97, True), (1.03, False)):
        point = truth.markers_px[seen] + [share * gate_px, 0.0]
        result = score(truth, found(point, [seen]))
        assert result.mismatches == (0 if true else 1)


def test_a_hidden_marker_cannot_be_found():
    visible = np.ones(10)
    visible[3] = 0.0
    truth = seen_from(6.0, visible=visible)
    result = score(truth, found(truth.markers_px[3], [3]))
    assert (result.mismatches, result.blob_precision) == (1, 0.0)


@pytest.mark.parametrize("key", ["visible", "lamp_lit"])
def test_a_marker_half_seen_or_half_lit_may_be_missed_and_may_be_found(key):
    share = np.ones(10)
    share[3] = 0.5
    truth = seen_from(6.0, **{key: share})
    others = [index for index in range(10) if index != 3]
    missed = score(truth, found(truth.markers_px[others], others))
    taken = score(truth, found(truth.markers_px, list(range(10))))
    assert (missed.expected, missed.recall, taken.recall) == (9, 1.0, 1.0)
    assert taken.precision == 1.0


def test_a_marker_at_the_border_is_not_expected():
    truth = seen_from(6.0)
    radius_px = CAMERA.fx * RETROREFLECTORS.radius_m / 6.0
    centres = truth.markers_px.copy()
    centres[0, 0] = 1.3 * radius_px
    markers = visible_markers(seen_from(6.0, markers_px=centres), CAMERA, RETROREFLECTORS)
    assert markers.whole[0]
    assert not markers.expected[0]


def test_a_marker_found_twice_counts_once():
    truth = seen_from(6.0)
    points = np.vstack([truth.markers_px[0], truth.markers_px[0] + 0.5])
    assert score(truth, found(points, [0, 0])).recall == pytest.approx(0.1)


def test_nothing_found():
    result = score(seen_from(6.0), found(np.empty((0, 2)), []))
    assert (result.precision, result.recall, result.blobs) == (None, 0.0, 0)


def test_a_marker_behind_the_camera_is_nowhere():
    pixels = seen_from(6.0).markers_px.copy()
    pixels[2] = np.nan
    truth = seen_from(6.0, markers_px=pixels)
    result = score(truth, found(np.array([[5.0, 5.0]]), [2]))
    assert (result.mismatches, result.expected) == (1, 9)
