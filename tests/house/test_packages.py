"""What is installed is what is there, and no stranger can stand in for a room."""

import subprocess
import sys
import tomllib
from pathlib import Path

from setuptools import find_packages

from tests.support.patience import HANGS_S

HOUSE = Path(__file__).resolve().parents[2]
ROOMS = ("models", "renders", "pipelines", "bench")
PROJECT = tomllib.loads((HOUSE / "pyproject.toml").read_text())


EXAMPLES = HOUSE / "bench" / "examples"  # each a distribution of its own, that no room ships


def files_of(room: str) -> list[Path]:
    paths = (HOUSE / room).rglob("*")
    return [path for path in paths if path.is_file() and EXAMPLES not in path.parents]


def test_every_folder_with_code_is_a_package():
    for room in ROOMS:
        for path in files_of(room):
            if path.suffix == ".py":
                assert (path.parent / "__init__.py").is_file(), path


def test_the_packages_shipped_are_those_of_the_rooms():
    options = PROJECT["tool"]["setuptools"]["packages"]["find"]
    assert options.pop("namespaces") is False  # so that cases and reference numbers are data
    found = {
        ".".join(path.parent.relative_to(HOUSE).parts)
        for room in ROOMS
        for path in files_of(room)
        if path.name == "__init__.py"
    }
    assert set(find_packages(str(HOUSE), **options)) == found


def test_every_example_is_a_distribution():
    for example in EXAMPLES.iterdir():
        if example.is_dir() and example.name != "__pycache__":
            assert (example / "pyproject.toml").is_file(), example


def test_every_data_file_is_shipped():
    """Each file that is not code matches a pattern of ``package-data``, or is a door sign."""
    patterns = PROJECT["tool"]["setuptools"]["package-data"]
    for room in ROOMS:
        shipped = {path for pattern in patterns[room] for path in (HOUSE / room).glob(pattern)}
        data = {path for path in files_of(room) if path.suffix not in (".py", ".pyc", ".md")}
        assert data <= shipped, data - shipped


def test_tests_have_no_packages():
    """With an ``__init__.py`` there, ``tests/models`` would hijack the name ``models``."""
    assert not list((HOUSE / "tests").rglob("__init__.py"))


def test_one_console_script():
    assert PROJECT["project"]["scripts"] == {"rvbench": "bench.cli:main"}


def start_beside_a_stranger(tmp_path: Path, *options: str) -> subprocess.CompletedProcess[str]:
    stranger = tmp_path / "models"
    stranger.mkdir()
    (stranger / "__init__.py").write_text("")
    return subprocess.run(
        [sys.executable, *options, "-c", "import bench; print('in')"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        timeout=HANGS_S,
    )


def test_a_foreign_models_on_the_path_is_refused(tmp_path):
    result = start_beside_a_stranger(tmp_path)
    assert result.returncode != 0
    assert "ImportError: expected the package 'models' in" in result.stderr
    assert str(tmp_path / "models") in result.stderr
    assert "python -P" in result.stderr


def test_the_remedy_that_it_names_works(tmp_path):
    result = start_beside_a_stranger(tmp_path, "-P")
    assert (result.returncode, result.stdout) == (0, "in\n")
