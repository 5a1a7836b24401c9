"""A pipeline of another package stands beside ours, and whatever it does costs it one frame."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from bench import api
from bench.cli import main
from bench.estimating.runs import estimates_path
from models.dataset.estimates_file import read_estimates
from tests.support.synthetic_dataset import write_dataset
from tests.support.users_package import (
    HOUSE,
    TIME_LIMIT_S,
    environment,
    fresh_environment,
    install,
    lay_out,
    rvbench,
)

EXAMPLE = HOUSE / "bench" / "examples" / "blob_pipeline"
SHORT_PX = 128
# For a good frame of the pipelines below, microseconds of work, this is long on any machine; the
# frame that loops never ends, so that it is cut however long this is.
LIMIT_S = 20

HEAD = """
import os, signal, sys, time
from dataclasses import dataclass
import numpy as np
from models.estimate import Detections, Estimate, PoseEstimate
from models.frame import IMAGE_850
from models.pose import RigidTransform
from pipelines.pipeline import RegisteredPipeline

def pose(frame, **fields):
    where = RigidTransform(np.eye(3), np.array([0.0, 0.0, 3.0]))
    for name, value in fields.items():
        object.__setattr__(where, name, value)
    return Estimate(frame.index, frame.time_s, pose=PoseEstimate(where))

def detections(frame, count, marker):
    found = Detections(np.zeros((count, 2)), np.ones((count, 2)), (marker,) * count,
                       (False,) * count)
    return Estimate(frame.index, frame.time_s, pose=pose(frame).pose, detections=found)

class Mute(Exception):
    def __str__(self):
        raise RuntimeError("no words")

def raising(error):
    raise error

def covariance(frame, value):
    where = pose(frame).pose.cam_from_target
    return Estimate(frame.index, frame.time_s, pose=PoseEstimate(where, covariance=value))
"""

# What it does at a frame, and what is said of that frame.
MISDEEDS = {
    "raise": ("raising(KeyError('gain'))", "the pipeline raised KeyError: 'gain'"),
    "raise without words": ("raising(Mute())", "the pipeline raised Mute"),
    "recurse": ("(lambda f: f(f))(lambda f: f(f))", "the pipeline raised RecursionError"),
    "NaN": ("pose(frame, translation=np.full(3, np.nan))", "t_cam_from_target_m"),
    "no rotation": ("pose(frame, rotation=2.0 * np.eye(3))", "R_cam_from_target"),
    "mirror": ("pose(frame, rotation=np.diag([1.0, 1.0, -1.0]))", "R_cam_from_target"),
    "too few numbers": ("pose(frame, translation=np.zeros(2))", "t_cam_from_target_m"),
    "no covariance": ("covariance(frame, -np.eye(6))", "covariance_rad_m"),
    "covariance of text": ("covariance(frame, 'small')", "covariance_rad_m"),
    "nothing": ("None", "the pipeline said nothing"),
    "a function": ("lambda: 1", "said a function, which is no Estimate"),
    "sys.exit": ("sys.exit(3)", "the pipeline raised SystemExit: 3"),
    "an interrupt": ("raising(KeyboardInterrupt())", "the pipeline raised KeyboardInterrupt"),
    "os._exit": ("os._exit(3)", "process ended while it took a frame, with exit code 3"),
    "a crash": ("os.kill(os.getpid(), signal.SIGSEGV)", "while it took a frame, by SIGSEGV"),
    "another frame": ("Estimate(frame.index + 1, frame.time_s, reason='x')", "spoke of frame"),
    "another time": ("Estimate(frame.index, frame.time_s + 1.0, reason='x')", "spoke of frame"),
    "huge": ("detections(frame, 2_000_000, -1)", "at most 100000 detections"),
    "unknown marker": ("detections(frame, 4, 5000)", "named the marker 5000"),
    "asking": ("input()", "the pipeline raised EOFError"),
    "control characters": ("raising(ValueError('\\x1b[31m\\nred\\ud800'))", "[31m red"),
    "writing over the image": ("frame.image(IMAGE_850).image.fill(0) or None", "said nothing"),
    "endless": ("[None for _ in iter(int, 1)]", f"took longer than {LIMIT_S} s and was ended"),
}
PRINTING = "print('noise' * 100_000) or os.write(1, b'raw') and pose(frame)"
TAIL = """
class Badly:
    def __init__(self, onboard, variant):
        self.seen = 0

    def process(self, frame):
        deed = DEEDS.get(frame.index)
        return pose(frame) if deed is None else eval(deed, globals(), {"frame": frame})

PIPELINE = RegisteredPipeline("badly", Badly, streams=(IMAGE_850,))
"""
ENTRY = "[rvbench.pipelines]\n{name} = {module}:PIPELINE\n"


def badly_behaved(site: Path, deeds: dict[int, str]) -> Path:
    """Lay out a package whose pipeline does what it is told at some frames, and well elsewhere."""
    text = HEAD + f"DEEDS = {deeds!r}\n" + TAIL
    return lay_out(site, "badly_behaved", text, ENTRY.format(name="badly", module="badly_behaved"))


def said(folder: Path, label: str) -> dict:
    return {each.frame: each for each in read_estimates(estimates_path(folder, 0, label))}


@pytest.fixture(scope="module")
def beside_ours(tmp_path_factory):
    """Return the score and page of a dataset that the installed example has estimated with ours."""
    home = tmp_path_factory.mktemp("users")
    package = home / "package"
    shutil.copytree(EXAMPLE, package, ignore=shutil.ignore_patterns("build", "*.egg-info"))
    python = fresh_environment(home / "environment")
    install(python, package)
    dataset = write_dataset(home / "data", frames=3)
    outputs = [
        rvbench(verb, dataset.folder, python=python) for verb in ("estimate", "score", "report")
    ]
    assert [each.returncode for each in outputs] == [0, 0, 0], [each.stderr for each in outputs]
    return dataset.folder, outputs


@pytest.mark.slow
def test_a_users_pipeline_stands_beside_ours(beside_ours):
    folder, outputs = beside_ours
    score = json.loads((folder / "score.json").read_text())
    assert set(score["pipelines"]) == {"best", "paper", "blob"}
    assert "blob" in outputs[1].stdout
    page = (folder / "report.html").read_text()
    assert ">blob</th>" in page


@pytest.mark.slow
def test_the_example_is_right(beside_ours):
    """Centres of thresholded discs are good to a third of a pixel: 5 mm at 3 m, 512 px."""
    folder, _ = beside_ours
    core = json.loads((folder / "score.json").read_text())["pipelines"]["blob"]["core"]
    assert (core["frames"], core["estimated"], core["wrong"]["count"]) == (3, 3, 0)
    assert core["position_error_mm"]["p95"] < 5.0


@pytest.mark.slow
def test_what_it_never_tells_of_is_not_held_against_it(beside_ours):
    folder, _ = beside_ours
    parts = json.loads((folder / "score.json").read_text())["pipelines"]["blob"]["parts"]
    assert parts["detection"]["recall"] is None
    assert parts["nees"]["mean"] is None


def test_the_example_is_short():
    text = (EXAMPLE / "blob_pipeline.py").read_text()
    assert len(text.splitlines()) < 60


def test_each_misdeed_costs_one_frame_and_a_reason(tmp_path):
    """One deed a frame, and a good frame between each two."""
    deeds = {2 * place + 1: deed for place, (deed, _) in enumerate(MISDEEDS.values())}
    frames = 2 * len(MISDEEDS) + 1
    deeds[frames - 1] = PRINTING
    site = badly_behaved(tmp_path / "site", deeds)
    folder = write_dataset(tmp_path / "data", frames=frames, width_px=SHORT_PX).folder
    chosen = ("--pipelines", "badly", "--time-limit-s", LIMIT_S)
    done = rvbench("estimate", folder, *chosen, sites=(site,))
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"estimates: {estimates_path(folder, 0, 'badly')}\n"
    estimates = said(folder, "badly")
    assert sorted(estimates) == list(range(frames))
    for place, (name, (_, expected)) in enumerate(MISDEEDS.items()):
        lost = estimates[2 * place + 1]
        assert lost.pose is None, name
        assert expected in lost.reason, (name, lost.reason)
    first = next(iter(MISDEEDS.values()))[1]
    told = f"lost: pipeline badly failed at {len(MISDEEDS)} of {frames} frames; at frame 1: "
    lines = [line for line in done.stderr.splitlines() if line.startswith("lost: ")]
    assert [line.startswith(told) and first in line for line in lines] == [True]
    kept = [index for index in range(frames) if index % 2 == 0]
    assert [index for index in kept if estimates[index].pose is None] == []
    lost = api.score(folder)["pipelines"]["badly"]["core"]["lost"]
    assert lost["count"] == len(MISDEEDS)


def test_ours_see_the_frame_as_it_was_whatever_another_does_to_it(tmp_path, monkeypatch):
    site = badly_behaved(tmp_path / "site", {0: "frame.image(IMAGE_850).image.fill(0) or None"})
    alone, beside = (write_dataset(tmp_path / name, frames=1).folder for name in "ab")
    assert main(["estimate", str(alone)]) == 0
    monkeypatch.syspath_prepend(site)
    assert main(["estimate", str(beside)]) == 0
    for label in ("best", "paper"):
        ours = [estimates_path(folder, 0, label).read_bytes() for folder in (alone, beside)]
        assert ours[0] == ours[1]
    assert "badly" in {path.stem for path in (beside / "estimates").glob("*.jsonl")}


BROKEN = {
    "does not import": ("import missing_module_of_theirs", "ModuleNotFoundError"),
    "exits as it is imported": ("import sys; sys.exit('gone')", "SystemExit"),
    "dies as it is imported": ("import os; os._exit(7)", "exit code 7"),
    "is no pipeline": ("PIPELINE = 5", "PIPELINE to be a RegisteredPipeline"),
    "cannot be made": (
        HEAD + "PIPELINE = RegisteredPipeline('broken', lambda o, v: 1 / 0, (IMAGE_850,))",
        "ZeroDivisionError",
    ),
    "takes a label of ours": (
        HEAD
        + "PIPELINE = RegisteredPipeline('broken', None, (IMAGE_850,), label=lambda v: 'best')",
        "expected a label of its own, got best",
    ),
    "would write elsewhere": (
        HEAD
        + "PIPELINE = RegisteredPipeline('broken', None, (IMAGE_850,), label=lambda v: '../x')",
        "expected labels of letters",
    ),
    "needs what is not there": (
        HEAD + "PIPELINE = RegisteredPipeline('broken', None, ('lidar',))",
        "needs the streams lidar",
    ),
}


def name_of(kind: str) -> str:
    return "broken-" + kind.replace(" ", "-")


@pytest.fixture(scope="module")
def with_broken_ones(tmp_path_factory):
    """Return where all the broken packages lie, and a dataset that was estimated beside them."""
    home = tmp_path_factory.mktemp("broken")
    for kind, (text, _) in BROKEN.items():
        name = name_of(kind)
        module = name.replace("-", "_")
        entry = ENTRY.format(name=name, module=module)
        lay_out(home / "site", module, text.replace("'broken'", repr(name)), entry)
    folder = write_dataset(home / "data", frames=1, width_px=SHORT_PX).folder
    return home / "site", folder, rvbench("estimate", folder, sites=(home / "site",))


def test_broken_packages_are_left_out(with_broken_ones):
    _, folder, done = with_broken_ones
    assert done.returncode == 0, done.stderr
    assert {path.stem for path in (folder / "estimates").glob("*.jsonl")} == {"best", "paper"}
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("kind", BROKEN)
def test_a_broken_package_is_told_of(with_broken_ones, kind, capsys, monkeypatch):
    """Where nobody asked for it in a line of its own, where somebody did as the error."""
    site, folder, done = with_broken_ones
    why = BROKEN[kind][1]
    lines = [line for line in done.stderr.splitlines() if f"{name_of(kind)} " in line + " "
             or f"{name_of(kind)}:" in line]  # fmt: skip
    if kind == "needs what is not there":  # that one is for other datasets
        assert lines == []
    else:
        assert len(lines) == 1
        assert lines[0].startswith("left out: ")
        assert why in lines[0]
    monkeypatch.syspath_prepend(site)
    assert main(["estimate", str(folder), "--pipelines", name_of(kind)]) == 2
    told = capsys.readouterr()
    assert why in told.err
    assert (told.out, "Traceback" in told.err) == ("", False)


def test_who_asks_for_ours_runs_nobody_elses_code(tmp_path, monkeypatch):
    witness = tmp_path / "witness"
    text = f"open({str(witness)!r}, 'w').close()"
    site = lay_out(tmp_path / "site", "broken", text, ENTRY.format(name="broken", module="broken"))
    monkeypatch.syspath_prepend(site)
    folder = write_dataset(tmp_path / "data", frames=1, width_px=SHORT_PX).folder
    assert main(["estimate", str(folder), "--pipelines", "paper"]) == 0
    assert not witness.exists()
    assert main(["estimate", str(folder)]) == 0
    assert witness.exists()  # the witness, tested
    assert "broken" not in sys.modules  # and it is loaded elsewhere than here


WITNESS = """
def endless(path):
    with open(path + ".part", "w") as file:
        file.write(str(os.getpid()))
    os.replace(path + ".part", path)
    while True:
        pass
"""


@pytest.mark.parametrize(
    ("sign", "script"),
    [("SIGINT", False), ("SIGINT", True), ("SIGKILL", False)],
    ids=["SIGINT to python -m bench.cli", "SIGINT to rvbench", "SIGKILL"],
)
def test_no_process_outlives_the_command(tmp_path, sign, script):
    """The pipeline says which process it is, and loops; then the command is struck."""
    path = tmp_path / "process"
    text = HEAD + WITNESS + f"DEEDS = {{0: {f'endless({str(path)!r})'!r}}}\n" + TAIL
    entry = ENTRY.format(name="badly", module="badly_behaved")
    site = lay_out(tmp_path / "site", "badly_behaved", text, entry)
    folder = write_dataset(tmp_path / "data", frames=1, width_px=SHORT_PX).folder
    program = tmp_path / "rvbench"
    program.write_text(
        "import signal, sys\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # tests in the background
        "from bench.cli import main\n"
        "if __name__ == '__main__':\n    sys.exit(main())\n"
    )
    begin = (
        [str(program)]
        if script
        else ["-c", "import runpy, signal; signal.signal(signal.SIGINT, "
              "signal.default_int_handler); runpy.run_module('bench.cli', run_name='__main__', "
              "alter_sys=True)"]
    )  # fmt: skip
    command = subprocess.Popen(
        [sys.executable, *begin, "estimate", str(folder), "--pipelines", "badly",
         "--time-limit-s", str(TIME_LIMIT_S)],
        cwd=HOUSE, env=environment(site), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        start_new_session=True,
    )  # fmt: skip
    try:
        wait_until(lambda: path.exists() or command.poll() is not None)
        assert path.exists(), command.communicate()[1]
        pipeline = int(path.read_text())
        assert alive(pipeline)
        command.send_signal(getattr(signal, sign))
        _, errors = command.communicate(timeout=TIME_LIMIT_S)
    finally:
        command.kill()
        command.wait()
    if sign == "SIGINT":
        assert command.returncode == 130
        assert "interrupted" in errors
        assert not alive(pipeline)  # it was waited for
    wait_until(lambda: not alive(pipeline))


def alive(process: int) -> bool:
    """Tell whether a process runs; one that is dead and not yet buried does not."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state not in "ZX"


def wait_until(happened, limit_s: float = TIME_LIMIT_S) -> None:
    until = time.monotonic() + limit_s
    while not happened():
        assert time.monotonic() < until, "it never happened"
        time.sleep(0.02)


def test_alive_knows_the_living_and_the_dead():
    assert alive(os.getpid())
    done = subprocess.Popen([sys.executable, "-c", ""])
    wait_until(lambda: not alive(done.pid))
    assert done.wait() == 0
