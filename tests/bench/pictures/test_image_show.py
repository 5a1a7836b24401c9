"""The picture of a single image: its wireframe lies on its edges, at whatever size it is drawn."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from bench.cli import main
from bench.estimating.runs import estimates_path
from bench.pictures.frame_record import FrameRecords
from bench.pictures.show import show_frame
from bench.pictures.wireframe_overlay import (
    CORNER_RED,
    ESTIMATE_GREEN,
    TRUTH_CYAN,
    verdict,
    window_around,
    wireframe_overlay,
)
from models.dataset.dataset import open_dataset
from models.dataset.estimates_file import write_estimates
from models.errors import DatasetError
from models.estimate import Detections, Estimate, PoseEstimate
from tests.support.synthetic_dataset import write_dataset
from tests.support.synthetic_images import SyntheticImages, write_images

LOST_FRAME = 2


def found(data: SyntheticImages, frame: int) -> Estimate:
    """Return an estimate that is right but for 0.3 m along the boresight, with two corners."""
    truth = data.truths[frame]
    corners = Detections(truth.landmarks_px[:2], np.full((2, 2), 0.5), (0, -1), (True, False))
    pose = PoseEstimate(truth.cam_from_target, np.eye(6), 0.5)
    beyond = truth.state.rho_in_lvlh + np.array([0.0, 0.3, 0.0])
    states = replace(truth.state, rho_in_lvlh=beyond).named(np.eye(6), np.eye(6))
    return Estimate(frame, truth.time_s, pose, detections=corners, mode="tracked", states=states)


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> SyntheticImages:
    written = write_images(tmp_path_factory.mktemp("show") / "data", frames=3, step_s=40.0)
    time_s = written.truths[LOST_FRAME].time_s
    lost = Estimate(
        LOST_FRAME, time_s, reason="too dark", detections=Detections.none(), mode="searching"
    )
    said = [found(written, 0), found(written, 1), lost]
    write_estimates(estimates_path(written.folder, 0, "best"), said)
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
    record = replace(FrameRecords(data.folder).record(1), estimate=None)
    picture = wireframe_overlay(record, width_px)
    assert picture.shape == (width_px, width_px, 3)
    strokes = places_of(picture, TRUTH_CYAN)
    ends = (data.truths[1].landmarks_px[data.truths[1].landmarks_visible] + 0.5) * (width_px / 512)
    gaps = np.linalg.norm(strokes[:, None] - (ends - 0.5), axis=2).min(axis=0)
    assert len(ends) >= 8
    assert np.median(gaps) < 1.5  # a stroke's width; a few corners end no edge
    lit = cv2.dilate(picture.max(axis=2), np.ones((5, 5)))[strokes[:, 1], strokes[:, 0]]
    assert (lit > 60).all()


def test_what_is_estimated_is_drawn_over_what_is_true(data: SyntheticImages) -> None:
    record = FrameRecords(data.folder).record(1)
    assert record.estimate is not None
    drawn = wireframe_overlay(record, 1024)
    for colour in (ESTIMATE_GREEN, TRUTH_CYAN, CORNER_RED):
        assert len(places_of(drawn, colour)) > 20
    at_truth = replace(record.estimate, states=record.truth.state.named(None, None))
    same = wireframe_overlay(replace(record, estimate=at_truth), 1024)
    assert len(places_of(same, TRUTH_CYAN)) < 0.05 * len(places_of(drawn, TRUTH_CYAN))
    blind = wireframe_overlay(record, 1024, truth=False)
    assert not len(places_of(blind, TRUTH_CYAN))


def test_a_close_view_holds_the_whole_target_and_magnifies_it(data: SyntheticImages) -> None:
    record = replace(FrameRecords(data.folder).record(0), estimate=None)
    assert record.truth is not None
    window = window_around(record.onboard, record.truth.cam_from_target)
    assert window is not None
    left, top, side = window
    pixels = record.truth.landmarks_px
    assert (pixels > [left, top]).all()
    assert (pixels < [left + side, top + side]).all()
    near = wireframe_overlay(record, 500, window=window)
    strokes = places_of(near, TRUTH_CYAN)
    ends = (pixels[record.truth.landmarks_visible] - [left, top]) * (500 / side) - 0.5
    gaps = np.linalg.norm(strokes[:, None] - ends, axis=2).min(axis=0)
    assert np.median(gaps) < 1.5
    behind = record.truth.cam_from_target.perturbed([0, 0, 0], [0, 0, -100.0])
    assert window_around(record.onboard, behind) is None


def test_verdicts_say_how_wrong_or_why_not(data: SyntheticImages, tmp_path: Path) -> None:
    records = FrameRecords(data.folder)
    assert verdict(records.record(0)) == ("tracked: position error 0, 0, +300 mm; attitude 0 deg")
    assert "no pose from this image: too dark" in verdict(records.record(LOST_FRAME))
    blind = tmp_path / "blind"
    shutil.copytree(data.folder, blind)
    shutil.rmtree(blind / "truth")
    assert verdict(FrameRecords(blind).record(0)) == "tracked"
    assert show_frame(blind, 0).shape[2] == 3
    assert show_frame(blind, LOST_FRAME).size > 0
    shutil.rmtree(blind / "estimates")
    assert verdict(FrameRecords(blind).record(0)) == "not estimated"
    assert show_frame(blind, 0).size > 0


def test_no_such_frame_or_variant(data: SyntheticImages) -> None:
    with pytest.raises(DatasetError, match=r"one of its 3 frames \(0 to 2\), got 9"):
        FrameRecords(data.folder).record(9)
    with pytest.raises(DatasetError, match="expected a variant with estimates, best"):
        FrameRecords(data.folder, "paper")


def test_the_verb_tells_images_from_pairs(data: SyntheticImages, tmp_path: Path) -> None:
    pairs = write_dataset(tmp_path / "pairs", frames=1).folder
    assert open_dataset(data.folder).info.chain == "tumble_images"
    assert open_dataset(pairs).info.chain == "retroreflector_pairs"
    shapes = set()
    for folder in (data.folder, pairs):
        out = tmp_path / "shown" / f"{folder.name}.png"
        assert main(["show", str(folder), "0", "--out", str(out)]) == 0
        shapes.add(cv2.imread(str(out)).shape)
    assert len(shapes) == 2  # each laid open in its own way
