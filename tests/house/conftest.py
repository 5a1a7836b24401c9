"""One small run from scenario to report, for the tests that break, repeat and compare it."""

from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.support.whole_runs import rvbench, write_scenario


@dataclass(frozen=True)
class WholeRun:
    """A run that nothing interrupted."""

    scenario: Path
    out: Path
    store: Path
    errors: str


@pytest.fixture(scope="session")
def whole_run(tmp_path_factory) -> WholeRun:
    """Render, estimate (two runs), score and report; a test may read it, not change it."""
    folder = tmp_path_factory.mktemp("whole_run")
    scenario, out, store = write_scenario(folder), folder / "out", folder / "store"
    code, errors = rvbench("run", scenario, "--out", out, "--store", store, "--seeds", 2)
    assert code == 0, errors
    return WholeRun(scenario, out, store, errors)
