"""The locks pin what pyproject.toml asks for, by hash, and name no place of anybody's."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
from packaging.markers import Marker
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

HOUSE = Path(__file__).parents[2]
PROJECT = tomllib.loads((HOUSE / "pyproject.toml").read_text())["project"]
LOCKS = {
    "requirements.lock": PROJECT["dependencies"],
    "requirements-dev.lock": PROJECT["dependencies"] + PROJECT["optional-dependencies"]["dev"],
}
ORACLE_LOCK = "requirements-oracle.lock"  # for one Python alone, that of bpy's wheels
ALL_LOCKS = [*LOCKS, ORACLE_LOCK]
PYTHONS = ("3.11.0", "3.12.0", "3.13.0")


def entries(lock: str) -> list[tuple[Requirement, str]]:
    """Return each pinned requirement of a lock with the text of its hashes."""
    text = re.sub(r"^#.*\n", "", (HOUSE / lock).read_text(), flags=re.MULTILINE)
    blocks = re.split(r"\n(?=\S)", text.strip())
    return [(Requirement(block.split(" \\\n")[0]), block) for block in blocks]


def pins(lock: str, python: str) -> dict[str, str]:
    """Return the version of each distribution that a lock installs on Linux under a Python."""
    where = {
        "python_full_version": python,
        "python_version": python.rpartition(".")[0],
        "sys_platform": "linux",
        "platform_python_implementation": "CPython",
    }
    return {
        canonicalize_name(requirement.name): str(requirement.specifier).removeprefix("==")
        for requirement, _ in entries(lock)
        if (requirement.marker or Marker("python_version > '3'")).evaluate(where)
    }


@pytest.mark.parametrize("python", PYTHONS)
@pytest.mark.parametrize("lock", LOCKS)
def test_every_dependency_is_pinned_within_its_bounds(lock, python) -> None:
    pinned = pins(lock, python)
    for asked in map(Requirement, LOCKS[lock]):
        assert asked.specifier.contains(pinned[canonicalize_name(asked.name)]), asked


@pytest.mark.parametrize("python", PYTHONS)
def test_tests_run_with_the_versions_that_users_get(python) -> None:
    assert (
        pins("requirements.lock", python).items() <= pins("requirements-dev.lock", python).items()
    )


@pytest.mark.parametrize("lock", ALL_LOCKS)
def test_every_pin_is_exact_and_hashed(lock) -> None:
    for requirement, block in entries(lock):
        (pin,) = requirement.specifier
        assert pin.operator == "=="
        assert requirement.url is None
        assert re.search(r"--hash=sha256:[0-9a-f]{64}\b", block), requirement


def test_the_oracles_lock_pins_what_its_group_asks_for() -> None:
    asked = tomllib.loads((HOUSE / "pyproject.toml").read_text())["dependency-groups"]["oracle"]
    pinned = pins(ORACLE_LOCK, "3.11.0")
    for requirement in map(Requirement, asked):
        assert requirement.specifier.contains(pinned[canonicalize_name(requirement.name)])


@pytest.mark.parametrize("lock", ALL_LOCKS)
def test_no_index_and_no_path(lock) -> None:
    assert not re.search(r"index-url|find-links|://|file:|/", (HOUSE / lock).read_text())
