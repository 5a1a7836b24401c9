"""What the explorer is given: score.json's numbers, the pictures' marks, text that runs nothing."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import struct

import cv2
import numpy as np
import pytest

from bench import api
from bench.estimating.runs import read_run
from bench.pictures.frame_record import FrameRecords
from bench.pictures.stretch import stretch
from bench.report.explorer.build_meshes import MOST_FACES
from bench.report.explorer.glb import Surface, glb_bytes
from bench.report.explorer.inlined import HERE, LIBRARIES, policy, safe_json
from bench.report.explorer.previews import (
    LEAST_IN_ALL,
    MOST_IN_ALL,
    MOST_PREVIEWS,
    Previews,
    shown_places,
)
from bench.report.explorer.scene import MESHES, pose_numbers
from models.dataset.dataset import open_dataset
from models.sensors.camera_chip import Detector
from models.spacecraft.catalogue import TARGETS
from tests.support.synthetic_dataset import (
    lost_estimate,
    solved_estimate,
    write_dataset,
    write_variant,
)

HOSTILE = "</script><script>document.title='taken'</script><!-- \u2028 ]]> &amp; \"'"


def explorer_of(text: str) -> dict:
    (found,) = re.findall(r'id="explorer-data">(.*?)</script>', text, re.DOTALL)
    return json.loads(found)


@pytest.fixture(scope="module")
def explored(scored_dataset) -> dict:
    return explorer_of((scored_dataset.folder / "report.html").read_text())


@pytest.fixture(scope="module")
def score(scored_dataset) -> dict:
    return json.loads((scored_dataset.folder / "score.json").read_text())


def test_the_plots_hold_the_scores_own_numbers(explored, score):
    plots = {plot["title"]: plot["lines"] for plot in explored["plots"]}
    assert len(plots) == 7
    for label, own in score["pipelines"].items():
        for title, key in (("position along", "position_mm"), ("attitude about", None)):
            for axis in range(3):
                lines = {line["label"]: line for line in plots[f"{title} {'xyz'[axis]}"]}
                name = key or "rotation_vector_deg"
                rows = [row[name] for row in own["per_frame"]]
                told = [None if row is None else row[axis] for row in rows]
                assert lines[f"{label}: error"]["values"] == told
                sigma = "sigma_position_mm" if key else "sigma_rotation_deg"
                stated = [row[sigma] for row in own["per_frame"]]
                assert lines[f"{label}: 3 sigma stated"]["values"] == [
                    None if row is None else 3.0 * row[axis] for row in stated
                ]


def test_frames_verdicts_and_reasons_are_those_of_the_score(explored, score):
    rows = score["pipelines"][explored["leading"]]["per_frame"]
    assert [each["frame"] for each in explored["frames"]] == [row["frame"] for row in rows]
    assert [each["time_s"] for each in explored["frames"]] == [row["time_s"] for row in rows]
    for label, own in explored["pipelines"].items():
        told = score["pipelines"][label]["per_frame"]
        assert own["reasons"] == [row["reason"] for row in told]
        assert len(own["verdicts"]) == len(own["poses"]) == len(own["layers"]) == len(rows)


def test_marks_stand_where_detections_and_truth_are(explored, scored_dataset):
    records = FrameRecords(scored_dataset.folder, "best")
    for place, index in enumerate(records.dataset.indices):
        record = records.record(index)
        layers = {layer["name"]: layer for layer in explored["pipelines"]["best"]["layers"][place]}
        (truth,) = explored["true_layers"][place]
        seen = record.truth.markers_px[record.truth.visible > 0.0]
        assert np.allclose(truth["places_px"], seen, atol=0.006)
        found = record.estimate.detected
        assert np.allclose(layers["detections"]["places_px"], found.points_px, atol=0.006)
        assert len(layers["reprojections"]["places_px"]) == len(layers["reprojections"]["labels"])


def test_the_scene_has_the_true_and_the_estimated_pose(explored, scored_dataset):
    records = FrameRecords(scored_dataset.folder, "best")
    record = records.record(records.dataset.indices[1])
    assert explored["scene"]["true"][1] == pose_numbers(record.true_pose)
    assert explored["pipelines"]["best"]["poses"][1] == pose_numbers(record.estimated_pose)
    assert explored["scene"]["sun_in_target"][1] == record.truth.sun_dir_in_target.tolist()
    rays = np.array(explored["scene"]["corner_rays_in_cam"])
    corners = records.onboard.camera.project(rays)
    size = [records.onboard.camera.width, records.onboard.camera.height]
    assert np.allclose(corners, [[-0.5, -0.5], [size[0] - 0.5, -0.5], np.array(size) - 0.5,
                                 [-0.5, size[1] - 0.5]], atol=1e-3)  # fmt: skip


def test_both_images_of_a_pair_are_there_that_of_the_marks_first(explored, scored_dataset):
    first, second = explored["image"]["streams"]
    assert (first["name"], second["name"]) == ("850 nm", "800 nm")
    count = len(explored["frames"])
    assert len(first["pictures"]) == len(second["pictures"]) == count
    lit, dark = (
        cv2.imdecode(np.frombuffer(base64.b64decode(each["pictures"][0]), np.uint8), 0).max()
        for each in (first, second)
    )
    assert lit > dark + 50  # the synthetic markers answer at 850 nm alone


def test_every_run_is_told_with_its_own_errors(tmp_path):
    dataset = write_dataset(tmp_path / "data", frames=2, width_px=64)
    rng = np.random.default_rng(2)

    def said(truth):
        return solved_estimate(dataset, truth, np.full(2, 0.2), rng)

    for run in range(3):
        write_variant(dataset, "best", said, run)
    api.score(dataset.folder)
    found = explorer_of(api.report(dataset.folder).read_text())
    runs = found["pipelines"]["best"]["runs"]
    assert [each["run"] for each in runs] == [1, 2]
    plot = found["plots"][0]
    assert plot["title"] == "position error of every run"
    spread, chosen = plot["lines"]
    every = [chosen["values"], *(run["sizes"][chosen["size"]] for run in runs)]
    assert {words for run in runs for words in run["verdicts"]} == {None}
    truths = [truth.cam_from_target.translation for truth in dataset.truths]
    for number in (0, 1, 2):
        said_there = read_run(open_dataset(dataset.folder), number, "best").estimates
        told = [
            1e3 * float(np.linalg.norm(said_there[k].pose.cam_from_target.translation - was))
            for k, was in enumerate(truths)
        ]
        assert every[number] == pytest.approx(told, rel=1e-4)
        if number:
            poses = [pose_numbers(said_there[k].pose.cam_from_target) for k in (0, 1)]
            assert runs[number - 1]["poses"] == poses
    assert spread["values"] == np.min(every, axis=0).tolist()
    assert spread["upper"] == np.max(every, axis=0).tolist()


def test_only_scripts_of_the_page_may_run(scored_dataset):
    text = (scored_dataset.folder / "report.html").read_text()
    (told,) = re.findall(r'Content-Security-Policy" content="([^"]*)"', text)
    scripts = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)
    assert len(scripts) == 2
    for script in scripts:
        digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
        assert f"'sha256-{digest}'" in told
    assert "default-src 'none'" in told
    assert "script-src 'none'" in policy(())
    assert not re.search(r"<script[^>]+src=", text)
    assert not re.search(r"<[a-z]+[^>]* on[a-z]+=", re.sub(r"<script.*?</script>", "", text,
                                                           flags=re.DOTALL))  # fmt: skip


def test_hostile_text_stays_text(tmp_path):
    dataset = write_dataset(tmp_path / "data", frames=2, width_px=64)
    write_variant(dataset, "best", lambda truth: lost_estimate(truth, HOSTILE))
    path = dataset.folder / "dataset.json"
    info = json.loads(path.read_text())
    info["case"] = HOSTILE
    path.write_text(json.dumps(info))
    api.score(dataset.folder)
    text = api.report(dataset.folder).read_text()
    assert text.count("<script") == text.count("</script>") == 3
    assert "taken'</script>" not in text
    told = explorer_of(text)
    assert told["pipelines"]["best"]["reasons"] == [HOSTILE] * 2
    assert told["title"].startswith(HOSTILE)


def test_safe_json_is_json_and_closes_nothing():
    told = {HOSTILE: [HOSTILE, 1.5, None]}
    text = safe_json(told)
    assert json.loads(text) == told
    assert not set("<>&\u2028") & set(text)
    with pytest.raises(ValueError, match="not JSON compliant"):
        safe_json(float("nan"))


def test_previews_keep_within_their_budget():
    """Noise is the worst that a JPEG may meet: it takes fewer pixels, never more bytes."""
    detector = Detector()
    noise = np.random.default_rng(5).uniform(0.0, 3000.0, (500, 500))
    for frames in (1, 50, 2000):
        shown = len(shown_places(frames))
        made = Previews(shown, detector).preview("image", noise)
        assert len(made) * shown <= max(LEAST_IN_ALL, MOST_IN_ALL)
    assert len(shown_places(5000)) == MOST_PREVIEWS
    assert shown_places(3) == {0, 1, 2}


def test_greys_can_be_undone():
    """The page's inverse, sinh, gives the signal back within half a level of the stretch."""
    detector = Detector()
    full = detector.saturation_dn - detector.bias_dn
    share = np.array([0.0, 1e-3, 0.02, 0.3, 1.0])
    levels = np.rint(255.0 * stretch(share * full, detector))
    softening = 0.005
    back = softening * np.sinh(levels / 255.0 * np.arcsinh(1.0 / softening))
    step = np.sqrt(back**2 + softening**2) * np.arcsinh(1.0 / softening) / 255.0
    assert (np.abs(back - share) <= 0.51 * step).all()


def test_a_glb_holds_the_triangles_given():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    data = glb_bytes([Surface("one", vertices, faces, (0.5, 0.5, 0.5))])
    magic, version, length, chunk = struct.unpack("<4sIII", data[:16])
    assert (magic, version, length) == (b"glTF", 2, len(data))
    tree = json.loads(data[20 : 20 + chunk])
    start = 20 + chunk + 8
    place = tree["bufferViews"][0]["byteLength"]
    corners = np.frombuffer(data[start : start + place], "<f4")
    assert np.array_equal(corners.reshape(-1, 3), vertices)
    indices = np.frombuffer(data[start + place : start + place + 24], "<u4")
    assert np.array_equal(indices.reshape(-1, 3), faces)
    with pytest.raises(ValueError, match="expected triangles"):
        glb_bytes([Surface("none", vertices, faces[:0], (0.5, 0.5, 0.5))])


@pytest.mark.parametrize("path", sorted(MESHES.glob("*.glb")), ids=lambda path: path.stem)
def test_meshes_are_small_and_of_our_targets(path):
    assert path.stem in TARGETS
    data = path.read_bytes()
    tree = json.loads(data[20 : 20 + struct.unpack("<I", data[12:16])[0]])
    faces = sum(each["count"] for each in tree["accessors"] if each["type"] == "SCALAR") / 3
    assert 0.2 * MOST_FACES < faces < 1.5 * MOST_FACES


def test_what_is_vendored_is_what_was_built():
    folder = HERE / "vendored"
    for line in (folder / "SHA256SUMS").read_text().splitlines():
        digest, name = line.split()
        assert hashlib.sha256((folder / name).read_bytes()).hexdigest() == digest, name
    text = (HERE / LIBRARIES[0]).read_text()
    for licence in ("LICENSE-three.txt", "LICENSE-uplot.txt"):
        assert (folder / licence).read_text().strip() in text
    assert not re.search(r"</script|<!--", text, re.IGNORECASE)
    assert set(re.findall(r"https?://[^\"'`\s)]+", text)) == {"http://www.w3.org/1999/xhtml"}
