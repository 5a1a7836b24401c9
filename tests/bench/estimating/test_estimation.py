"""The pipelines run on a dataset, and on more runs of it, and no run is done twice."""

import dataclasses
import shutil
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

import renders.batches.render_case
import renders.batches.replay
from bench import api
from bench.cli import main
from bench.estimating.contenders import Contender
from bench.estimating.repeated_runs import repeat_runs, runs_left
from bench.estimating.runs import (
    estimates_path,
    found_runs,
    read_run,
    read_stamp,
    run_folder,
    runtimes_path,
    stamp_path,
)
from models.dataset.dataset import open_dataset
from models.dataset.estimates_file import read_estimates, read_runtimes
from models.errors import DatasetError
from models.frame import IMAGE_850
from tests.support.own_meshes import textured_glb
from tests.support.synthetic_dataset import write_dataset

A_MILLIMETRE = 1.0
VARIANTS = ("paper", "best")
CLOCKS_S = {2: 0.0047}


def test_every_frame_of_every_variant_is_estimated(scored_dataset):
    frames = [entry.index for entry in scored_dataset.entries]
    for variant in VARIANTS:
        said = read_estimates(estimates_path(scored_dataset.folder, 0, variant))
        assert [estimate.frame for estimate in said] == frames
        spent = read_runtimes(runtimes_path(scored_dataset.folder, 0, variant))
        assert sorted(spent) == frames
        assert min(spent.values()) > 0.0


def test_poses_are_right(scored_dataset):
    """Discs of 2 to 3 px radius at 3 m: the bound is about 0.2 mm, a millimetre five of it."""
    score = api.score(scored_dataset.folder)["pipelines"]["best"]
    core, detection = score["core"], score["parts"]["detection"]
    assert core["estimated"] == 4
    assert max(score["parts"]["axes"]["run_0"]["position_rms_mm"]) < A_MILLIMETRE
    assert core["wrong"]["count"] == 0
    assert detection["mismatches"] == 0
    assert detection["recall"] == 1.0


@pytest.fixture
def replayed(tmp_path, monkeypatch):
    """Stand in for the radiance store: the dataset's own images, with a little noise of the run."""
    dataset = write_dataset(tmp_path / "data", frames=2)
    exposed = []

    def exposed_frames(folder, run):
        exposed.append(run)
        rng = np.random.default_rng(run)
        opened = open_dataset(folder)

        def noisy(frame):
            reading = frame.image(IMAGE_850)
            noise = rng.normal(0.0, 2.0, reading.image.shape)
            image = np.clip(reading.image + noise, 0, 4095).astype(np.uint16)
            seen = {**frame.readings, IMAGE_850: dataclasses.replace(reading, image=image)}
            return dataclasses.replace(frame, readings=seen)

        told = opened.onboard
        prior = told.prior.cam_from_target.perturbed(np.zeros(3), [1e-3 * run, 0.0, 0.0])
        drawn = dataclasses.replace(
            told, prior=dataclasses.replace(told.prior, cam_from_target=prior)
        )
        late_s = CLOCKS_S.get(run, 0.0)  # its clock's error against run 0's
        frames = (
            dataclasses.replace(frame, time_s=frame.time_s + late_s) for frame in opened.frames()
        )
        return drawn, (noisy(frame) for frame in frames)

    monkeypatch.setattr(renders.batches.replay, "exposed_frames", exposed_frames)
    api.estimate(dataset.folder)
    return dataset, exposed


def test_runs_are_done_once(replayed):
    dataset, exposed = replayed
    assert repeat_runs(dataset.folder, 3) == [1, 2]
    assert exposed == [1, 2]
    assert repeat_runs(dataset.folder, 3) == []
    assert repeat_runs(dataset.folder, 4) == [3]
    assert exposed == [1, 2, 3]
    assert found_runs(dataset.folder, "best") == [0, 1, 2, 3]
    own = run_folder(dataset.folder, 1)
    assert (own / "prior.toml").is_file()
    assert not (own / "camera.toml").exists()  # the dataset's own
    drawn = open_dataset(dataset.folder).onboard_in(own).prior.cam_from_target
    first = dataset.onboard.prior.cam_from_target
    assert drawn.translation - first.translation == pytest.approx([1e-3, 0.0, 0.0], abs=1e-12)
    score = api.score(dataset.folder)
    assert score["runs"] == 4
    best = score["pipelines"]["best"]
    assert (best["core"]["pooled"]["runs"], best["core"]["pooled"]["frames"]) == (4, 8)
    assert best["parts"]["centroids"]["pooled"]["temporal_std"] is not None


def test_a_run_has_the_times_of_its_own_clock(replayed):
    """A clock that is told wrong is so run by run: the estimates carry its times."""
    repeat_runs(replayed[0].folder, 3)
    dataset = open_dataset(replayed[0].folder)
    first_s = dataset.entries[0].time_s
    runs = [read_run(dataset, number, "best") for number in range(3)]
    said_s = [run.estimates[dataset.entries[0].index].time_s for run in runs]
    assert said_s == pytest.approx([first_s, first_s, first_s + CLOCKS_S[2]], abs=1e-12)
    assert not (run_folder(dataset.folder, 1) / "times.csv").exists()
    path = run_folder(dataset.folder, 2) / "times.csv"
    path.write_text(path.read_text().replace("frame,", "image,"))
    with pytest.raises(DatasetError, match=r"times.csv:1: expected the columns frame, time_s"):
        read_run(dataset, 2, "best")
    path.unlink()
    with pytest.raises(DatasetError, match=r"as frames.csv has it, got one at .* delete"):
        read_run(dataset, 2, "best")


def test_a_broken_run_is_done_again(replayed):
    dataset, exposed = replayed
    repeat_runs(dataset.folder, 2)
    path = estimates_path(dataset.folder, 1, "paper")
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    assert runs_left(dataset.folder, 2) == [1]
    assert repeat_runs(dataset.folder, 2) == [1]
    assert path.read_bytes() == whole
    assert exposed == [1, 1]


def test_a_run_is_done_again_with_other_settings(replayed, monkeypatch):
    """The stamp says with which settings, whose pipelines' each: other settings, another run."""
    dataset, exposed = replayed
    repeat_runs(dataset.folder, 2)
    stamp = read_stamp(dataset.folder, 1)
    assert set(stamp) == {"dataset", "settings_best", "settings_paper"}
    assert stamp["settings_best"] != stamp["settings_paper"]
    assert runs_left(dataset.folder, 2) == []
    monkeypatch.setattr(Contender, "settings", property(lambda own: f"{own.label}, but other"))
    assert runs_left(dataset.folder, 2) == [1]
    assert repeat_runs(dataset.folder, 2) == [1]
    assert exposed == [1, 1]
    assert read_stamp(dataset.folder, 1)["settings_best"] != stamp["settings_best"]


@pytest.mark.parametrize("stamp", ["", "{", "[]", '{"dataset": "another"}'])
def test_a_run_whose_stamp_is_no_stamp_is_done_again(replayed, stamp):
    dataset, _ = replayed
    repeat_runs(dataset.folder, 2)
    stamp_path(dataset.folder, 1).write_text(stamp)
    assert runs_left(dataset.folder, 3) == [1, 2]


def test_a_folder_without_a_dataset_has_all_runs_left(tmp_path):
    assert runs_left(tmp_path / "none", 3) == [1, 2]
    assert runs_left(tmp_path / "none", 1) == []


def test_a_run_of_other_frames_is_done_again_and_never_scored(replayed):
    dataset, _ = replayed
    repeat_runs(dataset.folder, 2)
    info = dataset.folder / "dataset.json"
    info.write_text(info.read_text().replace('"S2"', '"S4"'))
    assert runs_left(dataset.folder, 2) == [1]
    with pytest.raises(DatasetError, match="expected estimates of this dataset, got another's"):
        api.score(dataset.folder)
    repeat_runs(dataset.folder, 2)
    assert api.score(dataset.folder)["runs"] == 2


def test_one_run_repeats_nothing(replayed):
    dataset, exposed = replayed
    assert repeat_runs(dataset.folder, 1) == []
    assert exposed == []


def test_estimating_again_gives_the_same_bytes(scored_dataset, tmp_path):
    copy = tmp_path / "copy"
    shutil.copytree(scored_dataset.folder, copy)
    shutil.rmtree(copy / "estimates")
    api.estimate(copy)
    for variant in VARIANTS:
        first = estimates_path(scored_dataset.folder, 0, variant).read_bytes()
        assert estimates_path(copy, 0, variant).read_bytes() == first


def test_the_whole_job_in_one_call(replayed, tmp_path, monkeypatch):
    """``api.run`` asks for the rendering as it was asked, then does the rest; nothing is drawn."""
    dataset, exposed = replayed
    asked = []

    def render_case(request, check):
        asked.append(request)
        shutil.copytree(dataset.folder, request.out, ignore=shutil.ignore_patterns("estimates"))

    monkeypatch.setattr(renders.batches.render_case, "render_case", render_case)
    # Synthetic frames have no light in a store, hence none to hold.
    monkeypatch.setattr(renders.batches.replay, "light_held", lambda folder: nullcontext())
    out = tmp_path / "out"
    score = api.run("maxar-demo", out, seeds=2, sun="S4", width=512, threads=1)
    assert [(r.case, r.out, r.sun, r.width, r.threads, r.seeds) for r in asked] == [
        ("maxar-demo", out, "S4", 512, 1, 2)
    ]
    assert exposed == [1]
    assert score["runs"] == 2
    assert (out / "score.json").is_file()
    assert (out / "report.html").is_file()


def test_frames_that_nobody_estimates_are_refused_before_they_are_rendered(
    tmp_path, capsys, monkeypatch
):
    """A target of one's own at poses of a table: ours need an orbit, or markers in image pairs."""
    monkeypatch.chdir(tmp_path)
    Path("craft.toml").write_text(
        f'name = "craft"\nmesh = "{textured_glb(tmp_path / "craft.glb").name}"\n'
    )
    frame = "cam_from_target"
    head = [f"t_{frame}_{axis}_m" for axis in "xyz"] + [f"q_{frame}_{axis}" for axis in "wxyz"]
    Path("poses.csv").write_text(f"time_s,{','.join(head)}\n0,0,0,9,1,0,0,0\n1,0,0,8,1,0,0,0\n")
    Path("mine.toml").write_text(
        'name = "mine"\ntarget = "craft.toml"\n'
        "[camera]\nwidth = 64\nheight = 64\nfov_deg = 40.0\n"
        '[motion]\nfile = "poses.csv"\n[sun]\ndefault = "0,0,-1"\n'
        '[exposure]\nmode = "fixed"\nexposure_ms = 1.0\n'
    )
    assert main(["run", "mine.toml", "--out", "out"]) == 2
    said = capsys.readouterr().err
    for told in ("uncooperative lacks chaser_orbit", "[tumble]", "Nothing was rendered"):
        assert told in said
    assert not Path("out").exists()


def test_estimates_of_a_pipeline_that_did_not_run_now_are_told_of(tmp_path, capsys):
    """As of an installed one whose import broke since: its file is there, and would be scored."""
    folder = write_dataset(tmp_path / "data", frames=1, width_px=32).folder
    api.estimate(folder)
    assert "not of this run" not in capsys.readouterr().err
    older = estimates_path(folder, 0, "theirs")
    shutil.copyfile(estimates_path(folder, 0, "best"), older)
    api.estimate(folder)
    told = [line for line in capsys.readouterr().err.splitlines() if "not of this run" in line]
    assert len(told) == 1
    assert str(older) in told[0]
    assert "no pipeline theirs ran now" in told[0]
