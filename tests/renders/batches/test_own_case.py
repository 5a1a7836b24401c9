"""A user's own camera, poses, markers and calibration, rendered from scenario to dataset."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from rich.console import Console

from models.camera import Camera
from models.dataset.dataset import Dataset, open_dataset
from models.dataset.marker_file import read_markers
from renders.batches.replay import exposed_frames
from renders.scenario.scenario import RenderRequest, read_scenario
from renders.truth.exposure_truth import read_exposures
from renders.truth.posed_truth import read_posed_truths
from tests.support.own_scenario import OWN_CAMERA, OWN_MARKERS, facing, pose_lines, row_of
from tests.support.small_scenes import needs_jit

WIDTH = 240
SCALE = WIDTH / 1920
QUICK = {"samples": 2, "marker_samples": 64, "max_depth": 2}
CENTROID_PX = 0.15  # a marker fills two pixels here, and shot noise is that of 64 samples


def rendered(folder: Path, table: dict[str, Any], width: int = WIDTH) -> Dataset:
    from renders.batches.render_case import render_case

    needs_jit()
    path = folder / "mine.toml"
    path.write_text(tomli_w.dumps({"name": "mine", "render": QUICK, **table}))
    request = RenderRequest(str(path), folder / "out", width=width, store=folder / "store")
    render_case(request, Console(file=io.StringIO()))
    return open_dataset(folder / "out")


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Two pairs of the bus face with the user's five markers on it."""
    folder = tmp_path_factory.mktemp("own")
    (folder / "poses.csv").write_text("\n".join(pose_lines(2, step_s=10.0)))
    (folder / "markers.toml").write_text(tomli_w.dumps(OWN_MARKERS))
    table = {
        "camera": OWN_CAMERA,
        "detector": {"pixel_pitch_um": 3.45},
        "motion": {"file": "poses.csv"},
        "markers": "markers.toml",
        "calibration": {"sigma_focal_px": 1.0, "sigma_principal_point_px": 1.0},
        "told": {"clock": {"offset_s": {"offset": 0.5}}, "markers": {"place_m": {"sigma": 0.001}}},
    }
    return rendered(folder, table)


def test_each_marker_is_where_the_users_camera_projects_it(own: Dataset) -> None:
    """Pixels, not records: the lit discs' centroids, in the difference of a pair."""
    camera = Camera(**OWN_CAMERA).resized(WIDTH)
    places = np.array([row["point_in_target_m"] for row in OWN_MARKERS["marker"]])
    for number, pose in enumerate((facing(6.0), facing(5.0, (0.5, -0.3, 1.0)))):
        frame = own.frame(number)
        images = [frame.image(name).image.astype(float) for name in ("image_850", "image_800")]
        lit = np.clip(images[0] - images[1], 0.0, None)
        for u, v in camera.project(pose @ places):
            rows, columns = np.mgrid[round(v) - 3 : round(v) + 4, round(u) - 3 : round(u) + 4]
            window = lit[rows, columns]
            window = np.where(window > 0.1 * window.max(), window, 0.0)
            assert window.max() > 300.0
            found = np.array([(window * axis).sum() for axis in (columns, rows)]) / window.sum()
            np.testing.assert_allclose(found, [u, v], atol=CENTROID_PX)


def test_the_pipeline_knows_another_camera_another_clock_and_the_survey(own: Dataset) -> None:
    true = Camera(**OWN_CAMERA).resized(WIDTH)
    camera, markers = own.onboard.camera, own.onboard.markers
    assert (camera.width, camera.height, camera.k1) == (240, 150, -0.22)
    for name in ("fx", "fy", "cx", "cy"):
        assert 0.0 < abs(getattr(camera, name) - getattr(true, name)) < 4.0
    assert markers is not None
    assert markers.names == ("a", "b", "c", "d", "e")
    assert own.onboard.sigmas["markers.point_in_target_m"] == 0.001
    assert [entry.time_s for entry in own.entries] == [0.5, 10.5]
    truths = read_exposures(own.folder)
    assert [truths[frame, 850].time_s for frame in (0, 1)] == [0.0, 10.0]


def test_the_markers_as_installed_are_sealed_where_the_survey_is_off(own: Dataset) -> None:
    installed = read_markers(own.folder / "truth" / "markers.toml")
    places = np.array([row["point_in_target_m"] for row in OWN_MARKERS["marker"]])
    np.testing.assert_array_equal(installed.points_in_target, places)
    assert own.onboard.markers is not None
    assert 0.0 < np.abs(own.onboard.markers.points_in_target - places).max() < 0.006


def test_the_sealed_scenario_needs_no_file_of_the_users(own: Dataset) -> None:
    scenario = read_scenario(own.folder / "truth" / "scenario.toml")
    assert scenario.fingerprint() == own.info.provenance["scenario"]
    assert scenario.markers is not None
    assert scenario.motion.table == tuple(pose_lines(2, step_s=10.0))


def test_run_nought_replays_to_the_bit_and_another_knows_otherwise(own: Dataset) -> None:
    onboard, frames = exposed_frames(own.folder, 0)
    assert onboard.camera == own.onboard.camera
    for again, frame in zip(frames, own.frames(), strict=True):
        assert again.time_s == frame.time_s
        for name in ("image_800", "image_850"):
            assert again.image(name).time_s == frame.image(name).time_s
            np.testing.assert_array_equal(again.image(name).image, frame.image(name).image)
    other, _ = exposed_frames(own.folder, 1)
    assert other.camera != onboard.camera


def test_single_images_of_poses_are_a_dataset_too(tmp_path: Path) -> None:
    header = pose_lines(1)[0]
    lines = [header, row_of(0.0, facing(40.0)), row_of(1.0, facing(50.0, (20.0, 30.0, 40.0)))]
    (tmp_path / "poses.csv").write_text("\n".join(lines))
    table = {
        "target": "xmm",
        "camera": OWN_CAMERA,
        "motion": {"file": "poses.csv"},
        "exposure": {"mode": "fixed", "exposure_ms": 2.0},
    }
    dataset = rendered(tmp_path, table, width=96)
    assert dataset.info.chain == "posed_images"
    assert not (dataset.folder / "truth" / "markers.toml").exists()
    assert [frame.image("image").image.shape for frame in dataset.frames()] == [(60, 96)] * 2
    assert dataset.frame(0).image("image").image.max() > 150  # something is there, above the bias
    truths = read_posed_truths(dataset.folder)
    np.testing.assert_allclose(
        truths[0].cam_from_target.matrix(), facing(40.0).matrix(), atol=1e-12
    )
    assert dataset.onboard.wireframe is not None
    assert len(truths[1].landmarks_px) == len(dataset.onboard.wireframe)
    assert truths[1].landmarks_visible.any()
