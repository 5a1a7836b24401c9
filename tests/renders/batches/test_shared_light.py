"""Frames at one pose share a pass of light: fewer passes, and not one bit of a frame another."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.motion.pose_table import pose_columns
from renders.batches import case_rendering
from renders.scenario.scenario import RenderRequest
from tests.renders.conftest import TinyDataset
from tests.support.small_scenes import needs_jit

SUNS = [(0.6, 0.0, 0.8), (0.0, 1.0, 0.0), (-0.8, 0.0, 0.6)]
EARTHS = [(0.0, 0.0, -1.0), (0.0, 0.0, 0.0)]  # behind the target at the first pose alone
RANGES_M = [25.0, 31.0]
HEAD = ",".join(
    [
        *pose_columns("cam_from_target"),
        *("sun_x", "sun_y", "sun_z", "exposure_ms", "earth_x", "earth_y", "earth_z", "stars"),
    ]
)
CASE = """\
name = "suns"
target = "{target}"

[motion]
file = "poses.csv"

[camera]
width = 64

[earth]
shines = true

[stars]
shine = true

[frame]
kind = "{kind}"

[render]
samples = 4
marker_samples = 64
{noise}
"""
NOISES = ["", "noise = 1.0", "noise = 1.0\npaths = 20000"]


def case(folder: Path, target: str = "hispasat", kind: str = "single", noise: str = "") -> Path:
    """Write a case of two poses under three Suns each; the camera looks along -z."""
    rows = []
    for range_m, earth in zip(RANGES_M, EARTHS, strict=True):
        for number, sun in enumerate(SUNS):
            row = [len(rows), 0.0, 0.0, range_m, 0.0, 1.0, 0.0, 0.0, *sun, 1.0 + number, *earth, 1]
            rows.append(",".join(str(x) for x in row))
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "poses.csv").write_text("\n".join([HEAD, *rows]) + "\n")
    path = folder / "case.toml"
    path.write_text(CASE.format(target=target, kind=kind, noise=noise))
    return path


def rendered(path: Path, out: Path, keep: str = "none") -> dict[str, bytes]:
    """Render a case; return its files but for the place of its store."""
    store = out.parent / f"{out.name}-store"
    dataset = TinyDataset(RenderRequest(str(path), out, store=store, keep_light=keep))  # type: ignore[arg-type]
    dataset.render()
    return {name: data for name, data in dataset.files().items() if name != "truth/light.json"}


@pytest.mark.parametrize(
    "noise", [*NOISES[:1], *(pytest.param(each, marks=pytest.mark.slow) for each in NOISES[1:])]
)
def test_frames_are_the_same_to_the_bit_in_company_and_alone(
    noise: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, traced: Callable[[], int]
) -> None:
    needs_jit()
    path = case(tmp_path, noise=noise)
    together = rendered(path, tmp_path / "together")
    assert traced() == len(RANGES_M)
    monkeypatch.setattr(case_rendering, "MOST_TOGETHER", 1)
    assert rendered(path, tmp_path / "alone") == together
    assert traced() == len(RANGES_M) + len(RANGES_M) * len(SUNS)


def test_of_image_pairs_the_lamps_are_traced_once_a_pose(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, traced: Callable[[], int]
) -> None:
    needs_jit()
    path = case(tmp_path, "maxar1300", "pairs")
    together = rendered(path, tmp_path / "together")
    assert traced() == 2 * len(RANGES_M)  # one for 800 nm and one for 850
    monkeypatch.setattr(case_rendering, "MOST_TOGETHER", 1)
    assert rendered(path, tmp_path / "alone", "all") == together


def test_what_is_kept_is_found_by_who_renders_one_frame(
    tmp_path: Path, traced: Callable[[], int]
) -> None:
    """The store's keys of a Sun know nothing of the others'."""
    needs_jit()
    path = case(tmp_path)
    whole = rendered(path, tmp_path / "out", "all")
    passes = traced()
    for name in list(whole):
        if name.startswith("frames/"):
            (tmp_path / "out" / name).unlink()
    assert rendered(path, tmp_path / "out", "all") == whole
    assert traced() == passes


def test_frames_of_one_pose_share_a_place_and_its_seed(tmp_path: Path) -> None:
    request = RenderRequest(str(case(tmp_path)), tmp_path / "out")
    world = TinyDataset(request).world
    places = [world.place(frame) for frame in range(6)]
    assert places == [0, 0, 0, 3, 3, 3]
    seeds = [world.render_seed(frame) for frame in range(6)]
    assert len(set(seeds)) == 2
    later = TinyDataset(replace(request, start_s=1.0)).world
    assert [later.place(frame) for frame in range(5)] == [0, 0, 2, 2, 2]


def test_each_row_has_its_own_earth(tmp_path: Path) -> None:
    world = TinyDataset(RenderRequest(str(case(tmp_path)), tmp_path / "out")).world
    has_earth = [world.sky.shows_earth(exposure.time_s) for exposure in world.exposures]
    assert has_earth == [True] * 3 + [False] * 3
    counts = [len(world.lit_by(exposure)) for exposure in world.exposures]
    assert counts == [2] * 3 + [1] * 3
    np.testing.assert_allclose(world.earth_at(0.0)[0], EARTHS[0])
