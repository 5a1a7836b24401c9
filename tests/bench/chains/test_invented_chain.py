"""A fourth chain, of a kind that the house has none of, goes all the way: one file, one line."""

import json
import re
import shutil

import cv2
import numpy as np
import pytest

from bench import api
from bench.chains import catalogue
from bench.cli import main
from bench.estimating.runs import estimates_path
from models.dataset.dataset import open_dataset
from models.dataset.estimates_file import read_estimates
from models.errors import DatasetError
from pipelines import registry
from tests.support import invented_chain
from tests.support.invented_chain import CHAIN, PLACE, STATE, true_place, write_beacon

HALF_A_PIXEL_M = 0.09  # of a 48 px wide camera of 40 deg, at 8 m: the spot is found better


@pytest.fixture(autouse=True)
def known(monkeypatch):
    """Register the chain, and forget it afterwards."""
    monkeypatch.setattr(catalogue, "_REGISTERED", {})
    monkeypatch.setattr(registry, "_REGISTERED", {})
    catalogue.register(CHAIN)


@pytest.fixture(scope="module")
def estimated(tmp_path_factory):
    """Return a dataset with a camera and one without, estimated once; tests take copies."""
    home = tmp_path_factory.mktemp("beacon")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(catalogue, "_REGISTERED", {})
        patch.setattr(registry, "_REGISTERED", {})
        catalogue.register(CHAIN)
        api.estimate(write_beacon(home / "seen", silent=(3,)))
        api.estimate(write_beacon(home / "blind", seen=False))
    return home


@pytest.fixture
def seen(estimated, tmp_path):
    return shutil.copytree(estimated / "seen", tmp_path / "seen")


@pytest.fixture
def blind(estimated, tmp_path):
    return shutil.copytree(estimated / "blind", tmp_path / "blind")


def test_its_pipelines_find_the_beacon(seen):
    spoken = {path.stem for path in (seen / "estimates").glob("*.jsonl")}
    assert spoken == {"beacon-seen", "beacon-ahead"}
    said = read_estimates(estimates_path(seen, 0, "beacon-seen"))
    for each in said:
        if each.frame == 3:
            assert (each.reason, bool(each)) == ("no range since the last frame", False)
        else:
            error = each.states[STATE].values[PLACE] - true_place(each.frame)
            assert np.abs(error).max() < HALF_A_PIXEL_M


def test_its_score_has_the_core_and_its_own_part(seen):
    pipelines = api.score(seen)["pipelines"]
    core = pipelines["beacon-seen"]["core"]
    assert (core["frames"], core["estimated"], core["lost"]["frames"]) == (5, 4, [3])
    assert core["position_error_mm"]["p95"] < 1e3 * HALF_A_PIXEL_M
    assert core["attitude_error_deg"] == {"median": None, "p95": None, "rms": None}
    assert pipelines["beacon-seen"]["parts"]["sideways"]["rms_m"] < HALF_A_PIXEL_M
    assert len(pipelines["beacon-seen"]["parts"]["sideways"]["by_axis_m"]) == 3
    places = [row["place_m"] for row in pipelines["beacon-seen"]["per_frame"]]
    assert [place is None for place in places] == [False] * 3 + [True, False]
    # The one that looks straight ahead is off by how far aside the beacon is: 0.63 m at most.
    ahead = pipelines["beacon-ahead"]["parts"]["sideways"]
    aside = [np.hypot(*true_place(index)[:2]) for index in (0, 1, 2, 4)]
    assert ahead["rms_m"] == pytest.approx(float(np.sqrt(np.mean(np.square(aside)))), rel=1e-6)
    assert pipelines["beacon-ahead"]["core"]["wrong"]["frames"] == [0, 4]


def test_its_report_has_its_section_and_its_pictures(seen):
    api.score(seen)
    page = api.report(seen).read_text()
    assert "<h2>Sideways of the beacon</h2>" in page
    assert page.count("<img ") == 6  # the first frame large, and five small
    assert "The spot as it was seen." in page
    assert "stretch" not in page.lower()
    assert "paper variant" not in page
    assert "48 × 32 px" in page
    assert "8.26 m" not in page  # its truth tells no pose, so that no range is in the titles


def test_its_picture_is_shown(seen):
    api.score(seen)
    out = api.show(seen, 2, seen / "two.png")
    assert cv2.imread(str(out)).shape[:2] == (320, 480)


def test_the_command_line_does_all_of_it(seen, capsys):
    for verb in (["estimate"], ["score"], ["report"], ["show", "0"]):
        assert main([verb[0], str(seen), *verb[1:]]) == 0, capsys.readouterr().err
    out = capsys.readouterr().out
    assert "beacon-seen" in out
    assert (seen / "show" / "000000_beacon-ahead.png").is_file()  # the first that has spoken


def test_without_any_camera_or_image_it_goes_all_the_way(blind, capsys):
    pipelines = api.score(blind)["pipelines"]
    assert list(pipelines) == ["beacon-ahead"]
    assert pipelines["beacon-ahead"]["core"]["estimated"] == 5
    page = api.report(blind).read_text()
    assert "<h2>Sideways of the beacon</h2>" in page
    assert not re.search("<img |focal length", page)
    assert "beacon at [0.0, 0.0, " in page
    assert main(["show", str(blind), "0"]) == 2
    error = capsys.readouterr().err
    assert "expected a frame that the chain beacon_place has a picture of" in error
    assert "Traceback" not in error


def test_what_is_on_board_comes_back(seen, blind):
    assert open_dataset(seen).onboard.tables == invented_chain.FINDER
    assert open_dataset(seen).onboard.detector is None
    assert open_dataset(blind).onboard.camera is None


def test_no_number_is_none_in_the_score(blind):
    (blind / "ranges.csv").write_text("index,time_s,range_m\n")
    api.estimate(blind)
    part = api.score(blind)["pipelines"]["beacon-ahead"]["parts"]["sideways"]
    assert part == {"rms_m": None, "by_axis_m": [None] * 3}
    assert json.loads((blind / "score.json").read_text())
    api.report(blind)


def test_without_truth_it_is_estimated_and_shown_but_not_scored(seen):
    api.score(seen)
    shutil.rmtree(seen / "truth")
    api.show(seen, 1, seen / "one.png")
    with pytest.raises(DatasetError, match=r"truth/beacon\.csv"):
        api.score(seen)


def test_methods_without_poses_are_not_compared_by_poses(seen, tmp_path):
    with pytest.raises(DatasetError, match="a truth that tells the target's pose in every frame"):
        api.compare([seen], out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_ours_are_not_asked_for_a_pipeline_that_its_streams_do_not_suit(seen, capsys):
    assert main(["estimate", str(seen), "--pipelines", "chaser_fixed"]) == 2
    assert "which needs the streams image_800, image_850" in capsys.readouterr().err


def test_a_chain_that_nobody_registered_is_asked_for(seen, monkeypatch, capsys):
    monkeypatch.setattr(catalogue, "_REGISTERED", {})
    assert main(["estimate", str(seen)]) == 2
    error = capsys.readouterr().err
    assert "got 'beacon_place'" in error
    assert "install the package that brings it" in error


def test_a_chain_or_pipeline_cannot_take_a_name_of_ours():
    from dataclasses import replace

    with pytest.raises(DatasetError, match="which is ours"):
        catalogue.register(replace(CHAIN, name="tumble_images"))
    with pytest.raises(Exception, match="one of ours"):
        catalogue.register(replace(CHAIN, brought={"chaser_fixed": "a:B"}))


def test_an_on_board_file_of_nobodys_is_refused(seen):
    info = seen / "dataset.json"
    info.write_text(info.read_text().replace("range_finder.toml", "range_finder.bin"))
    with pytest.raises(DatasetError, match=r"ending in \.toml, got 'range_finder.bin'"):
        api.estimate(seen)
