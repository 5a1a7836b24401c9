"""Estimates from elsewhere, in four formats: truth is perfect, and a known error is that error."""

import json
import math

import numpy as np
import pytest

from bench import api
from bench.cli import main
from models.pose import RigidTransform
from tests.support.foreign_files import ENDINGS, WRITERS, write_bop, write_speed, write_tum
from tests.support.said_truth import said_truth

FORMATS = list(WRITERS)
A_DEGREE, A_CENTIMETRE = 1.0, 0.01
WITHIN_DEG, WITHIN_M = 1e-6, 1e-6
NOTHING_DEG, NOTHING_M = 1e-9, 1e-9  # seventeen digits, through a quaternion and back, at 30 m
NOTHING_PX = 1e-6


def off_by_a_degree(pose: RigidTransform) -> RigidTransform:
    return pose.perturbed(np.deg2rad([0.6, 0.0, 0.8]) * A_DEGREE, np.zeros(3))


def off_by_a_centimetre(pose: RigidTransform) -> RigidTransform:
    return pose.perturbed(np.zeros(3), np.array([0.0, 0.6, -0.8]) * A_CENTIMETRE)


def scored(dataset, file_format, tmp_path, said, **options):
    path = tmp_path / f"mine.{ENDINGS[file_format]}"
    WRITERS[file_format](path, said)
    out = tmp_path / "score.json"
    api.score_estimates(dataset.folder, path, out, **options)
    table = json.loads(out.read_text())
    return table["methods"]["mine"]


@pytest.mark.parametrize("file_format", FORMATS)
def test_truth_is_perfect_in_every_measure(tumble, tmp_path, file_format):
    own = scored(tumble, file_format, tmp_path, said_truth(tumble))
    assert own["format"] == file_format
    told = own["measures"]
    assert (told["frames"], told["estimated"], told["lost"], told["wrong"]) == (8, 8, {}, 0)
    assert own["core"]["position_error_mm"]["p95"] < 1e3 * NOTHING_M
    assert told["position_error_m"]["p95"] < NOTHING_M
    assert told["attitude_error_deg"]["p95"] < NOTHING_DEG
    assert told["speed"]["score"] < 1e-9
    assert told["speed"]["score_floored"] == 0.0
    for name in ("add_m", "add_s_m", "mssd_m"):
        assert told[name]["p95"] < NOTHING_M
    assert told["mspd_px"]["p95"] < NOTHING_PX
    assert told["vsd"] == [0.0] * 10
    assert told["bop"] == {"ar_vsd": 1.0, "ar_mssd": 1.0, "ar_mspd": 1.0, "ar": 1.0}
    assert {recall["share"] for recall in told["recall"]} == {1.0}


@pytest.mark.parametrize("file_format", FORMATS)
def test_a_degree_is_a_degree(tumble, tmp_path, file_format):
    said = said_truth(tumble, off_by_a_degree)
    own = scored(tumble, file_format, tmp_path, said, vsd_px=0)
    told = own["measures"]
    for row in own["per_frame"]:
        assert abs(row["attitude_deg"] - A_DEGREE) < WITHIN_DEG
        assert row["position_m"] < WITHIN_M
        assert abs(row["speed"] - math.radians(A_DEGREE)) < math.radians(WITHIN_DEG)
    shares = {recall["what"]: recall["share"] for recall in told["recall"]}
    assert shares["attitude within 0.5 deg"] == 0.0
    assert shares["attitude within 5 deg"] == 1.0
    # A turn by an angle moves a point at a distance r of its axis by 2 r sin(angle / 2).
    arc = 2.0 * math.sin(0.5 * math.radians(A_DEGREE))
    assert told["mssd_m"]["median"] <= 8.5 * arc  # XMM's farthest corner
    assert told["add_m"]["median"] < told["mssd_m"]["median"]


@pytest.mark.parametrize("file_format", FORMATS)
def test_a_centimetre_is_a_centimetre(tumble, tmp_path, file_format):
    said = said_truth(tumble, off_by_a_centimetre)
    own = scored(tumble, file_format, tmp_path, said, vsd_px=0)
    for row, truth in zip(own["per_frame"], tumble.truths, strict=True):
        range_m = float(np.linalg.norm(truth.cam_from_target.translation))
        assert row["attitude_deg"] < WITHIN_DEG
        for name in ("position_m", "add_m", "mssd_m"):  # every point is moved alike
            assert abs(row[name] - A_CENTIMETRE) < WITHIN_M
        assert row["add_s_m"] <= row["add_m"] + WITHIN_M
        assert abs(row["speed"] - A_CENTIMETRE / range_m) < WITHIN_M / range_m


def test_pairs_are_scored_too(pairs, tmp_path):
    own = scored(pairs, "bop", tmp_path, said_truth(pairs), vsd_px=64)
    assert own["measures"]["bop"]["ar"] == 1.0
    assert own["measures"]["vsd"] == [0.0] * 10
    assert own["core"]["runtime_ms"]["median"] == 250.0


@pytest.mark.parametrize("file_format", ["bop", "speed", "tum"])
def test_frames_left_out_are_lost_and_counted(tumble, tmp_path, file_format, capsys):
    path = tmp_path / f"mine.{ENDINGS[file_format]}"
    WRITERS[file_format](path, said_truth(tumble, without=(2, 5)))
    typed = ["score", str(tumble.folder), "--estimates", str(path), "--vsd-px", "0"]
    assert main(typed) == 0
    assert "2 of 8 frames have no row: lost" in capsys.readouterr().out
    own = json.loads((tmp_path / f"{path.name}.score.json").read_text())["methods"]["mine"]
    told = own["measures"]
    assert (own["missing"], told["frames"], told["estimated"]) == (2, 8, 6)
    assert sum(told["lost"].values()) == 2
    assert own["per_frame"][2]["reason"] == f"no row in {path.name}"
    # All others are perfect: a lost frame counts 1 + pi, and passes nothing.
    assert told["speed"]["score"] == pytest.approx(0.25 * (1.0 + math.pi), abs=1e-8)
    assert told["speed"]["score_estimated"] < 1e-9
    assert (told["bop"]["ar_mssd"], told["bop"]["ar_vsd"], told["bop"]["ar"]) == (0.75, None, None)
    assert {recall["share"] for recall in told["recall"]} == {0.75}


def test_the_best_scored_pose_of_an_image_is_taken(tumble, tmp_path):
    path = write_bop(tmp_path / "mine.csv", said_truth(tumble))
    worse = write_bop(tmp_path / "worse.csv", said_truth(tumble, off_by_a_degree))
    rows = worse.read_text().splitlines()[1:3]
    rows = [row.replace(",0.9,", ",0.8,") for row in rows]
    path.write_text(path.read_text() + "\n".join(rows) + "\n")
    _, table = api.score_estimates(tumble.folder, path, tmp_path / "out.json", vsd_px=0)
    own = table["methods"]["mine"]
    assert own["measures"]["attitude_error_deg"]["p95"] < NOTHING_DEG
    assert own["remarks"] == ["2 estimates of lower score than another of their image left out"]


def test_one_of_several_scenes_and_objects_is_chosen(tumble, tmp_path, capsys):
    path = write_bop(tmp_path / "mine.csv", said_truth(tumble), scene=4, target=7)
    other = write_bop(tmp_path / "other.csv", said_truth(tumble, off_by_a_degree), 5, 8)
    path.write_text(path.read_text() + other.read_text().partition("\n")[2])
    typed = ["score", str(tumble.folder), "--estimates", str(path), "--vsd-px", "0"]
    assert main(typed) == 2
    assert "choose one by --scene" in capsys.readouterr().err
    assert main([*typed, "--scene", "4"]) == 0
    told = json.loads((tmp_path / "mine.csv.score.json").read_text())["methods"]["mine"]["measures"]
    assert told["attitude_error_deg"]["p95"] < NOTHING_DEG
    assert main([*typed, "--scene", "6"]) == 2
    assert "expected a row of scene_id 6, got none" in capsys.readouterr().err


def test_names_of_images_are_those_of_the_dataset_or_of_speed(tumble, tmp_path):
    path = write_speed(tmp_path / "mine.csv", said_truth(tumble))
    text = path.read_text()
    for renamed in (
        text.replace("img", "").replace(".jpg", ".png"),
        text.replace(".jpg", ""),
        "filename,q0,q1,q2,q3,r0,r1,r2\n" + text,
    ):
        path.write_text(renamed)
        _, table = api.score_estimates(tumble.folder, path, tmp_path / "out.json", vsd_px=0)
        assert table["methods"]["mine"]["measures"]["estimated"] == 8


def test_a_trajectory_is_whose_it_is_said_to_be(tumble, tmp_path):
    path = write_tum(tmp_path / "mine.txt", said_truth(tumble), of="target")
    out = tmp_path / "out.json"
    right = api.score_estimates(
        tumble.folder, path, out, trajectory_of="target", vsd_px=0
    )[1]["methods"]["mine"]["measures"]  # fmt: skip
    assert right["position_error_m"]["p95"] < NOTHING_M
    wrong = api.score_estimates(tumble.folder, path, out, vsd_px=0)[1]["methods"]["mine"]
    assert wrong["measures"]["position_error_m"]["median"] > 1.0


def test_a_gate_is_held_against_a_file(tumble, tmp_path):
    path = write_tum(tmp_path / "mine.txt", said_truth(tumble, off_by_a_centimetre))
    typed = ["score", str(tumble.folder), "--estimates", str(path), "--vsd-px", "0"]
    assert main([*typed, "--fail-above-mm", "11"]) == 0
    assert main([*typed, "--fail-above-mm", "9"]) == 1
