"""The set-up's decisions, with a pretended machine: which Python, which libLLVM, what it says."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.patience import HANGS_S

HOUSE = Path(__file__).parents[2]
TOOLS = ("sh", "dirname", "mktemp", "rm", "sed", "sort", "awk", "env", "timeout", "cat")

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="the set-up is a shell's")


class PretendedMachine:
    """A folder of commands that stand in for a system's, as the only ones on the path."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.log = folder / "log"
        for tool in TOOLS:
            (folder / tool).symlink_to(shutil.which(tool) or "/missing")

    def command(self, name: str, body: str) -> str:
        """Put a command on the path; each call of it is logged."""
        path = self.folder / name
        path.write_text(f'#!/bin/sh\necho "{name} $*" >>{self.log}\n{body}\n')
        path.chmod(0o755)
        return str(path)

    def run(self, script: str, *arguments: str, **variables: str) -> tuple[int, str, str]:
        """Run a script of the house; return its exit code, its words, and the commands called."""
        done = subprocess.run(
            [str(HOUSE / "scripts" / script), *arguments],
            env={"PATH": str(self.folder), "TMPDIR": str(self.folder)} | variables,
            cwd=self.folder,
            capture_output=True,
            text=True,
            timeout=HANGS_S,
        )
        calls = self.log.read_text() if self.log.exists() else ""
        return done.returncode, done.stdout + done.stderr, calls


@pytest.fixture
def machine(tmp_path) -> PretendedMachine:
    """Return a machine with a shell and nothing else."""
    return PretendedMachine(tmp_path)


def debian(machine: PretendedMachine, user: int, offered: str, installing: str) -> str:
    """Make it a Debian whose Mitsuba renders once apt-get has left a library."""
    machine.command("id", f"echo {user}")
    machine.command("apt-cache", f"printf '{offered}'")
    machine.command("apt-get", f'[ "$1" = update ] || {installing}')
    return machine.command("python", f"[ -e {machine.folder}/library ]")


OFFERED = "libllvm14 - old\\nlibllvm19 - good\\nlibllvm20 - better\\nlibllvm9 - older\\n"


def test_the_probe_that_set_up_runs_is_there() -> None:
    script = HOUSE / "scripts" / "ensure_llvm.sh"
    (probe,) = (line for line in script.read_text().splitlines() if line.startswith("probe="))
    assert (script.parent / probe.partition('$(dirname "$0")/')[2]).is_file()


def test_a_machine_that_renders_is_left_alone(machine) -> None:
    python = debian(machine, user=0, offered=OFFERED, installing="exit 1")
    (machine.folder / "library").touch()
    assert machine.run("ensure_llvm.sh", python)[:2] == (0, "")
    assert "apt" not in machine.log.read_text()


def test_root_on_debian_installs_the_newest(machine) -> None:
    python = debian(machine, 0, OFFERED, f": >{machine.folder}/library")
    code, words, calls = machine.run("ensure_llvm.sh", python)
    assert (code, words) == (0, "LLVM: installing libllvm20\n")
    assert " libllvm20\n" in calls


def test_a_system_too_old_is_told_where_to_look(machine) -> None:
    python = debian(machine, 0, "libllvm14 - old\\n", "exit 1")
    code, words, calls = machine.run("ensure_llvm.sh", python)
    assert code == 0
    assert words.count("\n") == 1
    assert "apt.llvm.org" in words
    assert "apt-get update" in calls


@pytest.mark.parametrize(
    ("user", "installing", "told"),
    [
        (1000, "exit 1", "run 'sudo apt-get install libllvm20'"),
        (0, "exit 1", "'apt-get install libllvm20' failed"),
        (0, ":", "is installed, but llvm_ad_rgb does not render"),
    ],
)
def test_what_cannot_be_got_is_one_line_and_no_failure(machine, user, installing, told) -> None:
    python = debian(machine, user, OFFERED, installing)
    code, words, _ = machine.run("ensure_llvm.sh", python)
    last = words.splitlines()[-1]
    assert code == 0
    assert told in last
    assert last.endswith("going on with scalar_rgb, slower but correct")
    assert len([line for line in words.splitlines() if "going on" in line]) == 1


def test_another_system_is_told_its_own_command(machine) -> None:
    python = machine.command("python", "exit 134")
    code, words, _ = machine.run("ensure_llvm.sh", python)
    assert code == 0
    assert words.count("\n") == 1
    assert "brew install llvm" in words


def test_a_hidden_llvm_is_not_installed_over(machine) -> None:
    python = debian(machine, 0, OFFERED, f": >{machine.folder}/library")
    code, words, calls = machine.run("ensure_llvm.sh", python, DRJIT_LIBLLVM_PATH="/nonexistent")
    assert code == 0
    assert "DRJIT_LIBLLVM_PATH is '/nonexistent'" in words
    assert "apt" not in calls


def python_of(machine: PretendedMachine, name: str, minor: int, *, makes_venvs: bool = True) -> str:
    """Put a Python 3.MINOR on the path that answers what the set-up asks of one."""
    answers = f"""case "$2" in
*ensurepip*) exit {0 if makes_venvs else 1} ;;
*version_info\\ *) [ {minor} -ge 11 ] && [ {minor} -lt "$3" ] ;;
*print*) echo 3.{minor} ;;
*) echo "Python 3.{minor}.0" ;;
esac"""
    return machine.command(name, answers)


def test_the_default_python_serves_if_it_is_new_enough(machine) -> None:
    expected = python_of(machine, "python3", 12)
    python_of(machine, "python3.13", 13)
    code, words, _ = machine.run("find_python.sh")
    assert (code, words.strip()) == (0, expected)


def test_a_newer_python_beside_an_old_default_is_found(machine) -> None:
    python_of(machine, "python3", 9)
    expected = python_of(machine, "python3.12", 12)
    code, words, _ = machine.run("find_python.sh")
    assert (code, words.strip()) == (0, expected)


def test_a_python_that_the_locks_know_goes_before_a_newer_one(machine) -> None:
    python_of(machine, "python3", 15)
    expected = python_of(machine, "python3.11", 11)
    code, words, _ = machine.run("find_python.sh")
    assert (code, words.strip()) == (0, expected)


def test_only_an_old_python_is_told_what_is_wanted(machine) -> None:
    python_of(machine, "python3", 9)
    code, words, _ = machine.run("find_python.sh")
    assert code == 2
    assert words.count("\n") == 1
    assert "expected Python 3.11 or newer on the path, got Python 3.9.0" in words


def test_a_python_without_venv_is_told_the_package(machine) -> None:
    python_of(machine, "python3", 11, makes_venvs=False)
    code, words, _ = machine.run("find_python.sh")
    assert code == 2
    assert words.count("\n") == 1
    assert "apt-get install python3.11-venv" in words


def test_the_real_python_of_these_tests_is_accepted() -> None:
    here = os.path.dirname(sys.executable)
    done = subprocess.run(
        [str(HOUSE / "scripts" / "find_python.sh")],
        env={"PATH": f"{here}:/usr/bin:/bin"},
        capture_output=True,
        text=True,
        timeout=HANGS_S,
    )
    assert done.returncode == 0, done.stderr
