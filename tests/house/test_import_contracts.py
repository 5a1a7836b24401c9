"""The floors hold, and the contracts that hold them would notice if they did not."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.patience import HANGS_S

HOUSE = Path(__file__).resolve().parents[2]
ROOMS = ("models", "renders", "pipelines", "bench")

# Every forbidden direction, and the two packages that pipelines and models must never load.
PLANTED = {
    "models/pose.py": ("import mitsuba", "models.pose -> mitsuba"),
    "models/frame.py": ("import drjit", "models.frame -> drjit"),
    "models/camera.py": (
        "import renders.truth.exposure_truth",
        "models.camera -> renders.truth.exposure_truth",
    ),
    "models/sensors/camera_chip.py": (
        "import pipelines.chaser_fixed.options",
        "models.sensors.camera_chip -> pipelines.chaser_fixed.options",
    ),
    "models/estimate.py": (
        "import bench.scoring.metrics",
        "models.estimate -> bench.scoring.metrics",
    ),
    "pipelines/chaser_fixed/options.py": (
        "import mitsuba",
        "pipelines.chaser_fixed.options -> mitsuba",
    ),
    "pipelines/chaser_fixed/pipeline.py": (
        "from renders import truth",
        "pipelines.chaser_fixed.pipeline -> renders.truth (",
    ),
    "pipelines/registry.py": (
        "import bench.scoring.score",
        "pipelines.registry -> bench.scoring.score",
    ),
    "pipelines/pnp/match.py": (
        "import pipelines.chaser_fixed.options",
        "pipelines.pnp.match -> pipelines.chaser_fixed.options",
    ),
    "pipelines/detection/blobs.py": (
        "import pipelines.tracking.point_fit",
        "pipelines.detection.blobs -> pipelines.tracking.point_fit",
    ),
    "pipelines/chaser_fixed/registered.py": (
        "import pipelines.uncooperative.options",
        "pipelines.chaser_fixed.registered -> pipelines.uncooperative.options",
    ),
    "renders/truth/exposure_truth.py": (
        "import pipelines.chaser_fixed.options",
        "renders.truth.exposure_truth -> pipelines.chaser_fixed.options",
    ),
    "renders/scenario/scenario.py": (
        "import bench.scoring.score",
        "renders.scenario.scenario -> bench.scoring.score",
    ),
}


def lint_imports(folder: Path) -> subprocess.CompletedProcess[str]:
    """Run the import linter on the packages of a folder, wherever rvbench is installed."""
    environment = {**os.environ, "PYTHONPATH": str(folder), "COLUMNS": "200"}
    return subprocess.run(
        [Path(sys.executable).with_name("lint-imports"), "--no-cache"],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=HANGS_S,
    )


@pytest.fixture
def copied_house(tmp_path) -> Path:
    for room in ROOMS:
        shutil.copytree(
            HOUSE / room, tmp_path / room, ignore=shutil.ignore_patterns("__pycache__", "cases")
        )
    shutil.copy(HOUSE / "pyproject.toml", tmp_path)
    return tmp_path


def test_the_contracts_are_kept():
    result = lint_imports(HOUSE)
    assert result.returncode == 0, result.stdout + result.stderr


def test_each_planted_breach_is_named(copied_house):
    for place, (line, _) in PLANTED.items():
        path = copied_house / place
        text = path.read_text()
        path.write_text(text + f"\n{line}\n")
    result = lint_imports(copied_house)
    assert result.returncode != 0
    told = " ".join(result.stdout.split())
    for breach in (breach for _, breach in PLANTED.values()):
        assert breach in told, result.stdout


@pytest.mark.parametrize(
    ("place", "line"),
    [
        ("pipelines/registry.py", "import renders.truth.exposure_truth"),
        ("models/pose.py", "import mitsuba"),
    ],
)
def test_one_breach_is_enough(copied_house, place, line):
    path = copied_house / place
    path.write_text(path.read_text() + f"\n\ndef _later():\n    {line}\n")
    assert lint_imports(copied_house).returncode != 0
