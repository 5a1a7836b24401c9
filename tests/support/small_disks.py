"""Disks of memory, where the system lets us mount them: as root; elsewhere a test is skipped."""

import shutil
import subprocess

import pytest


def mount(*arguments: object) -> None:
    """Call mount with these arguments."""
    if shutil.which("mount") is None:
        pytest.skip("no small disk can be mounted here: no mount command")
    done = subprocess.run(
        ["mount", *map(str, arguments)], capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        pytest.skip(f"no small disk can be mounted here: {done.stderr.strip()}")


def unmount(folder: object) -> None:
    """Unmount a disk though files on it are open."""
    subprocess.run(["umount", "--lazy", str(folder)], check=True)
