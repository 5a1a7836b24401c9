"""Another run of the same light is composed from the store: its own noise, its own prior."""

from __future__ import annotations

import json

import numpy as np
import pytest

from models.dataset.dataset import read_frames, read_knowledge
from models.errors import DatasetError
from renders.batches.replay import compose, exposed_frames, read_groups
from tests.renders.conftest import TinyDataset
from tests.support.small_scenes import run_python


def test_run_0_is_the_dataset_itself_bit_for_bit(rendered_once: TinyDataset) -> None:
    knowledge, frames = exposed_frames(rendered_once.folder, run=0)
    replayed, stored = list(frames), list(read_frames(rendered_once.folder))
    assert len(replayed) == len(stored) == 2
    for ours, theirs in zip(replayed, stored, strict=True):
        np.testing.assert_array_equal(ours.image_800, theirs.image_800)
        np.testing.assert_array_equal(ours.image_850, theirs.image_850)
        assert (ours.index, ours.time_s) == (theirs.index, theirs.time_s)
        assert ours.exposure_ms == theirs.exposure_ms
    prior = read_knowledge(rendered_once.folder).prior
    np.testing.assert_allclose(knowledge.prior.matrix(), prior.matrix(), atol=1e-12)


def test_another_run_has_other_noise_and_another_prior_and_is_repeatable(
    rendered_once: TinyDataset,
) -> None:
    (first, frames), (again, frames_again) = (
        exposed_frames(rendered_once.folder, run=1) for _ in range(2)
    )
    stored = read_knowledge(rendered_once.folder).prior
    assert not np.allclose(first.prior.matrix(), stored.matrix(), atol=1e-6)
    np.testing.assert_array_equal(first.prior.matrix(), again.prior.matrix())
    theirs = list(read_frames(rendered_once.folder))
    for ours, same, other in zip(frames, frames_again, theirs, strict=True):
        np.testing.assert_array_equal(ours.image_850, same.image_850)
        assert (ours.image_850 != other.image_850).mean() > 0.3  # many lie at the bias in both
        assert ours.exposure_ms != other.exposure_ms  # its own prior sets its exposures
        assert ours.time_s == other.time_s


def test_the_two_bands_have_noise_of_their_own(rendered_once: TinyDataset) -> None:
    """Sunlight is one in both: what differs beside the lamps is drawn for each exposure."""
    world = rendered_once.world
    light = json.loads((rendered_once.folder / "truth" / "light.json").read_text())["exposures"]
    exposure = world.exposures[1]
    groups = read_groups(rendered_once.store, world, world.exposures[1], light["000000_850"])
    assert groups is not None
    image = compose(world, groups, exposure, 1.0, run=0)
    other = compose(world, groups, world.exposures[0], 1.0, run=0)
    assert (image != other).mean() > 0.3


def test_a_frame_is_lit_by_its_sun_and_the_lamps_of_its_band(rendered_once: TinyDataset) -> None:
    world = rendered_once.world
    assert [group.name for group in world.lit_by(world.exposures[0])] == ["sun_S2", "lamps_800"]
    assert [group.name for group in world.lit_by(world.exposures[1])] == ["sun_S2", "lamps_850"]


def test_replaying_loads_no_renderer(rendered_once: TinyDataset) -> None:
    program = (
        "import sys\n"
        "from pathlib import Path\n"
        "from renders.batches.replay import exposed_frames\n"
        f"_, frames = exposed_frames(Path({str(rendered_once.folder)!r}), run=2)\n"
        "print(next(frames).image_850.mean())\n"
        "print(sorted({'mitsuba', 'drjit'} & set(sys.modules)))\n"
    )
    done = run_python(program, rendered_once.folder)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "[]"


def test_light_that_has_left_the_store_is_told(tiny: TinyDataset) -> None:
    light = json.loads((tiny.folder / "truth" / "light.json").read_text())["exposures"]
    tiny.store.path(light["000001_800"]["sun_S2"]).unlink()
    _, frames = exposed_frames(tiny.folder, run=1)
    next(frames)
    with pytest.raises(DatasetError, match="light of frame 1 at 800 nm"):
        next(frames)


@pytest.mark.parametrize("text", [None, "not json", "[]", '{"exposures": {}}'])
def test_a_record_of_light_that_is_not_one_is_told(tiny: TinyDataset, text: str | None) -> None:
    path = tiny.folder / "truth" / "light.json"
    path.unlink() if text is None else path.write_text(text)
    with pytest.raises(DatasetError, match="expected the light's keys at"):
        exposed_frames(tiny.folder, run=1)
