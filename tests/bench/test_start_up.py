"""What a command loads before it works: a slow start is libraries that it never uses.

No clock is read. The libraries that take long to load are named, and each command must do without
those that its work does not need; a new import at the head of a module shows here.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.patience import HANGS_S
from tests.support.synthetic_dataset import SyntheticDataset

HOUSE = Path(__file__).resolve().parents[2]
RENDERER = {"mitsuba", "drjit"}
MESHES = {"trimesh", "networkx"}
FIGURES = {"matplotlib", "jinja2"}
WIDE_SCIPY = {"scipy.stats", "scipy.optimize", "scipy.interpolate", "scipy.integrate"}
IMAGES = {"cv2", "skimage", "OpenEXR"}
SCENARIOS = {"pydantic"}
SLOW = RENDERER | MESHES | FIGURES | WIDE_SCIPY | IMAGES | SCENARIOS | {"scipy"}

LOADED = """
import sys
from bench.cli import main
code = main(sys.argv[1:])
print(*sorted(sys.modules), file=sys.stderr)
sys.exit(code)
"""


def loaded_by(*arguments: object, code: int = 0) -> set[str]:
    """Return the modules that are loaded once a command has ended, with an exit code."""
    done = subprocess.run(
        [sys.executable, "-c", LOADED, *map(str, arguments)],
        cwd=HOUSE,
        env={**os.environ, "PYTHONPATH": str(HOUSE)},
        capture_output=True,
        text=True,
        check=False,
        timeout=HANGS_S,
    )
    assert done.returncode == code, done.stderr
    return set(done.stderr.splitlines()[-1].split())


@pytest.mark.parametrize(
    "typed", ["--version", "--help", "run --help", "sweep --help", "show --help", "new --help"]
)
def test_help_and_versions_load_no_library_of_the_work(typed: str) -> None:
    assert loaded_by(*typed.split()).isdisjoint(SLOW | {"numpy"})


def test_a_list_builds_no_mesh_and_validates_no_scenario() -> None:
    loaded = loaded_by("list")
    assert loaded.isdisjoint(SLOW)
    assert not [name for name in loaded if name.startswith("models.spacecraft.maxar")]


@pytest.mark.parametrize("verb", ["run", "render", "sweep"])
def test_a_mistyped_case_is_answered_before_anything_is_loaded(verb: str, tmp_path: Path) -> None:
    loaded = loaded_by(verb, "maxar-dmeo", "--out", tmp_path / "out", code=2)
    assert loaded.isdisjoint(SLOW)


@pytest.fixture
def folder(scored_dataset: SyntheticDataset, tmp_path: Path) -> Path:
    """Return a scored dataset that a command may write to."""
    return Path(shutil.copytree(scored_dataset.folder, tmp_path / "data"))


def test_a_picture_loads_what_draws_it(folder: Path) -> None:
    loaded = loaded_by("show", folder, 0)
    needed = {"matplotlib", "cv2", "scipy"}
    assert needed <= loaded  # or the test sees nothing
    assert loaded.isdisjoint(SLOW - needed)


def test_a_score_draws_nothing(folder: Path) -> None:
    assert loaded_by("score", folder).isdisjoint(RENDERER | MESHES | FIGURES | WIDE_SCIPY)


def test_a_report_renders_nothing(folder: Path) -> None:
    loaded = loaded_by("report", folder)
    assert loaded.isdisjoint(RENDERER | MESHES | WIDE_SCIPY | SCENARIOS)


def test_a_status_loads_no_library_of_the_work(folder: Path) -> None:
    assert loaded_by("status", folder).isdisjoint(SLOW)


def test_estimating_draws_nothing(folder: Path) -> None:
    loaded = loaded_by("estimate", folder)
    assert loaded.isdisjoint(RENDERER | MESHES | FIGURES | SCENARIOS | {"scipy.stats"})
