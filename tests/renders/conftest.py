"""Tiny datasets, rendered once for all tests that read, replay or damage a copy of them."""

from __future__ import annotations

import io
import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from rich.console import Console

from models.arrays import Floats
from renders.scenario.scenario import RenderRequest, Scenario, resolve
from renders.store.radiance_store import RadianceStore
from renders.world.build import world_of
from renders.world.trajectory import FreeMotion
from renders.world.world import World
from tests.support.small_scenes import activate_best, needs_jit
from tests.support.tumble_scenario import tumble_table


@dataclass(frozen=True)
class TinyDataset:
    """A rendered case of two frames, and how to render it again."""

    request: RenderRequest

    @property
    def folder(self) -> Path:
        return self.request.out

    @property
    def store(self) -> RadianceStore:
        assert self.request.store is not None
        return RadianceStore(self.request.store)

    @property
    def world(self) -> World:
        return world_of(resolve(self.request))

    def render(self) -> str:
        """Render what is not there, and return what was printed."""
        from renders.batches.render_case import render_case

        said = io.StringIO()
        render_case(self.request, Console(file=said, width=300))
        return said.getvalue()

    def files(self) -> dict[str, bytes]:
        """Return every file of the dataset by its name in it."""
        return {
            str(path.relative_to(self.folder)): path.read_bytes()
            for path in sorted(self.folder.rglob("*"))
            if path.is_file()
        }


@pytest.fixture(scope="session")
def rendered_once(tmp_path_factory: pytest.TempPathFactory) -> TinyDataset:
    """Never changed: see ``tiny`` for a copy that may be.

    Without a JIT a tree is built for every group: minutes, for the same mechanics.
    """
    needs_jit()
    home = tmp_path_factory.mktemp("tiny")
    request = RenderRequest(
        "maxar-demo",
        home / "out",
        start_s=240.0,
        end_s=250.0,
        rate_hz=0.1,
        width=128,
        spp=4,
        store=home / "store",
    )
    dataset = TinyDataset(request)
    dataset.render()
    return dataset


@pytest.fixture
def tiny(rendered_once: TinyDataset, tmp_path: Path) -> TinyDataset:
    """Return a copy with a store of its own, to be damaged."""
    shutil.copytree(rendered_once.folder, tmp_path / "out")
    shutil.copytree(rendered_once.store.folder, tmp_path / "store")
    record = tmp_path / "out" / "truth" / "light.json"
    theirs, ours = rendered_once.store.folder.resolve(), (tmp_path / "store").resolve()
    record.write_text(record.read_text().replace(str(theirs), str(ours)))
    return TinyDataset(
        replace(rendered_once.request, out=tmp_path / "out", store=tmp_path / "store")
    )


@pytest.fixture
def traced(monkeypatch: pytest.MonkeyPatch) -> Callable[[], int]:
    """Count how often light is traced from here on."""
    activate_best()
    from renders.tracing import radiance

    calls = []
    really = radiance.render_radiance

    def counted(*arguments: object, **named: object) -> object:
        calls.append(1)
        return really(*arguments, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(radiance, "render_radiance", counted)
    return lambda: len(calls)


class TinyTumble(TinyDataset):
    """A rendered case of three single images."""

    @property
    def motion(self) -> FreeMotion:
        absolute = self.world.absolute
        assert absolute is not None
        return absolute

    @property
    def landmarks(self) -> Floats:
        wireframe = self.world.onboard(0).wireframe
        assert wireframe is not None
        return wireframe.points_in_target


@pytest.fixture(scope="session")
def tumbled_once(tmp_path_factory: pytest.TempPathFactory) -> TinyTumble:
    """Never changed: see ``tumbled`` for a copy that may be."""
    needs_jit()
    home = tmp_path_factory.mktemp("tumble")
    case = home / "small.toml"
    case.write_text(Scenario.model_validate(tumble_table()).to_toml())
    dataset = TinyTumble(RenderRequest(str(case), home / "out", store=home / "store"))
    dataset.render()
    return dataset


@pytest.fixture
def tumbled(tumbled_once: TinyTumble, tmp_path: Path) -> TinyTumble:
    """Return a copy with a store of its own, to be damaged."""
    shutil.copytree(tumbled_once.folder, tmp_path / "out")
    shutil.copytree(tumbled_once.store.folder, tmp_path / "store")
    record = tmp_path / "out" / "truth" / "light.json"
    theirs, ours = tumbled_once.store.folder.resolve(), (tmp_path / "store").resolve()
    record.write_text(record.read_text().replace(str(theirs), str(ours)))
    return TinyTumble(replace(tumbled_once.request, out=tmp_path / "out", store=tmp_path / "store"))
