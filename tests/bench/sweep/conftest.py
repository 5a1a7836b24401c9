"""One small sweep, done once, for the tests that read it or go on from a copy."""

from __future__ import annotations

import io
import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from rich.console import Console

from bench.sweep.plan import SweepRequest
from bench.sweep.run import SweepResult, run_sweep
from renders.store.radiance_store import RadianceStore
from tests.support.small_scenes import activate_best

SUNS = ("S2", "90/30", "0,0,-1")
SCENARIO = """
name = "small"
[camera]
width = 128
[motion]
start_s = 240.0
end_s = 290.0
rate_hz = 0.1
[render]
samples = 4
marker_samples = 16
max_depth = 2
"""


@dataclass(frozen=True)
class SmallSweep:
    """A request, and how to do it again."""

    request: SweepRequest

    @property
    def out(self) -> Path:
        return self.request.out

    @property
    def store(self) -> RadianceStore:
        assert self.request.store is not None
        return RadianceStore(self.request.store)

    def run(self, **options: object) -> tuple[SweepResult, str]:
        """Do what is not there, with other options if given; return what came and what was said."""
        said = io.StringIO()
        request = replace(self.request, **options)  # type: ignore[arg-type]
        return run_sweep(request, Console(file=said, width=300)), said.getvalue()


@pytest.fixture(scope="session")
def swept_once(tmp_path_factory: pytest.TempPathFactory) -> SmallSweep:
    """Never changed: see ``sweep`` for a copy that may be."""
    activate_best()
    home = tmp_path_factory.mktemp("sweep")
    (home / "small.toml").write_text(SCENARIO)
    request = SweepRequest(
        str(home / "small.toml"), home / "out", time_s=(250.0,), suns=SUNS,
        store=home / "store", threads=1, draws=1,
    )  # fmt: skip
    small = SmallSweep(request)
    small.run()
    return small


@pytest.fixture
def sweep(swept_once: SmallSweep, tmp_path: Path) -> SmallSweep:
    """Return a copy with a store of its own, to be damaged or gone on with."""
    shutil.copytree(swept_once.out, tmp_path / "out")
    shutil.copytree(swept_once.store.folder, tmp_path / "store")
    return SmallSweep(replace(swept_once.request, out=tmp_path / "out", store=tmp_path / "store"))


@pytest.fixture
def traced(monkeypatch: pytest.MonkeyPatch) -> Callable[[], list[list[str]]]:
    """Return the names of the groups of each pass that is traced from here on."""
    activate_best()
    from renders.tracing import radiance

    passes: list[list[str]] = []
    really = radiance.render_radiance

    def counted(*arguments: object, **named: object) -> object:
        passes.append([group.name for group in arguments[4]])  # type: ignore[attr-defined]
        return really(*arguments, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(radiance, "render_radiance", counted)
    return lambda: passes
