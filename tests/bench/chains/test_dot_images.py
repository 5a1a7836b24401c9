"""The chain of white dots, whole: rendered, estimated, scored, reported, shown and stepped."""

from __future__ import annotations

import io
import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from rich.console import Console

from models.dataset.dataset import open_dataset
from models.frame import IMAGE
from models.pose import pose_error
from pipelines.eye_in_hand.registered import make
from renders.scenario.scenario import RenderRequest
from renders.truth.exposure_truth import read_exposures
from tests.support.small_scenes import needs_jit
from tests.support.whole_runs import rvbench

WIDTH = 512  # a dot is nine pixels across at the far end
RENDERED_PX = 0.06  # a dot's centre, of 4.4 px radius, at 64 samples a pixel


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three frames, near the end, rendered."""
    from renders.batches.render_case import render_case

    needs_jit()
    home = tmp_path_factory.mktemp("dots")
    table = (Path(__file__).parents[3] / "bench/cases/grasp-approach.toml").read_text()
    case = home / "dots.toml"
    case.write_text(table.replace("marker_samples = 256", "marker_samples = 64"))
    request = RenderRequest(
        str(case), home / "out", start_s=318.0, end_s=322.0, rate_hz=0.5, width=WIDTH, spp=4,
        store=home / "store",
    )  # fmt: skip
    render_case(request, Console(file=io.StringIO()))
    return home / "out"


def test_the_whole_run_is_scored_reported_and_shown(run: Path) -> None:
    for verb in ("estimate", "score", "report"):
        code, said = rvbench(verb, run)
        assert code == 0, said
    score = json.loads((run / "score.json").read_text())
    assert score["chain"] == "dot_images"
    for label, within_mm in (("best", 0.3), ("paper", 3.0)):
        own = score["pipelines"][label]
        assert own["core"]["estimated"] == 3
        assert own["core"]["wrong"]["count"] == 0
        assert own["core"]["position_error_mm"]["p95"] < within_mm
    rivals = score["pipelines"]["best"]["parts"]["rivals"]
    assert rivals["poses"] == rivals["with_rival"] == 3
    assert rivals["rival_was_right"] == 0
    page = (run / "report.html").read_text()
    assert "Poses that fit as well" in page
    assert "colour images" in page
    code, said = rvbench("show", run, 0)
    assert code == 0, said
    picture = cv2.imread(str(next((run / "show").glob("*.png"))))
    assert picture is not None
    assert picture.std(axis=2).max() > 10.0  # in colour


def test_a_rendered_dot_is_where_the_truth_has_it(run: Path) -> None:
    dataset, truth = open_dataset(run), read_exposures(run)
    pipeline = make(dataset.onboard, "best")
    for entry in dataset.entries:
        said = pipeline.process(dataset.frame(entry.index))
        true = truth[(entry.index, 0)]
        assert said.pose is not None, said.reason
        assert true.lamp_lit.min() > 0.99
        for point, marker in zip(said.detected.points_px, said.detected.marker, strict=True):
            if marker >= 0:
                assert np.abs(point - true.markers_px[marker]).max() < RENDERED_PX
        assert pose_error(said.pose.cam_from_target, true.cam_from_target).attitude_deg < 0.1


def test_images_are_raw_mosaics(run: Path) -> None:
    raw = open_dataset(run).frame(0).image(IMAGE).image.astype(float)
    assert raw.shape == (WIDTH, WIDTH)
    red, blue = raw[0::2, 0::2].mean(), raw[1::2, 1::2].mean()
    assert red > 1.5 * blue  # amber foil


def test_frame_by_frame_gives_the_batchs_images(run: Path, tmp_path: Path) -> None:
    from renders.batches.stepping import Simulation

    dataset = open_dataset(run)
    case = str(run / "truth" / "scenario.toml")
    frame = Simulation(case, store=tmp_path).frame(dataset.entries[0].time_s)
    assert np.array_equal(frame.image(IMAGE).image, dataset.frame(0).image(IMAGE).image)


def test_a_dataset_without_a_prior_says_so(run: Path) -> None:
    onboard = replace(open_dataset(run).onboard, prior=None)
    with pytest.raises(Exception, match=r"prior\.toml for the pipeline eye_in_hand"):
        make(onboard, "best")
