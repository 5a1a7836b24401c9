"""The command line: exit codes, and the messages that a user meets, word for word.

The messages are kept in ``error_messages.json``; ``RVBENCH_UPDATE_SNAPSHOTS=1 pytest`` writes them
anew, for the difference to be read in review.
"""

import json
import re
import shutil
from dataclasses import fields
from pathlib import Path

import cv2
import pytest

from bench import cli, verbs
from bench.cli import main
from bench.interrupts import told as told_of
from models.lights.sun_names import SUN_NAMES
from tests.support.bad_input import (
    Spoil,
    change_json,
    compare_with_snapshot,
    cut,
    cut_last_line,
    lasting,
    make_8_bit,
    nothing,
    replace,
    scenario,
    shift_times,
    shrink,
)
from tests.support.synthetic_dataset import lost_estimate, write_variant

SNAPSHOTS = Path(__file__).with_name("error_messages.json")


@pytest.fixture
def folder(scored_dataset, tmp_path) -> Path:
    """Return a copy of the scored dataset that a test may spoil."""
    copy = tmp_path / "DIR"
    shutil.copytree(scored_dataset.folder, copy)
    return copy


def test_help_teaches_with_examples(capsys):
    for name in cli.VERBS:
        assert main([name, "--help"]) == 0
        told = capsys.readouterr().out
        assert told.startswith(f"usage: rvbench {name}")
        assert "(default: )" not in told
        assert f"rvbench {name} " in told.removeprefix("usage: ") or name in ("list", "doctor")
    assert main(["--help"]) == 0
    told = capsys.readouterr().out
    assert all(name in told for name in cli.VERBS)
    assert "Exit codes: 0 done, 1 worse than asked, 2 could not run" in told


def test_examples_of_the_help_can_be_typed():
    """Every example that a verb's help shows is parsed by that verb."""
    examples = [
        line.split()[1:]
        for verb in cli.VERBS.values()
        for line in (verb.__doc__ or "").splitlines()
        if line.strip().startswith("rvbench ")
    ]
    assert len(examples) >= 8
    for arguments in examples:
        assert isinstance(cli.parse(arguments), cli.VERBS[arguments[0]])


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        (["run", "maxar-demo", "--out", "o", "--son", "S2"], "--sun"),
        (["score", "DIR", "--fail-above", "1"], "--fail-above-mm"),
        (["estimate", "DIR", "--detecter", "d.toml"], "--detector"),
    ],
)
def test_a_mistyped_option_suggests_the_right_one(typed, meant, capsys):
    assert main(typed) == 2
    assert meant in capsys.readouterr().err


@pytest.mark.parametrize("typed", [[], ["rum"], ["run"], ["run", "x"], ["show", "DIR", "two"]])
def test_what_cannot_be_parsed_is_code_2(typed, capsys):
    assert main(typed) == 2
    assert capsys.readouterr().err


def test_options_reach_the_rendering():
    typed = (
        "run maxar-demo --out o --sun -1,0,0 --rate-hz 0.1 --span-s 20 40 --width 1024 --spp 16 "
        "--variant scalar --seeds 3 --store s --threads 2 "
        "--store-budget-gb 5 --keep-light some --keep-every 20"
    )
    verb = cli.parse(typed.split())
    assert verb.options() == {
        "sun": "-1,0,0", "rate_hz": 0.1, "start_s": 20.0, "end_s": 40.0, "width": 1024, "spp": 16,
        "variant": "scalar", "store": Path("s"), "threads": 2,
        "store_budget_gb": 5.0, "keep_light": "some", "keep_every": 20,
    }  # fmt: skip
    assert (verb.case, verb.out, verb.seeds) == ("maxar-demo", Path("o"), 3)


def test_score_report_show(folder, capsys):
    assert main(["score", str(folder)]) == 0
    told = capsys.readouterr().out
    assert "position error, median" in told
    assert f"score: {folder / 'score.json'}" in told.replace("\n", "")
    assert main(["report", str(folder)]) == 0
    assert "report.html" in capsys.readouterr().out
    out = folder / "frame.png"
    assert main(["show", str(folder), "1", "--variant", "paper", "--out", str(out)]) == 0
    assert cv2.imread(str(out)).shape[2] == 3
    assert main(["show", str(folder), "2"]) == 0
    assert (folder / "show" / "000002_best.png").is_file()


def test_a_picture_of_what_nobody_estimated_is_not_called_by_a_pipeline(folder, capsys):
    shutil.rmtree(folder / "estimates")
    assert main(["show", str(folder), "1"]) == 0
    assert [path.name for path in (folder / "show").iterdir()] == ["000001.png"]


def test_estimate_a_dataset_and_image_pairs(folder, tmp_path):
    shutil.rmtree(folder / "estimates")
    assert main(["estimate", str(folder)]) == 0
    assert (folder / "estimates" / "best.jsonl").is_file()
    pairs = f"--frames {folder / 'frames'} --camera {folder / 'camera.toml'}".split()
    detector = ["--detector", str(folder / "detector.toml"), "--rate-hz", "0.1"]
    assert main(["estimate", *pairs, *detector, "--out", str(tmp_path / "mine")]) == 0
    mine = (tmp_path / "mine" / "estimates" / "best.jsonl").read_bytes()
    assert mine == (folder / "estimates" / "best.jsonl").read_bytes()


def test_list(capsys):
    assert main(["list"]) == 0
    told = capsys.readouterr().out
    for name in ("maxar-demo", "maxar-approach", "chaser_fixed", "maxar1300", "S4"):
        assert name in told


@pytest.mark.parametrize("name", ["run", "render", "sweep", "dataset", "suite"])
def test_the_help_of_an_option_names_no_option_that_the_verb_lacks(name, capsys):
    assert main([name, "--help"]) == 0
    told = capsys.readouterr().out.partition(" options ")[2]
    own = {f"--{each.name.replace('_', '-')}" for each in fields(cli.VERBS[name])}
    assert set(re.findall(r"(?<!\w)--[a-z][a-z-]*", told)) <= own | {"--help", "--no-quick"}


@pytest.mark.parametrize("verb", ["run", "render"])
def test_help_tells_every_sun(verb, capsys):
    assert main([verb, "--help"]) == 0
    assert SUN_NAMES in " ".join(re.sub("[│]", " ", capsys.readouterr().out).split())


def test_worse_than_asked_is_code_1(folder, capsys):
    assert main(["score", str(folder), "--fail-above-mm", "5"]) == 0
    assert main(["score", str(folder), "--fail-above-mm", "0.0001"]) == 1
    assert "worse than asked: best has a 95th percentile of" in capsys.readouterr().out


def test_a_missed_frame_is_worse_than_any_limit(scored_dataset, folder, capsys):
    moved = type(scored_dataset)(**{**vars(scored_dataset), "folder": folder})
    write_variant(moved, "best", lost_estimate)
    assert main(["score", str(folder), "--fail-above-mm", "1000"]) == 1
    assert "no pose at all" in capsys.readouterr().out


def test_swapped_images_are_no_pose_with_a_reason(folder):
    for frame in range(4):
        first, second = (folder / "frames" / f"{frame:06d}_{band}.png" for band in (800, 850))
        spare = folder / "spare.png"
        first.rename(spare)
        second.rename(first)
        spare.rename(second)
    assert main(["estimate", str(folder)]) == 0
    assert main(["score", str(folder)]) == 0
    scored = json.loads((folder / "score.json").read_text())
    lost = scored["pipelines"]["best"]["core"]["lost"]
    assert lost["count"] == lost["missed"] == 4
    assert "the two images are swapped" in next(iter(lost["reasons"]))


def test_interrupted_says_what_is_kept(monkeypatch, capsys):
    def interrupt(_: object) -> int:
        raise KeyboardInterrupt

    for name, verb in {
        "list": verbs.List,
        "render": verbs.Render,
        "estimate": verbs.Estimate,
    }.items():
        monkeypatch.setattr(verb, "run", interrupt)
        assert main([name, *{"render": ["maxar-demo", "--out", "o"]}.get(name, [])]) == 130
        assert capsys.readouterr().err == f"{told_of(name)}\n"


def test_an_interrupt_within_another_error_is_one(monkeypatch, capsys):
    """As Dr.Jit's loops raise it."""

    def interrupt(_: object) -> int:
        try:
            raise KeyboardInterrupt
        except KeyboardInterrupt as error:
            raise RuntimeError("dr.while_loop(): encountered an exception") from error

    monkeypatch.setattr(verbs.List, "run", interrupt)
    assert main(["list"]) == 130
    told = capsys.readouterr().err
    assert told.startswith("rvbench: interrupted")
    assert "Traceback" not in told


def test_a_system_that_refuses_is_one_message(monkeypatch, capsys):
    """As when stdout leads to a full disk."""

    def refuse(_: object) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(verbs.List, "run", refuse)
    assert main(["list"]) == 2
    told = capsys.readouterr().err
    assert told.startswith("rvbench: expected the system to let us read and write, got: [Errno 28]")
    assert "Traceback" not in told


def test_a_fault_of_ours_is_code_2_with_a_traceback(monkeypatch, capsys):
    def stumble(_: object) -> int:
        raise ZeroDivisionError("a fault")

    monkeypatch.setattr(verbs.List, "run", stumble)
    assert main(["list"]) == 2
    told = capsys.readouterr().err
    assert "ZeroDivisionError: a fault" in told
    assert "this is a fault of rvbench itself" in told


MINE = "render DIR/my.toml --out OUT"
PAIRS = "estimate --frames DIR/frames --camera DIR/camera.toml"

BAD_INPUT: dict[str, tuple[Spoil, str]] = {
    "no such case": (nothing, "run maxar-dema --out OUT"),
    "no such scenario file": (nothing, "run absent.toml --out OUT"),
    "an unknown key": (scenario("[camera]\nwidht = 128"), MINE),
    "an unknown table": (scenario("[camra]\nwidth = 128"), MINE),
    "a unit in a number": (scenario('[motion]\nend_s = "2 min"'), MINE),
    "half a pixel": (scenario("[camera]\nwidth = 128.5"), MINE),
    "a list too short": (scenario("[prior]\nsigma_t_m = [1, 2]"), MINE),
    "a negative sigma": (scenario("[prior]\nsigma_euler_deg = [1, -1, 1]"), MINE),
    "a number for a table": (scenario("camera = 128"), MINE),
    "a Sun as a list": (scenario("[sun]\ndefault = [0, 0, 1]"), MINE),
    "two faults at once": (scenario("[render]\nsamples = 0\nmax_depth = 99"), MINE),
    "no name": (lambda d: (d / "my.toml").write_text(""), MINE),
    "no TOML": (scenario("[camera"), MINE),
    "a pair wider apart than pairs": (scenario("[motion]\npair_gap_ms = 300"), MINE),
    "no such target": (scenario('target = "maxar1400"'), MINE),
    "a target without markers": (scenario('target = "chaser"'), MINE),
    "the camera inside the target": (nothing, "run maxar-demo --span-s 460 480 --out OUT"),
    "a negative rate": (nothing, "run maxar-demo --rate-hz -1 --out OUT"),
    "a width of nothing": (nothing, "run maxar-demo --width 0 --out OUT"),
    "a span before the start": (nothing, "render maxar-demo --span-s -5 20 --out OUT"),
    "more threads than any machine": (nothing, "run maxar-demo --threads 100000 --out OUT"),
    "a target out of view": (
        nothing, "render maxar-approach --width 64 --spp 1 --span-s 600 601 --rate-hz 1 --out OUT"),
    "a gate of no number": (nothing, "score DIR --fail-above-mm nan"),
    "a gate that always passes": (nothing, "score DIR --fail-above-mm inf"),
    "a seed below zero": (nothing, "suite pesce2019 --seed -1 --out OUT"),
    "a suite of no runs": (nothing, "suite pesce2019 --runs 0 --out OUT"),
    "a deep scenario": (scenario("a = " + 5000 * "[" + 5000 * "]"), MINE),
    "a width as text": (scenario('[camera]\nwidth = "64"'), MINE),
    "a flag for a number": (scenario("[render]\nsamples = true"), MINE),
    "a motion of years": (scenario("[motion]\nend_s = 1e9"), MINE),
    "a deep camera": (
        lambda d: (d / "camera.toml").write_text("a = " + 5000 * "["), "estimate DIR"),
    "a camera of a long focus": (
        lambda d: replace(d / "camera.toml", "fx = ", "fx = 1e300 #"), "estimate DIR"),
    "no threads": (nothing, "run maxar-demo --threads 0 --out OUT"),
    "a Sun of two numbers": (nothing, "run maxar-demo --sun 0,1 --out OUT"),
    "too many seeds": (nothing, "run maxar-demo --seeds 1001 --out OUT"),
    "a file for a folder": (nothing, "run maxar-demo --out DIR/camera.toml"),
    "a folder of another scenario": (nothing, "run maxar-demo --sun S3 --out DIR"),
    "a Sun of zero length": (nothing, "run maxar-demo --sun 0,0,0 --out OUT"),
    "no such Sun": (nothing, "run maxar-demo --sun S9 --out OUT"),
    "a span that ends before it starts": (nothing, "render maxar-demo --span-s 9 3 --out OUT"),
    "no seeds": (nothing, "run maxar-demo --seeds 0 --out OUT"),
    "a sweep of no pose": (nothing, "sweep maxar-approach --out OUT"),
    "a sweep beyond the approach": (nothing, "sweep maxar-approach --range-m 9 --out OUT"),
    "a sweep in odd steps": (
        nothing, "sweep maxar-approach --range-m 2.5 --sun-step-deg 7 --out OUT"),
    "a sweep of no known Sun": (nothing, "sweep maxar-demo --time-s 250 --suns S1 S9 --out OUT"),
    "a sweep into a dataset": (nothing, "sweep maxar-demo --time-s 250 --suns S1 --out DIR"),
    "no dataset": (nothing, "estimate OUT"),
    "a dataset of another version": (
        lambda d: replace(d / "dataset.json", '"version": 2', '"version": 99'), "estimate DIR"),
    "a dataset of no known chain": (
        lambda d: change_json(d / "dataset.json", "chain", to="retroreflector_pair"),
        "estimate DIR"),
    "no frames.csv": (lambda d: (d / "frames.csv").unlink(), "estimate DIR"),
    "fewer frames than told": (lambda d: cut_last_line(d / "frames.csv"), "estimate DIR"),
    "fewer frames than told, scored": (lambda d: cut_last_line(d / "frames.csv"), "score DIR"),
    "fewer frames than told, reported": (lambda d: cut_last_line(d / "frames.csv"), "report DIR"),
    "no such pipeline": (nothing, "estimate DIR --pipelines bset"),
    "a pipeline of other streams": (nothing, "estimate DIR --pipelines uncooperative"),
    "no time for a frame": (nothing, "estimate DIR --time-limit-s 0"),
    "no time for a pair": (nothing, f"{PAIRS} --time-limit-s -1"),
    "no dataset.json": (lambda d: (d / "dataset.json").unlink(), "estimate DIR"),
    "a missing frame": (lambda d: (d / "frames/000001_800.png").unlink(), "estimate DIR"),
    "a truncated frame": (lambda d: cut(d / "frames/000001_850.png"), "estimate DIR"),
    "a frame of another size": (lambda d: [shrink(d / f"frames/000001_{band}.png")
                                           for band in (800, 850)], "estimate DIR"),
    "a frame of another size, scored": (
        lambda d: shrink(d / "frames/000002_850.png"), "score DIR"),
    "an 8-bit frame": (lambda d: make_8_bit(d / "frames/000001_850.png"), "estimate DIR"),
    "no frames at all": (
        lambda d: (d / "frames.csv").write_text("index,time_s,exposure_ms\n"), "estimate DIR"),
    "a camera of no width": (
        lambda d: replace(d / "camera.toml", "width = 512", "width = -512"), "estimate DIR"),
    "a detector without gain": (
        lambda d: replace(d / "detector.toml", "gain_e_dn = 26.0", "gain_e_dn = 0.0"),
        "estimate DIR"),
    "half a bit": (
        lambda d: replace(d / "detector.toml", "bits = 12", "bits = 12.5"), "estimate DIR"),
    "a broken camera": (
        lambda d: replace(d / "camera.toml", "fx = ", "focal = "), "estimate DIR"),
    "a broken prior": (
        lambda d: replace(d / "prior.toml", "euler_321_deg", "euler_deg"), "estimate DIR"),
    "neither dataset nor pairs": (nothing, "estimate"),
    "both dataset and pairs": (nothing, "estimate DIR --frames DIR/frames"),
    "options of pairs with a dataset": (nothing, "estimate DIR --camera DIR/camera.toml"),
    "pairs without a camera": (nothing, "estimate --frames DIR/frames"),
    "pairs without a prior": (
        lambda d: (d / "prior.toml").unlink(),
        "estimate --frames DIR/frames --camera DIR/camera.toml"),
    "pairs of no known target": (
        nothing, "estimate --frames DIR/frames --camera DIR/camera.toml --target maxar1400"),
    "no folder of pairs": (nothing, "estimate --frames absent --camera DIR/camera.toml"),
    "a dataset as pairs": (nothing, "estimate --frames DIR --camera DIR/camera.toml"),
    "one image of a pair": (lambda d: (d / "frames/000001_800.png").unlink(), PAIRS),
    "half an image of a pair": (lambda d: cut(d / "frames/000001_800.png"), PAIRS),
    "pairs of another size": (
        lambda d: replace(d / "camera.toml", "width = 512", "width = 256"), PAIRS),
    "pairs of another detector": (
        lambda d: [make_8_bit(path) for path in (d / "frames").glob("*.png")],
        f"{PAIRS} --detector DIR/detector.toml"),
    "pairs at no rate": (nothing, f"{PAIRS} --rate-hz 0"),
    "no estimates": (lambda d: shutil.rmtree(d / "estimates"), "score DIR"),
    "no truth": (lambda d: shutil.rmtree(d / "truth"), "score DIR"),
    "a broken estimate": (
        lambda d: (d / "estimates/best.jsonl").write_text('{"frame": 0}\n'), "score DIR"),
    "estimates of other times": (
        lambda d: shift_times(d / "estimates/best.jsonl"), "score DIR"),
    "an estimate missing": (
        lambda d: cut_last_line(d / "estimates/best.jsonl"), "score DIR"),
    "estimates of another version": (
        lambda d: replace(d / "estimates/best.jsonl", '"version": 2', '"version": 99'),
        "score DIR"),
    "other markers than the true ones": (
        lambda d: (d / "truth/markers.toml").write_text(
            re.sub(r"(?s)\[\[marker\]\].*?(?=\[\[marker\]\])", "",
                   (d / "markers.toml").read_text(), count=1)),
        "score DIR"),
    "a binary truth": (
        lambda d: (d / "truth/exposures.jsonl").write_bytes(b"\xff\xfe"), "score DIR"),
    "a deep truth": (
        lambda d: (d / "truth/exposures.jsonl").write_text(5000 * "[" + "\n"), "score DIR"),
    "a truth twice": (
        lambda d: (d / "truth/exposures.jsonl").write_text(
            2 * (d / "truth/exposures.jsonl").read_text()), "score DIR"),
    "a truth of NaN": (
        lambda d: replace(d / "truth/exposures.jsonl", '"time_s": 1', '"time_s": NaN, "t": 1'),
        "score DIR"),
    "a deep score": (lambda d: (d / "score.json").write_text(5000 * "["), "report DIR"),
    "half a truth": (lambda d: cut(d / "truth/exposures.jsonl"), "score DIR"),
    "a marker that is none": (
        lambda d: replace(d / "estimates/best.jsonl", '"marker": [0', '"marker": [99'),
        "score DIR"),
    "broken runtimes": (
        lambda d: (d / "estimates/best.runtime.csv").write_text("a\n1,2,3\n"), "score DIR"),
    "half a score": (lambda d: cut(d / "score.json"), "report DIR"),
    "a score without its NEES": (
        lambda d: change_json(d / "score.json", "pipelines", "best", "parts", "nees"),
        "report DIR"),
    "a score of version 1": (
        lambda d: change_json(d / "score.json", "version", to=1), "report DIR"),
    "a score of other estimates": (
        lambda d: cut_last_line(d / "estimates/best.jsonl"), "report DIR"),
    "a score without the latest estimates": (
        lambda d: shutil.copy(d / "estimates/best.jsonl", d / "estimates/mine.jsonl"),
        "report DIR"),
    "a score of other frames": (
        lambda d: [(d / "frames.csv").write_text("index,time_s,exposure_ms\n0,0,1\n"),
                   replace(d / "dataset.json", '"frames": 4', '"frames": 1')],
        "report DIR"),
    "no score": (lambda d: (d / "score.json").unlink(), "report DIR"),
    "no such frame": (nothing, "show DIR 77"),
    "no such variant": (nothing, "show DIR 0 --variant bset"),
    "another version shown": (
        lambda d: replace(d / "dataset.json", '"version": 2', '"version": 99'), "show DIR 0"),
    "a folder that cannot be written": (
        lambda d: [(d / "score.json").unlink(), (d / "score.json").mkdir()], "score DIR"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD_INPUT)
def test_bad_input_gets_one_clear_message(case, folder, tmp_path, capsys, monkeypatch):
    """One message, exit code 2, no traceback; the words are those on record."""
    spoil, command = BAD_INPUT[case]
    spoil(folder)
    monkeypatch.chdir(tmp_path)
    assert main(command.split()) == 2
    told = capsys.readouterr().err
    message = told[told.index("rvbench: ") :].strip()
    assert "Traceback" not in told
    assert "\n" not in message
    compare_with_snapshot(SNAPSHOTS, BAD_INPUT, case, lasting(message, tmp_path))


def test_a_name_in_brackets_is_printed_as_it_is(folder, capsys):
    name = "[bold red]x[/nosuch] $\\frac{$ :smile:"
    info = json.loads((folder / "dataset.json").read_text())
    (folder / "dataset.json").write_text(json.dumps(info | {"case": name}))
    assert main(["score", str(folder)]) == 0
    assert name in capsys.readouterr().out
    assert main(["report", str(folder)]) == 0
    assert main(["show", str(folder), "1"]) == 0


def test_a_marker_called_like_a_formula_is_drawn_by_its_name(folder):
    """An even number of dollars would be parsed as a formula, and this is none."""
    markers = (folder / "markers.toml").read_text()
    first = re.search(r'name = "([^"]*)"|names = \[\s*"([^"]*)"', markers)
    name = first.group(1) or first.group(2)
    (folder / "markers.toml").write_text(markers.replace(f'"{name}"', r"'$\frac{$'"))
    assert main(["score", str(folder)]) == 0
    assert main(["report", str(folder)]) == 0
    assert main(["show", str(folder), "1"]) == 0


def test_nothing_rendered_is_lost_when_estimating_fails(folder):
    cut(folder / "frames" / "000003_850.png")
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    assert main(["estimate", str(folder)]) == 2
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before
