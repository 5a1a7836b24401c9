"""Another run of the same light is composed from the store: its own noise, its own prior."""

from __future__ import annotations

import json

import numpy as np
import pytest

from models.arrays import Floats
from models.dataset.dataset import open_dataset
from models.errors import DatasetError
from models.onboard import OnboardKnowledge
from renders.batches.replay import compose, exposed_frames, read_groups
from tests.renders.conftest import TinyDataset
from tests.support.frame_images import at_800, at_850, exposed_ms, stored_frames
from tests.support.small_scenes import run_python


def first_pose(onboard: OnboardKnowledge) -> Floats:
    assert onboard.prior is not None
    return onboard.prior.cam_from_target.matrix()


def stored_pose(dataset: TinyDataset) -> Floats:
    return first_pose(open_dataset(dataset.folder).onboard)


def test_run_0_is_the_dataset_itself_bit_for_bit(rendered_once: TinyDataset) -> None:
    onboard, frames = exposed_frames(rendered_once.folder, run=0)
    replayed, stored = list(frames), stored_frames(rendered_once.folder)
    assert len(replayed) == len(stored) == 2
    for ours, theirs in zip(replayed, stored, strict=True):
        np.testing.assert_array_equal(at_800(ours), at_800(theirs))
        np.testing.assert_array_equal(at_850(ours), at_850(theirs))
        assert (ours.index, ours.time_s) == (theirs.index, theirs.time_s)
        assert exposed_ms(ours) == exposed_ms(theirs)
    np.testing.assert_allclose(first_pose(onboard), stored_pose(rendered_once), atol=1e-12)


def test_another_run_has_other_noise_and_another_prior_and_is_repeatable(
    rendered_once: TinyDataset,
) -> None:
    (first, frames), (again, frames_again) = (
        exposed_frames(rendered_once.folder, run=1) for _ in range(2)
    )
    assert not np.allclose(first_pose(first), stored_pose(rendered_once), atol=1e-6)
    np.testing.assert_array_equal(first_pose(first), first_pose(again))
    theirs = stored_frames(rendered_once.folder)
    for ours, same, other in zip(frames, frames_again, theirs, strict=True):
        np.testing.assert_array_equal(at_850(ours), at_850(same))
        assert (at_850(ours) != at_850(other)).mean() > 0.3  # many lie at the bias in both
        assert exposed_ms(ours) != exposed_ms(other)  # its own prior sets its exposures
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
        "print(next(frames).image('image_850').image.mean())\n"
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
