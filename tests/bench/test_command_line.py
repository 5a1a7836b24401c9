"""The command line as a shell meets it: pipes, versions, completion, slips of the finger."""

import os
import re
import shutil
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest

from bench.cli import main
from tests.support.patience import HANGS_S

HOUSE = Path(__file__).resolve().parents[2]
RVBENCH = [sys.executable, "-m", "bench"]


def shell(command: str, **options) -> subprocess.CompletedProcess[str]:
    """Run a command of bash in the clone, ``rvbench`` being ``python -m bench``."""
    program = f'rvbench() {{ {" ".join(RVBENCH)} "$@"; }}\n{command}'
    return subprocess.run(
        ["bash", "-c", program],
        cwd=HOUSE,
        capture_output=True,
        text=True,
        timeout=HANGS_S,
        check=False,
        **options,
    )


@pytest.mark.parametrize("reader", ["head -1", "true"])
@pytest.mark.parametrize("command", ["rvbench list", "rvbench run --help", "rvbench --version"])
def test_who_reads_no_more_is_no_failure(command, reader):
    """Exit code 141 as of any program that a closed pipe ends; or 0, if all was taken in time.

    Never 1, which means worse than asked.
    """
    done = shell(f"{command} | {reader}; echo code ${{PIPESTATUS[0]}}")
    code = re.search(r"code (\d+)", done.stdout)
    assert code is not None
    assert code[1] in ("141", "0")
    assert done.stderr == ""


def test_a_reader_that_left_before_the_first_word_is_code_141():
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w") as closed:
        done = subprocess.run(
            [*RVBENCH, "list"],
            cwd=HOUSE,
            stdout=closed,
            stderr=subprocess.PIPE,
            text=True,
            timeout=HANGS_S,
            check=False,
        )
    assert (done.returncode, done.stderr) == (141, "")


def test_a_closed_stdout_is_no_fault_of_ours():
    done = shell("rvbench --version >&-")
    assert (done.returncode, done.stderr) == (0, "")


def test_versions(capsys):
    assert main(["--version"]) == 0
    told = capsys.readouterr().out
    for name in ("rvbench", "mitsuba"):
        assert version(name) in told
    assert sys.version.split()[0] in told


@pytest.mark.parametrize(
    ("typed", "meant"), [("rnu", "run"), ("rendr", "render"), ("lsit", "list"), ("swep", "sweep")]
)
def test_a_mistyped_verb_suggests_the_right_one(typed, meant, capsys):
    assert main([typed, "maxar-demo"]) == 2
    told = capsys.readouterr().err
    assert told.startswith("rvbench: expected one of run, render, ")
    assert told.endswith(f"got '{typed}'; perhaps you meant {meant}\n")


def test_a_word_like_no_verb_suggests_none(capsys):
    assert main(["quux"]) == 2
    assert capsys.readouterr().err.endswith("got 'quux'\n")


@pytest.mark.skipif(shutil.which("bash") is None, reason="completes in bash")
@pytest.mark.parametrize(
    ("line", "offered"),
    [("rvbench re", {"render", "report"}), ("rvbench render maxar-demo --ra", {"--rate-hz"})],
)
def test_the_tab_key_completes(line, offered, tmp_path, capsys):
    """The script that the help tells of is made and run by bash itself."""
    assert main(["--tyro-print-completion", "bash"]) == 0
    script = tmp_path / "completion"
    script.write_text(capsys.readouterr().out)
    words = line.split()
    asked = " ".join(f"'{word}'" for word in words)
    done = shell(
        f"source {script}; COMP_WORDS=({asked}); COMP_CWORD={len(words) - 1}; "
        "$(complete -p rvbench | sed 's/.*-F \\([^ ]*\\).*/\\1/') rvbench; "
        'printf "%s\\n" "${COMPREPLY[@]}"'
    )
    assert {word.strip() for word in done.stdout.split()} >= offered
    assert "rvbench --tyro-print-completion bash" in shell("rvbench --help").stdout


def test_without_a_terminal_there_are_lines_and_no_bars(scored_dataset, tmp_path):
    folder = tmp_path / "data"
    shutil.copytree(scored_dataset.folder, folder)
    done = shell(f"rvbench estimate {folder}")
    assert done.returncode == 0, done.stderr
    lines = [line for line in done.stderr.splitlines() if line]
    assert re.fullmatch(r"estimate: 1 of 4; left: .*", lines[0])
    assert lines[-1] == "estimate: 4 of 4; left: none"
    assert len(lines) == 4


@pytest.mark.parametrize("typed", [["show", "a\x1b[2J", "0"], ["list", "--x=\x07"], ["a\x01b"]])
def test_control_characters_are_refused_and_not_said_again(typed, capsys):
    assert main(typed) == 2
    told = capsys.readouterr().err
    assert told.startswith("rvbench: expected arguments without control characters, got '")
    assert told.strip().isprintable()


def test_a_folder_whose_name_is_no_text_is_told_of(scored_dataset, tmp_path):
    """As a file of an old disk is named: the bytes of Latin-1."""
    folder = shutil.copytree(
        scored_dataset.folder, os.fsdecode(bytes(tmp_path / "gr") + b"\xfc\xdf")
    )
    done = subprocess.run(
        [sys.executable, "-m", "bench", "status", folder],
        capture_output=True, check=False, timeout=HANGS_S,
        env={**os.environ, "PYTHONUTF8": "1", "PYTHONPATH": str(Path(__file__).parents[2])},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert rb"gr\udcfc\udcdf: dataset" in done.stdout


@pytest.mark.parametrize(
    "typed", [["x" * 9000], ["render", "x" * 9000, "--out", "o"], ["score", "y" * 9000]]
)
def test_a_message_about_a_long_word_stays_short(typed, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(typed) == 2
    told = capsys.readouterr().err
    assert told.startswith("rvbench: ")
    assert told.count("\n") == 1
    assert len(told) < 2500
    assert not list(tmp_path.iterdir())
