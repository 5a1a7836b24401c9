"""A SLURM of two nodes, a Dask cluster of two workers, and what one machine alone makes."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.cluster.small_slurm import SmallSlurm, program
from tests.support.whole_runs import HOUSE

SUITE = ("suite", "vinag2018", "--parts", "leo", "--quick", "--duration-s", "60", "--seeds", "1",
         "--runs", "2")  # fmt: skip
SWEEP = ("sweep", "maxar-approach", "--range-m", "2.5", "--sun-step-deg", "15", "--width", "256",
         "--spp", "4", "--draws", "1")  # fmt: skip
CASE = ("render", "xmm-tumble", "--width", "128", "--spp", "4", "--span-s", "0", "900")
SPEC = """
name = "small"
frames = 48
suns_per_pose = 2
exposures_per_sun = 2
target = [{ spacecraft = "hispasat" }]
pose = { range_m = [25.0, 60.0] }
render = { samples = 4 }
[[camera]]
name = "wide"
width = 64
[[camera]]
name = "own"
width = 80
height = 64
fov_deg = 30.0
range_factor = 1.5
"""


def start(*arguments: object, environment: dict[str, str] | None = None) -> subprocess.Popen[str]:
    """Start ``rvbench``."""
    return subprocess.Popen(
        [sys.executable, "-P", "-m", "bench", *map(str, arguments)],
        env={**(environment or os.environ), "PYTHONPATH": str(HOUSE)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def run(*arguments: object, environment: dict[str, str] | None = None) -> tuple[int, str]:
    """Run ``rvbench``; return its exit code and what it said."""
    process = start(*arguments, environment=environment)
    said = process.communicate()[0]
    return process.returncode, said


@pytest.fixture(scope="session")
def slurm(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SmallSlurm]:
    """Return a SLURM of our own; skip where it cannot be."""
    if os.getuid() != 0 or None in map(program, ("slurmctld", "slurmd", "sbatch", "munged")):
        pytest.skip("no SLURM, or not root: apt-get install slurm-wlm munge, then this again")
    own = SmallSlurm(tmp_path_factory.mktemp("slurm"))
    yield own
    own.stop()


@pytest.fixture(scope="session")
def suite_alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the suite, made by this machine alone."""
    out = tmp_path_factory.mktemp("alone") / "suite"
    code, said = run(*SUITE, "--out", out)
    assert code == 0, said
    return out


@pytest.fixture(scope="session")
def spec(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the specification of a small random dataset."""
    path = tmp_path_factory.mktemp("spec") / "small.toml"
    path.write_text(SPEC)
    return path


@pytest.fixture(scope="session")
def dataset_alone(spec: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of that dataset, made by this machine alone."""
    out = tmp_path_factory.mktemp("alone") / "dataset"
    code, said = run("dataset", spec, "--out", out)
    assert code == 0, said
    return out


@pytest.fixture(scope="session")
def sweep_alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a sweep of 188 Suns, made by this machine alone."""
    home = tmp_path_factory.mktemp("alone")
    code, said = run(*SWEEP, "--out", home / "sweep", "--store", home / "store")
    assert code == 0, said
    return home / "sweep"


@pytest.fixture(scope="session")
def case_alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a rendered case, made by this machine alone."""
    home = tmp_path_factory.mktemp("alone")
    code, said = run(*CASE, "--out", home / "case", "--store", home / "store")
    assert code == 0, said
    return home / "case"
