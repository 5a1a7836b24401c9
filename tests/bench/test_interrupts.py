"""Ctrl-C ends a process soon, whatever it is in, and says what is true of the verb."""

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from bench import cli
from bench.interrupts import WHAT_IS_KEPT, told
from tests.support.patience import HANGS_S

HOUSE = Path(__file__).resolve().parents[2]
IN_A_KERNEL = """
import hashlib, signal, sys
from pathlib import Path
from bench.interrupts import prompt_interrupts
from models.atomic_file import whole_or_absent
signal.signal(signal.SIGINT, lambda *_: None)  # whenever it comes, Python makes nothing of it
with prompt_interrupts("estimate"), whole_or_absent(Path(sys.argv[1])) as scratch:
    scratch.write_text("half")
    print("in it", flush=True)
    hashlib.pbkdf2_hmac("sha256", b"", b"", 2**31 - 1)  # as Dr.Jit's: Python sees no signal
"""


@pytest.mark.skipif(sys.platform != "linux", reason="signals as on Linux")
def test_a_kernel_that_python_cannot_stop_is_left(tmp_path):
    place = tmp_path / "whole.txt"
    place.write_text("as before")
    process = subprocess.Popen(
        [sys.executable, "-c", IN_A_KERNEL, str(place)],
        cwd=HOUSE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "in it\n"
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=HANGS_S)
    assert process.returncode == 130, errors
    assert errors.strip() == told("estimate")
    assert place.read_text() == "as before"
    assert os.listdir(tmp_path) == ["whole.txt"]


STRUCK = """
import os, runpy, signal, sys, time
from models.camera import Camera
signal.signal(signal.SIGINT, signal.default_int_handler)
def from_toml(path):
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(3600.0)
Camera.from_toml = from_toml
sys.argv = ["rvbench", "estimate", "--frames", ".", "--camera", "camera.toml"]
runpy.run_module("bench", run_name="__main__")
"""


def test_what_ends_by_itself_is_told_once():
    """The whole command, interrupted as it reads its camera: one message, no traceback."""
    done = subprocess.run(
        [sys.executable, "-c", STRUCK],
        cwd=HOUSE,
        capture_output=True,
        text=True,
        check=False,
        timeout=HANGS_S,
    )
    assert done.returncode == 130, done.stderr
    assert done.stderr.strip() == told("estimate")


def test_every_verb_says_what_is_true_of_it():
    assert set(cli.VERBS) <= set(WHAT_IS_KEPT)
    for verb in ("run", "render", "sweep", "suite"):
        assert "the same command goes on from there" in told(verb)
    for verb in ("estimate", "score", "report", "show", "list"):
        assert "goes on from there" not in told(verb)
    assert re.search("none of these were kept.*the same command starts over", told("estimate"))
