"""Exposure times planned, fixed or metered; metered ones follow from images, however a run is cut.

The metered dataset is of the light of ``tiny`` and one more frame, under another exposure table.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from models.dataset.dataset import open_dataset
from models.dataset.frame_table import FrameEntry, read_frame_entries
from models.onboard import PosePrior
from models.pose import RigidTransform
from models.sensors.auto_exposure import AutoExposure
from renders.batches.dataset_writer import image_path
from renders.batches.replay import exposed_frames
from renders.detector.exposure_control import ExposureControl
from renders.scenario.scenario import Scenario
from renders.world.build import world_of
from renders.world.world import World
from tests.renders.conftest import TinyDataset
from tests.support.frame_images import at_800, at_850, exposed_ms, stored_frames

FIRST_MS = 0.05
TABLE = {"mode": "auto", "exposure_ms": FIRST_MS, "percentile": 99.0}
METER = AutoExposure(percentile=99.0)
FRAMES = 3


def asked(folder: Path, origin: TinyDataset, **table: object) -> TinyDataset:
    """Return the request for the light of another dataset, with another exposure table."""
    scenario = origin.world.scenario
    other = scenario.model_copy(
        update={
            "exposure": scenario.exposure.model_copy(update=table),
            "motion": scenario.motion.model_copy(update={"end_s": 260.0}),
        }
    )
    folder.mkdir(exist_ok=True)
    case = folder / "metered.toml"
    case.write_text(other.to_toml())
    return TinyDataset(
        replace(
            origin.request,
            case=str(case),
            out=folder / "out",
            store=folder / "store",
            end_s=None,
        )
    )


@pytest.fixture(scope="module")
def metered_once(
    rendered_once: TinyDataset, tmp_path_factory: pytest.TempPathFactory
) -> TinyDataset:
    """Never changed: see ``metered`` for a copy that may be."""
    home = tmp_path_factory.mktemp("metered")
    shutil.copytree(rendered_once.store.folder, home / "store")
    dataset = asked(home, rendered_once, **TABLE)
    dataset.render()
    return dataset


@pytest.fixture
def metered(metered_once: TinyDataset, tmp_path: Path) -> TinyDataset:
    shutil.copytree(metered_once.folder, tmp_path / "out")
    return TinyDataset(replace(metered_once.request, out=tmp_path / "out"))


def test_each_exposure_follows_from_the_image_before(metered_once: TinyDataset) -> None:
    detector = open_dataset(metered_once.folder).onboard.detector
    frames = stored_frames(metered_once.folder)
    assert len(frames) == FRAMES
    assert exposed_ms(frames[0]) == FIRST_MS
    for before, after in pairwise(frames):
        expected = METER.next_ms(exposed_ms(before), at_850(before), detector)
        assert exposed_ms(after) == expected
    assert len({exposed_ms(frame) for frame in frames}) == FRAMES
    assert [frame.time_s for frame in frames] == [240.0, 250.0, 260.0]


LOST: dict[str, tuple[str, ...]] = {
    "what was metered": ("frames.csv",),
    "a frame in the middle": ("frames/000001_800.png", "frames/000001_850.png"),
    "what was metered and an image that metered": ("frames.csv", "frames/000000_850.png"),
}


@pytest.mark.parametrize("lost", LOST.values(), ids=LOST.keys())
def test_what_was_lost_comes_back_bit_by_bit(
    metered: TinyDataset, traced: Callable[[], int], lost: tuple[str, ...]
) -> None:
    before = metered.files()
    for name in lost:
        (metered.folder / name).unlink()
    metered.render()
    assert metered.files() == before
    assert traced() == 0


@pytest.mark.parametrize("damage", ["index,time_s,exposure_ms\n0,240.0,", "", "0,240.0,77.0\n"])
def test_a_damaged_record_is_metered_again(metered: TinyDataset, damage: str) -> None:
    before = metered.files()
    (metered.folder / "frames.csv").write_text(damage)
    metered.render()
    assert metered.files() == before


@pytest.mark.parametrize("struck", [2, 5])
def test_a_run_cut_anywhere_ends_as_if_never_cut(
    metered: TinyDataset, monkeypatch: pytest.MonkeyPatch, struck: int
) -> None:
    """Interrupted at its second or fifth exposure; the next run reads the image before."""
    from renders.batches import case_rendering as batch

    before = metered.files()
    shutil.rmtree(metered.folder)
    really, calls = batch.compose, []

    def killed(*arguments: object, **named: object) -> object:
        calls.append(1)
        if len(calls) == struck:
            raise KeyboardInterrupt
        return really(*arguments, **named)  # type: ignore[arg-type]

    with monkeypatch.context() as patched:
        patched.setattr(batch, "compose", killed)
        with pytest.raises(KeyboardInterrupt):
            metered.render()
    known = read_frame_entries(metered.folder)
    assert [entry.index for entry in known] == list(range((struck + 1) // 2))
    assert not image_path(metered.folder, FRAMES - 1, 850).exists()
    metered.render()
    assert metered.files() == before


def test_replayed_the_frames_are_those_of_the_dataset(metered_once: TinyDataset) -> None:
    _, frames = exposed_frames(metered_once.folder, run=0)
    for ours, theirs in zip(frames, stored_frames(metered_once.folder), strict=True):
        assert exposed_ms(ours) == exposed_ms(theirs)
        np.testing.assert_array_equal(at_800(ours), at_800(theirs))
        np.testing.assert_array_equal(at_850(ours), at_850(theirs))


def test_another_run_meters_its_own_images(metered_once: TinyDataset) -> None:
    knowledge, frames = exposed_frames(metered_once.folder, run=1)
    ours, theirs = list(frames), stored_frames(metered_once.folder)
    assert exposed_ms(ours[0]) == FIRST_MS
    for before, after in pairwise(ours):
        expected = METER.next_ms(exposed_ms(before), at_850(before), knowledge.detector)
        assert exposed_ms(after) == expected
    # Its noise is another, its light is the same: the metered level moves by a DN or two.
    assert exposed_ms(ours[1]) == pytest.approx(exposed_ms(theirs[1]), rel=0.02)


# Without light


def world(**table: object) -> World:
    return world_of(
        Scenario.model_validate({"name": "x", "exposure": table, "motion": {"end_s": 1.0}})
    )


def shifted(prior: PosePrior | None) -> PosePrior:
    assert prior is not None
    pose = prior.cam_from_target
    farther = RigidTransform(pose.rotation, pose.translation + np.array([0.0, 0.0, 0.5]))
    return replace(prior, cam_from_target=farther)


def nobody(frame: int) -> np.ndarray:
    raise AssertionError(f"asked for the image of frame {frame}")


def test_fixed_and_planned_exposures_need_no_image() -> None:
    fixed = world(mode="fixed", exposure_ms=3.5)
    prior = fixed.onboard(0).prior
    control = ExposureControl(fixed, prior)
    assert {control.entry(k, nobody).exposure_ms for k in range(6)} == {3.5}
    planned = ExposureControl(world(), prior)
    assert planned.entry(5, nobody).exposure_ms == world().plan.before_any_image(1.0, prior)


def test_only_the_plan_rests_on_the_prior() -> None:
    for mode in ("fixed", "auto"):
        known = world(mode=mode)
        prior = known.onboard(0).prior
        assert known.frame_entries(prior) == known.frame_entries(shifted(prior))
    prior = world().onboard(0).prior
    assert world().frame_entries(prior) != world().frame_entries(shifted(prior))


def test_metering_asks_for_each_image_once_and_in_order() -> None:
    metered = world(mode="auto")
    control = ExposureControl(metered, metered.onboard(0).prior)
    asked_for: list[int] = []

    def dark(frame: int) -> np.ndarray:
        asked_for.append(frame)
        return np.full((8, 8), 100, dtype=np.uint16)

    assert [control.entry(k, dark).exposure_ms for k in (0, 3, 2)] == [1.0, 8.0, 4.0]
    assert asked_for == [0, 1, 2]
    assert [entry.time_s for entry in control.entries] == metered.scenario.times_s[:4]


def test_a_record_is_taken_up_to_the_first_row_that_is_not_of_this_run() -> None:
    metered = world(mode="auto")
    prior = metered.onboard(0).prior
    good = [FrameEntry(0, 0.0, 1.0), FrameEntry(1, 0.2, 1.5), FrameEntry(2, 0.4, 0.9)]
    for rows, taken in (
        (good, 3),
        ([replace(good[0], exposure_ms=2.0), *good[1:]], 1),  # another first exposure
        ([good[0], replace(good[1], time_s=0.25), good[2]], 1),
        ([good[0], good[2]], 1),
        ([*good, *(FrameEntry(k, k / 5.0, 1.0) for k in range(3, 9))], 6),
        ([], 1),
    ):
        control = ExposureControl(metered, prior)
        control.resume(rows)
        assert len(control.entries) == taken
        assert control.entries == [good[0], *rows[1:taken]]
