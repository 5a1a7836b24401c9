"""A run whose pixels are sampled to their noise: equal however it is rendered, and resumable."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from models.dataset.image_file import read_image
from renders.batches.stepping import Simulation
from renders.scenario.scenario import RenderRequest
from tests.renders.conftest import TinyDataset
from tests.support.small_scenes import needs_jit

CASE = """
name = "quiet"
target = "maxar1300"
[camera]
width = 96
[motion]
start_s = 240.0
end_s = 240.0
rate_hz = 0.05
[render]
noise = 1.0
marker_samples = 16
paths = 20000
"""


@pytest.fixture(scope="module")
def quiet(tmp_path_factory: pytest.TempPathFactory) -> TinyDataset:
    needs_jit()
    folder = tmp_path_factory.mktemp("quiet")
    (folder / "quiet.toml").write_text(CASE)
    request = RenderRequest(
        str(folder / "quiet.toml"), folder / "out", store=folder / "store", threads=2
    )
    made = TinyDataset(request)
    said = made.render()
    assert "20000 paths are followed from the Sun, once for all exposures" in said
    return made


def images(folder: Path) -> dict[str, Any]:
    return {path.name: read_image(path) for path in sorted((folder / "frames").glob("*.png"))}


def test_an_interrupted_run_goes_on_to_the_same_bits(quiet: TinyDataset, tmp_path: Path) -> None:
    whole = images(quiet.folder)
    assert len(whole) == 2
    shutil.copytree(quiet.folder, tmp_path / "out")
    (tmp_path / "out" / "frames" / "000000_850.png").unlink()
    request = RenderRequest(
        quiet.request.case, tmp_path / "out", store=tmp_path / "another", threads=1
    )
    TinyDataset(request).render()
    again = images(tmp_path / "out")
    assert all(np.array_equal(whole[name], again[name]) for name in whole)


def test_what_was_followed_once_is_taken_from_the_store(
    quiet: TinyDataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from renders.batches.render_case import render_case
    from renders.tracing.light_paths.sunlit import Sunlit

    def refuse(*_: object) -> None:
        raise AssertionError("followed again")

    monkeypatch.setattr(Sunlit, "landed", refuse)
    shutil.copytree(quiet.store.folder, tmp_path / "store")
    other = tmp_path / "other.toml"  # the same light once, but other frames
    other.write_text(CASE.replace("noise = 1.0", "noise = 1.2"))
    request = RenderRequest(str(other), tmp_path / "out", store=tmp_path / "store")
    render_case(request, Console(quiet=True))
    assert len(images(tmp_path / "out")) == 2


def test_a_stepped_simulation_gives_the_same_frame(quiet: TinyDataset) -> None:
    simulation = Simulation(quiet.request.case, store=quiet.request.store)
    frame = simulation.frame(240.0)
    for band in (800, 850):
        batch = read_image(quiet.folder / "frames" / f"000000_{band}.png")
        assert np.array_equal(frame.image(f"image_{band}").image, batch)
