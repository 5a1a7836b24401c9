"""The picture of a frame, with whatever of estimate and truth there is."""

import dataclasses
import shutil

import cv2
import numpy as np
import pytest

from bench.pictures.frame_record import FrameRecords
from bench.pictures.marker_overlay import (
    DETECTION_RED,
    REPROJECTION_GREEN,
    TRUTH_CYAN,
    overlay,
    verdict,
)
from bench.pictures.show import show_frame
from bench.pictures.stretch import SOFTENING, stretch
from models.errors import DatasetError
from models.sensors.camera_chip import Detector
from tests.support.synthetic_dataset import lost_estimate, write_dataset, write_variant


def holds(picture: np.ndarray, colour: tuple[int, int, int]) -> bool:
    """Tell whether a colour is there; anti-aliasing leaves the middle of a stroke pure enough."""
    distance = np.abs(picture.astype(int) - colour).max(axis=-1)
    return bool((distance < 60).any())


MARKS = (DETECTION_RED, REPROJECTION_GREEN, TRUTH_CYAN)


def test_all_three_marks_are_drawn(scored_dataset):
    record = FrameRecords(scored_dataset.folder).record(1)
    assert all(holds(overlay(record, 512), colour) for colour in MARKS)
    picture = show_frame(scored_dataset.folder, 1)
    assert picture.dtype == np.uint8
    assert picture.ndim == 3
    assert all(holds(picture, colour) for colour in MARKS)


def test_marks_lie_on_the_markers(scored_dataset):
    """Each detection's circle is centred on its marker, at whatever size the picture is.

    The red of a circle is looked for at its own radius from where the truth says the marker is.
    """
    record = FrameRecords(scored_dataset.folder).record(0)
    for width_px in (512, 400, 1024):
        picture = overlay(record, width_px).astype(int)
        red = (np.abs(picture - DETECTION_RED).max(axis=-1) < 90).nonzero()
        scale = width_px / 512
        centres = (record.truth.markers_px + 0.5) * scale - 0.5
        radius = 0.9 * max(5.0, 0.011 * width_px)
        gaps = np.hypot(red[1][:, None] - centres[:, 0], red[0][:, None] - centres[:, 1])
        assert len(red[0]) > 50
        assert np.abs(gaps.min(axis=1) - radius).max() < 2.0


def test_without_truth_and_without_estimate(scored_dataset, tmp_path):
    blind = tmp_path / "blind"
    shutil.copytree(scored_dataset.folder, blind)
    shutil.rmtree(blind / "truth")
    record = FrameRecords(blind).record(0)
    assert record.truth is None
    assert "residual" in verdict(record)
    assert "pose from" in verdict(record)
    assert show_frame(blind, 0).size > 0
    shutil.rmtree(blind / "estimates")
    record = FrameRecords(blind).record(0)
    assert verdict(record) == "not estimated"
    picture = overlay(record, 256)
    assert not any(holds(picture, colour) for colour in MARKS)
    assert show_frame(blind, 0).size > 0


def test_a_lost_frame_says_why(tmp_path):
    dataset = write_dataset(tmp_path / "data", frames=1, width_px=128)
    write_variant(dataset, "best", lambda truth: lost_estimate(truth, "nothing found"))
    record = FrameRecords(dataset.folder).record(0)
    assert verdict(record) == "no pose: nothing found"
    assert show_frame(dataset.folder, 0).size > 0


def test_no_such_frame(scored_dataset):
    with pytest.raises(DatasetError, match=r"one of its 4 frames \(0 to 3\), got 99"):
        show_frame(scored_dataset.folder, 99)


def test_a_truncated_frame(scored_dataset, tmp_path):
    copy = tmp_path / "copy"
    shutil.copytree(scored_dataset.folder, copy)
    path = copy / "frames" / "000002_850.png"
    path.write_bytes(path.read_bytes()[:1000])
    with pytest.raises(DatasetError, match=r"000002_850\.png"):
        show_frame(copy, 2)
    assert show_frame(copy, 1).size > 0


def test_stretch_ends_where_it_says():
    detector = Detector()
    full_dn = detector.saturation_dn - detector.bias_dn
    grey = stretch(np.array([-50.0, 0.0, full_dn, 2.0 * full_dn]), detector)
    assert grey.tolist() == pytest.approx([0.0, 0.0, 1.0, 1.0])
    faint = stretch(np.array([1e-3, 2e-3]) * SOFTENING * full_dn, detector)
    assert faint[1] / faint[0] == pytest.approx(2.0, rel=1e-4)  # linear where it is faint


def test_the_picture_is_rgb(scored_dataset, tmp_path):
    """Red first: OpenCV's order is the other way round, and a swap would not show in grey."""
    picture = overlay(FrameRecords(scored_dataset.folder).record(0), 256)
    assert cv2.cvtColor(picture, cv2.COLOR_RGB2HSV)[..., 1].max() > 100
    assert holds(picture, DETECTION_RED)
    assert not holds(picture, DETECTION_RED[::-1])


def test_an_error_is_told_with_digits_that_say_something(scored_dataset):
    """However small: never +0.00, never -0.00."""
    record = FrameRecords(scored_dataset.folder).record(1)
    truth = record.truth.cam_from_target
    near = truth.perturbed([0.0, 0.0, 0.0], [-2e-6, 0.0, 3.14159e-4])
    pose = dataclasses.replace(record.estimate.pose, cam_from_target=near)
    estimate = dataclasses.replace(record.estimate, pose=pose)
    told = verdict(dataclasses.replace(record, estimate=estimate))
    minus = "\N{MINUS SIGN}"
    assert told.startswith(f"position error {minus}0.00200, 0, +0.314 mm; attitude ")
