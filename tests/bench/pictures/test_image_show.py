"""The picture of a single image: its wireframe lies on its edges, at whatever size it is drawn."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from bench.pictures.image_records import ImageRecords
from models.dataset.navigation_estimates_file import write_navigation_estimates
from models.uncooperative import NavigationEstimate

from bench import api
from bench.cli import main
from bench.estimating.runs import estimates_path
from bench.pictures.image_show import show_image
from bench.pictures.wireframe_overlay import (
    CORNER_RED,
    ESTIMATE_GREEN,
    TRUTH_CYAN,
    window_around,
    wireframe_overlay,
)
from models.errors import DatasetError
from models.estimate import Detections, NoPose, PoseEstimate
from tests.support.synthetic_dataset import write_dataset
from tests.support.synthetic_images import SyntheticImages, write_images

LOST_FRAME = 2


def found(data: SyntheticImages, frame: int) -> NavigationEstimate:
    """Return an estimate that is right but for 0.3 m along the boresight, with two corners."""
    truth = data.truths[frame]
    corners = Detections(truth.landmarks_px[:2], np.full((2, 2), 0.5), (0, -1), (True, False))
    pose = PoseEstimate(frame, truth.time_s, truth.cam_from_target, np.eye(6), corners, 0.5)
    beyond = truth.state.rho_in_lvlh + np.array([0.0, 0.3, 0.0])
    state = replace(truth.state, rho_in_lvlh=beyond)
    return NavigationEstimate(frame, truth.time_s, "tracked", pose, state, np.eye(6), np.eye(6))


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> SyntheticImages:
    written = write_images(tmp_path_factory.mktemp("show") / "data", frames=3, step_s=40.0)
    nothing = Detections(np.empty((0, 2)), np.empty((0, 2)), (), ())
    time_s = written.truths[LOST_FRAME].time_s
    said = [found(written, 0), found(written, 1)]
    said.append(
        NavigationEstimate(
            LOST_FRAME,
            time_s,
            "searching",
            NoPose(LOST_FRAME, time_s, "too dark", nothing),
            None,
            None,
            None,
        )
    )
    write_navigation_estimates(estimates_path(written.folder, 0, "best"), said)
    return written


def places_of(picture: np.ndarray, colour: tuple[int, int, int]) -> np.ndarray:
    """Return where a colour is, (n, 2), u before v; its strokes are anti-aliased."""
    near = np.abs(picture.astype(int) - colour).max(axis=-1) < 60
    return np.argwhere(near)[:, ::-1]


@pytest.mark.parametrize("width_px", [512, 400, 1024])
def test_the_true_wireframe_lies_on_the_edges_of_the_picture(
    data: SyntheticImages, width_px: int
) -> None:
    """Each landmark that is seen is the end of a stroke; in the painted image it is a corner."""
    record = ImageRecords(data.folder).record(1)
    picture = wireframe_overlay(record.frame, record.knowledge, width_px, truth=record.truth)
    assert picture.shape == (width_px, width_px, 3)
    strokes = places_of(picture, TRUTH_CYAN)
    ends = (data.truths[1].landmarks_px[data.truths[1].landmarks_visible] + 0.5) * (width_px / 512)
    gaps = np.linalg.norm(strokes[:, None] - (ends - 0.5), axis=2).min(axis=0)
    assert len(ends) >= 8
    assert np.median(gaps) < 1.5  # a stroke's width; a few corners end no edge
    lit = cv2.dilate(picture.max(axis=2), np.ones((5, 5)))[strokes[:, 1], strokes[:, 0]]
    assert (lit > 60).all()


def test_what_is_estimated_is_drawn_over_what_is_true(data: SyntheticImages) -> None:
    record = ImageRecords(data.folder).record(1)
    assert record.estimate is not None
    drawn = wireframe_overlay(
        record.frame, record.knowledge, 1024, estimate=record.estimate, truth=record.truth
    )
    for colour in (ESTIMATE_GREEN, TRUTH_CYAN, CORNER_RED):
        assert len(places_of(drawn, colour)) > 20
    at_truth = replace(record.estimate, state=record.truth.state if record.truth else None)
    same = wireframe_overlay(
        record.frame, record.knowledge, 1024, estimate=at_truth, truth=record.truth
    )
    assert len(places_of(same, TRUTH_CYAN)) < 0.05 * len(places_of(drawn, TRUTH_CYAN))


def test_a_close_view_holds_the_whole_target_and_magnifies_it(data: SyntheticImages) -> None:
    record = ImageRecords(data.folder).record(0)
    assert record.truth is not None
    window = window_around(record.knowledge, record.truth.cam_from_target)
    assert window is not None
    left, top, side = window
    pixels = record.truth.landmarks_px
    assert (pixels > [left, top]).all()
    assert (pixels < [left + side, top + side]).all()
    near = wireframe_overlay(record.frame, record.knowledge, 500, truth=record.truth, window=window)
    strokes = places_of(near, TRUTH_CYAN)
    ends = (pixels[record.truth.landmarks_visible] - [left, top]) * (500 / side) - 0.5
    gaps = np.linalg.norm(strokes[:, None] - ends, axis=2).min(axis=0)
    assert np.median(gaps) < 1.5
    behind = record.truth.cam_from_target.perturbed([0, 0, 0], [0, 0, -100.0])
    assert window_around(record.knowledge, behind) is None


def test_verdicts_say_how_wrong_or_why_not(data: SyntheticImages, tmp_path: Path) -> None:
    records = ImageRecords(data.folder)
    assert records.record(0).verdict == "tracked: position error 0, 0, +300 mm; attitude 0 deg"
    assert "no pose from this image: too dark" in records.record(LOST_FRAME).verdict
    blind = tmp_path / "blind"
    shutil.copytree(data.folder, blind)
    shutil.rmtree(blind / "truth")
    assert ImageRecords(blind).record(0).verdict == "tracked"
    assert show_image(blind, 0).shape[2] == 3
    assert show_image(blind, LOST_FRAME).size > 0
    shutil.rmtree(blind / "estimates")
    assert ImageRecords(blind).record(0).verdict == "not estimated"
    assert show_image(blind, 0).size > 0


def test_no_such_frame_or_variant(data: SyntheticImages) -> None:
    with pytest.raises(DatasetError, match=r"one of its 3 frames \(0 to 2\), got 9"):
        ImageRecords(data.folder).record(9)
    with pytest.raises(DatasetError, match="expected a variant with estimates, best"):
        ImageRecords(data.folder, "paper")


def test_the_verb_tells_images_from_pairs(data: SyntheticImages, tmp_path: Path) -> None:
    pairs = write_dataset(tmp_path / "pairs", frames=1).folder
    assert api.holds_images(data.folder)
    assert not api.holds_images(pairs)
    for folder in (data.folder, pairs):
        out = tmp_path / "shown" / f"{folder.name}.png"
        assert main(["show", str(folder), "0", "--out", str(out)]) == 0
        assert cv2.imread(str(out)) is not None
