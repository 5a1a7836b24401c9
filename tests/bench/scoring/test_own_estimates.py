"""Estimates that somebody else wrote: a pose a frame is enough, and stands beside ours."""

import json
import re
import shutil

import cv2
import numpy as np
import pytest

from bench import api
from bench.cli import main
from models.errors import DatasetError
from tests.support.synthetic_dataset import perfect_estimate, write_dataset, write_variant
from tests.support.synthetic_images import write_images

OFF_M = 0.003
ROUNDING_MM = 1e-6
HEAD = {"format": "rvbench-estimates", "version": 2}


def write_mine(folder, truths, **more) -> None:
    """Write by hand what the format asks for and nothing else: frame, time and a pose."""
    lines = [HEAD]
    for truth in truths:
        pose = truth.cam_from_target
        shifted = (pose.translation + np.array([OFF_M, 0.0, 0.0])).tolist()
        told = {"R_cam_from_target": pose.rotation.tolist(), "t_cam_from_target_m": shifted}
        lines.append({"frame": truth.frame, "time_s": truth.time_s, "pose": {**told, **more}})
    path = folder / "estimates" / "mine.jsonl"
    path.parent.mkdir(exist_ok=True)
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))


@pytest.fixture
def pairs(tmp_path):
    dataset = write_dataset(tmp_path / "pairs", frames=3, width_px=128)
    write_variant(dataset, "best", perfect_estimate)
    write_mine(dataset.folder, dataset.truths)
    return dataset


@pytest.fixture(scope="module")
def images(tmp_path_factory):
    dataset = write_images(tmp_path_factory.mktemp("own") / "images", frames=3, width_px=128)
    write_mine(dataset.folder, dataset.truths)
    return dataset


def test_a_bare_pose_of_pairs_is_scored_beside_ours(pairs):
    scored = api.score(pairs.folder)["pipelines"]
    assert set(scored) == {"best", "mine"}
    core, parts = scored["mine"]["core"], scored["mine"]["parts"]
    assert core["position_error_mm"]["median"] == pytest.approx(1e3 * OFF_M, abs=ROUNDING_MM)
    assert (core["estimated"], core["lost"]["count"], core["wrong"]["count"]) == (3, 0, 0)
    assert core["runtime_ms"] == {"median": None, "p95": None}
    position_mm = parts["axes"]["run_0"]["position_rms_mm"]
    assert position_mm == pytest.approx([1e3 * OFF_M, 0.0, 0.0], abs=ROUNDING_MM)
    # What needs detections or a covariance says that it has none.
    assert parts["efficiency"] == {"position": None, "attitude": None, "frames": 0}
    assert parts["nees"] == {"mean": None, "bounds": None, "consistent": None}
    assert parts["centroids"]["run_0"] == {
        "mean": None, "std": None, "temporal_std": None, "count": 0,
    }  # fmt: skip
    detection = parts["detection"]
    assert (detection["precision"], detection["recall"], detection["blobs"]) == (None, None, 0)
    row = scored["mine"]["per_frame"][0]
    assert (row["sigma_position_mm"], row["bound_position_mm"], row["nees"]) == (None, None, None)


def test_one_frame_with_detections_makes_the_others_count(pairs):
    """Who tells of detections at all is asked for all: recall is over every frame."""
    path = pairs.folder / "estimates" / "mine.jsonl"
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    best = (pairs.folder / "estimates" / "best.jsonl").read_text().splitlines()
    lines[1]["detections"] = json.loads(best[1])["detections"]
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    recall = api.score(pairs.folder)["pipelines"]["mine"]["parts"]["detection"]["recall"]
    assert recall == pytest.approx(1.0 / 3.0, abs=0.05)


def test_a_bare_pose_is_reported_shown_and_summed_up(pairs, capsys):
    folder = str(pairs.folder)
    assert main(["score", folder]) == 0
    told = capsys.readouterr().out
    assert re.search(r"best +mine", told)
    assert main(["report", folder]) == 0
    text = (pairs.folder / "report.html").read_text()
    assert "mine" in text
    out = pairs.folder / "mine.png"
    assert main(["show", folder, "0", "--variant", "mine", "--out", str(out)]) == 0
    assert cv2.imread(str(out)) is not None


def test_mine_alone(pairs, capsys):
    (pairs.folder / "estimates" / "best.jsonl").unlink()
    folder = str(pairs.folder)
    assert main(["score", folder, "--fail-above-mm", "1"]) == 1
    assert "worse than asked: mine has a 95th percentile of 3 mm" in capsys.readouterr().out
    assert main(["score", folder, "--fail-above-mm", "4"]) == 0
    assert main(["report", folder]) == 0


def test_a_bare_pose_of_single_images_is_what_its_pipeline_stands_by(images):
    scored = api.score(images.folder)["pipelines"]["mine"]
    core, parts = scored["core"], scored["parts"]
    assert (core["frames"], core["estimated"], core["lost"]["count"]) == (3, 3, 0)
    assert core["position_error_mm"]["median"] == pytest.approx(1e3 * OFF_M, abs=ROUNDING_MM)
    assert core["wrong"]["count"] == 0
    state, corners = parts["state"], parts["corners"]
    assert (state["with_state"], state["first_state"], state["lost_share"]) == (0, None, None)
    assert state["position_m"] == {"median": None, "p95": None, "rms": None}
    assert state["raw_position_m"]["median"] == pytest.approx(OFF_M, abs=1e-3 * ROUNDING_MM)
    assert state["nees"]["translation"] == {"mean": None, "inside": None}
    assert corners["repeatability"] is corners["precision"] is corners["detected"] is None
    assert corners["visible"] > 0
    assert {limit["of"] for limit in parts["limits"]} == {"visible landmarks", "sunlit share"}
    assert parts["starts"] is None


def test_images_of_a_bare_pose_are_reported_and_shown(images, tmp_path, capsys):
    folder = tmp_path / "copy"
    shutil.copytree(images.folder, folder)
    assert main(["score", str(folder)]) == 0
    assert main(["report", str(folder)]) == 0
    assert "estimated: position error" in (folder / "report.html").read_text()
    assert main(["show", str(folder), "0", "--variant", "mine"]) == 0


def test_a_wrong_bare_pose_of_an_image_is_wrong_and_missed_ones_count(images, tmp_path):
    """Half a turn about x in one frame, nothing in the next, and no covariance to excuse it."""
    folder = tmp_path / "copy"
    shutil.copytree(images.folder, folder)
    path = folder / "estimates" / "mine.jsonl"
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    turned = np.array(lines[2]["pose"]["R_cam_from_target"]) @ np.diag([1.0, -1.0, -1.0])
    lines[2]["pose"]["R_cam_from_target"] = turned.tolist()
    del lines[3]["pose"]
    lines[3]["reason"] = "gone"
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    scored = api.score(folder)["pipelines"]["mine"]
    assert scored["core"]["wrong"] == {"count": 1, "longest": 1, "frames": [1]}
    assert scored["per_frame"][1]["confusion"] in ("half turn about x", "symmetry")
    assert (scored["core"]["lost"]["missed"], scored["core"]["estimated"]) == (1, 2)


def test_a_state_alone_is_lost_without_a_reason_told(images, tmp_path):
    """A frame may say a state and no word of why its image gave no pose."""
    folder = tmp_path / "copy"
    shutil.copytree(images.folder, folder)
    path = folder / "estimates" / "mine.jsonl"
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    del lines[1]["pose"]
    lines[1]["states"] = {"battery": {"values": {"charge": 0.5}}}
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    scored = api.score(folder)["pipelines"]["mine"]
    assert scored["core"]["lost"]["reasons"] == {"none told": 1}
    assert scored["per_frame"][0]["reason"] == "none told"
    assert "none told" in api.report(folder).read_text()


@pytest.mark.parametrize(
    ("states", "message"),
    [
        ({"values": {"rho_in_lvlh_m": [1, 2, 3]}}, "rho_dot_in_lvlh_m_s"),
        ({"values": {"rho_in_lvlh_m": [1, 2], "rho_dot_in_lvlh_m_s": [0, 0, 0]}}, "rho_in_lvlh_m"),
        (
            {
                "values": {"rho_in_lvlh_m": [1, 2, 3], "rho_dot_in_lvlh_m_s": [0, 0, 0]},
                "covariance": [[1.0]],
            },
            r"relative_translation\.covariance",
        ),
    ],
)
def test_a_state_that_is_something_else_is_refused(images, tmp_path, states, message):
    folder = tmp_path / "copy"
    shutil.copytree(images.folder, folder)
    path = folder / "estimates" / "mine.jsonl"
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    turn = {
        "R_lvlh_from_target": np.eye(3).tolist(),
        "omega_target_wrt_lvlh_in_target_rad_s": [0.0, 0.0, 0.0],
    }
    lines[1]["states"] = {"relative_translation": states, "relative_rotation": {"values": turn}}
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    with pytest.raises(DatasetError, match=message):
        api.score(folder)
