"""Files that cannot be: each refused for little work, with one message, nothing written over."""

import json
import os
import shutil
import subprocess
import sys

import pytest

from bench.cli import main
from tests.support.foreign_files import ENDINGS, WRITERS
from tests.support.patience import HANGS_S
from tests.support.said_truth import said_truth
from tests.support.work_done import little_work

GIGABYTE = 1_000_000_000
HEAD = '{"format": "rvbench-estimates", "version": 2}\n'


def replaced(row: int, cell: int, text: str, sep: str = ","):
    """Return what puts another text into one cell of a file."""

    def spoil(lines: list[str]) -> list[str]:
        cells = lines[row].split(sep)
        cells[cell] = text
        return [*lines[:row], sep.join(cells), *lines[row + 1 :]]

    return spoil


def bop_rotation(text: str):
    return replaced(1, 4, text)


CASES = {
    ("bop", "a rotation of NaN"): (
        bop_rotation("nan 0 0 0 1 0 0 0 1"), "expected R as 9 numbers apart by spaces"),
    ("bop", "a mirror"): (
        bop_rotation("-1 0 0 0 1 0 0 0 1"), "determinant -1"),
    ("bop", "a rotation twice as large"): (
        bop_rotation("2 0 0 0 2 0 0 0 2"), "expected R as a rotation matrix"),
    ("bop", "eight numbers"): (
        bop_rotation("1 0 0 0 1 0 0 0"), "expected R as 9 numbers"),
    ("bop", "a place in NaN"): (replaced(2, 5, "0 0 nan"), "expected t as 3 numbers"),
    ("bop", "a place beyond the Moon"): (replaced(2, 5, "0 0 1e15"), "expected t as numbers"),
    ("bop", "an infinite score"): (replaced(1, 3, "inf"), "expected score to be a number"),
    ("bop", "a frame of another dataset"): (replaced(1, 1, "99"), "got 99; is it of another"),
    ("bop", "half a frame"): (replaced(1, 1, "0.5"), "expected im_id to be a whole number"),
    ("bop", "a frame twice"): (lambda rows: [*rows, rows[1]], "got frame 0 again, after 2"),
    ("bop", "a row cut short"): (
        lambda rows: [*rows[:-1], rows[-1][:40]], "expected 7 cells"),
    ("bop", "another header"): (
        lambda rows: ["scene_id,im_id", *rows[1:]], "expected BOP results"),
    ("bop", "no rows"): (lambda rows: rows[:1], "with a pose at least, got none"),
    ("speed", "a quaternion of NaN"): (replaced(0, 1, "NaN"), "expected q0 to be a number"),
    ("speed", "a quaternion of no length"): (
        lambda rows: ["img000000.jpg,0,0,0,0,0,0,30", *rows[1:]], "as a quaternion of length 1"),
    ("speed", "a way out of the folder"): (
        replaced(0, 0, "../../etc/img000000.jpg"), "as the plain name of an image, no folder"),
    ("speed", "a root"): (replaced(0, 0, "/img000000.jpg"), "as the plain name of an image"),
    ("speed", "an image that is not there"): (replaced(0, 0, "img000099.jpg"), "got 99"),
    ("speed", "a name of no image"): (
        replaced(0, 0, "earth.jpg"), "as the dataset names its images"),
    ("speed", "an image twice"): (lambda rows: [*rows, rows[0]], "got frame 0 again, after 1"),
    ("speed", "a cell too few"): (
        lambda rows: [rows[0], rows[1].rpartition(",")[0]], "expected 8 cells"),
    ("tum", "a place of infinity"): (replaced(1, 1, "inf", " "), "expected tx to be a number"),
    ("tum", "a time of no frame"): (
        replaced(1, 0, "17.0", " "), "expected the time of a frame as frames.csv has it"),
    ("tum", "a time twice"): (lambda rows: [*rows, rows[1]], "got frame 0 again"),
    ("tum", "a turn of no length"): (
        replaced(1, 7, "5e-2", " "), "as a quaternion of length 1"),
    ("tum", "seven numbers"): (
        lambda rows: [*rows[:2], rows[2].rpartition(" ")[0]], "expected 8 numbers"),
    ("rvbench", "NaN"): (
        lambda rows: [rows[0], rows[1].replace("0.", "NaN, 0.", 1), *rows[2:]],
        "expected finite numbers, got NaN"),
    ("rvbench", "a frame left out"): (
        lambda rows: [*rows[:2], *rows[3:]], "1 missing (first: 1)"),
    ("rvbench", "a frame twice"): (lambda rows: [*rows, rows[-1]], "got more"),
    ("rvbench", "frames in no order"): (
        lambda rows: [rows[0], rows[2], rows[1], *rows[3:]], "expected each frame once and in"),
    ("rvbench", "a deep nest"): (
        lambda rows: [rows[0], '{"frame": ' + "[" * 100_000, *rows[2:]], "nested more than 32"),
    ("rvbench", "a wide one"): (
        lambda rows: [rows[0], '{"frame": [' + "[]," * 300_000 + "[]]}", *rows[2:]],
        "expected the keys"),
    ("rvbench", "a number of very many digits"): (
        lambda rows: [rows[0], '{"frame": ' + "9" * 900_000 + "}", *rows[2:]],
        "a whole number of 900000 digits"),
}  # fmt: skip


@pytest.fixture(scope="module", autouse=True)
def started_up(tumble, tmp_path_factory):
    """Load all that a score loads."""
    path = WRITERS["bop"](tmp_path_factory.mktemp("first") / "first.csv", said_truth(tumble))
    assert main(["score", str(tumble.folder), "--estimates", str(path), "--vsd-px", "0"]) == 0


@pytest.mark.parametrize(("file_format", "what"), list(CASES), ids=map(" ".join, CASES))
def test_what_cannot_be_is_refused(tumble, tmp_path, capsys, file_format, what):
    spoil, message = CASES[file_format, what]
    path = tmp_path / f"mine.{ENDINGS[file_format]}"
    WRITERS[file_format](path, said_truth(tumble))
    path.write_text("\n".join(spoil(path.read_text().splitlines())) + "\n")
    with little_work():
        assert main(["score", str(tumble.folder), "--estimates", str(path)]) == 2
    told = capsys.readouterr()
    assert message in told.err
    assert told.err.count("\n") == 1
    assert told.err.startswith("rvbench: ")
    assert len(told.err) < 1000
    assert told.out == ""
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("begin", ["", HEAD, "scene_id,im_id,obj_id,score,R,t,time\n", "# tum\n"])
def test_a_line_of_a_gigabyte_is_not_read_whole(tumble, tmp_path, capsys, begin):
    """A sparse file, so that no disk fills; to its reader it is as long as any."""
    path = tmp_path / "mine.csv"
    path.write_text(begin)
    os.truncate(path, GIGABYTE)
    with little_work():
        assert main(["score", str(tumble.folder), "--estimates", str(path)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize("kind", ["a folder", "a pipe", "nothing", "an empty file", "noise"])
def test_what_is_no_file_of_estimates_is_refused(tumble, tmp_path, capsys, kind):
    path = tmp_path / "mine.csv"
    if kind == "a folder":
        path.mkdir()
    elif kind == "a pipe":
        os.mkfifo(path)
    elif kind != "nothing":
        path.write_bytes(b"" if kind == "an empty file" else os.urandom(4000))
    assert main(["score", str(tumble.folder), "--estimates", str(path)]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "expected" in told


@pytest.mark.parametrize("name", [".", "..", "/"])
def test_a_name_of_no_file_is_refused(tumble, name, capsys):
    assert main(["score", str(tumble.folder), "--estimates", name]) == 2
    assert "expected --estimates as a file" in capsys.readouterr().err


def test_another_tools_file_is_not_written_over(tumble, tmp_path, capsys):
    path = WRITERS["bop"](tmp_path / "mine.csv", said_truth(tumble))
    typed = ["score", str(tumble.folder), "--estimates", str(path), "--vsd-px", "0"]
    theirs = tmp_path / "mine.csv.score.json"
    theirs.write_text('{"accuracy": 1.0}')
    for out in ([], ["--out", str(theirs)], ["--out", str(path)]):
        assert main([*typed, *out]) == 2
        assert "found what rvbench did not make" in capsys.readouterr().err
    assert json.loads(theirs.read_text()) == {"accuracy": 1.0}
    theirs.unlink()
    assert main(typed) == 0
    assert main(typed) == 0  # ours is written anew


def test_a_dataset_is_only_read(tumble, tmp_path):
    folder = tmp_path / "data"
    shutil.copytree(tumble.folder, folder)
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    path = WRITERS["speed"](tmp_path / "mine.csv", said_truth(tumble))
    assert main(["score", str(folder), "--estimates", str(path), "--vsd-px", "32"]) == 0
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == before


def test_options_of_files_need_a_file(tumble, capsys):
    assert main(["score", str(tumble.folder), "--scene", "1"]) == 2
    assert "expected --scene only with --estimates FILE" in capsys.readouterr().err


def test_no_renderer_is_loaded(tumble, tmp_path):
    path = WRITERS["bop"](tmp_path / "mine.csv", said_truth(tumble))
    program = (
        "import sys; from bench.cli import main; code = main(sys.argv[1:]); "
        "sys.exit(code or any(name in sys.modules for name in ('mitsuba', 'drjit')))"
    )
    typed = ["score", str(tumble.folder), "--estimates", str(path), "--vsd-px", "32"]
    done = subprocess.run(
        [sys.executable, "-c", program, *typed], capture_output=True, text=True, check=False,
        timeout=HANGS_S,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
