"""A simulation that is steered gives the batch's frames where it is steered as the batch moves."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.errors import ScenarioError
from models.frame import CHASER_ORBIT, Frame, ImageReading, TableReading
from models.pose import RigidTransform
from renders.batches.replay import exposed_frames
from renders.batches.stepping import Simulation
from renders.scenario.scenario import Scenario
from tests.renders.conftest import TinyDataset, TinyTumble
from tests.support.frame_images import at_800, at_850, single, stored_frames
from tests.support.tumble_scenario import tumble_table


def simulation_of(dataset: TinyDataset, run: int = 0, **options: Any) -> Simulation:
    """Return the simulation of a dataset's case; the store that it is given is empty."""
    asked = dataset.request
    return Simulation(
        asked.case,
        run,
        start_s=asked.start_s,
        end_s=asked.end_s,
        width=asked.width,
        spp=asked.spp,
        store=dataset.folder.parent / "no_store",
        **options,
    )


def same(ours: Frame, theirs: Frame) -> None:
    assert (ours.index, ours.time_s) == (theirs.index, theirs.time_s)
    assert list(ours.readings) == list(theirs.readings)
    for name, reading in ours.readings.items():
        other = theirs.readings[name]
        assert type(reading) is type(other)
        assert np.array_equal(reading.time_s, other.time_s)
        if isinstance(reading, ImageReading) and isinstance(other, ImageReading):
            assert reading.exposure_ms == other.exposure_ms
            np.testing.assert_array_equal(reading.image, other.image)
        if isinstance(reading, TableReading) and isinstance(other, TableReading):
            np.testing.assert_array_equal(reading.rows, other.rows)


def test_fed_the_batchs_poses_it_gives_the_batchs_pairs(rendered_once: TinyDataset) -> None:
    simulation = simulation_of(rendered_once)
    poses = rendered_once.world.trajectory.cam_from_target
    for theirs in stored_frames(rendered_once.folder):
        same(simulation.frame(theirs.time_s, poses), theirs)


def test_a_pose_that_holds_is_that_of_both_exposures(rendered_once: TinyDataset) -> None:
    """At the pose of the 850 nm exposure, its image is the batch's and the other's is not."""
    simulation = simulation_of(rendered_once)
    (theirs, _) = stored_frames(rendered_once.folder)
    pose = rendered_once.world.trajectory.cam_from_target(theirs.time_s)
    ours = simulation.frame(theirs.time_s, pose)
    np.testing.assert_array_equal(at_850(ours), at_850(theirs))
    assert not np.array_equal(at_800(ours), at_800(theirs))


def test_fed_the_batchs_poses_it_gives_the_batchs_images(tumbled_once: TinyTumble) -> None:
    simulation = simulation_of(tumbled_once)
    for theirs in stored_frames(tumbled_once.folder):
        same(simulation.frame(theirs.time_s, tumbled_once.motion.cam_from_target), theirs)


def test_another_run_meters_and_draws_as_a_replayed_one(
    tumbled: TinyTumble, tmp_path: Path
) -> None:
    table = tumble_table(
        exposure={"mode": "auto", "exposure_ms": 1e3, "max_ms": 4e4},
        stars={"shine": True},
        optics={"f_number": 4.0, "focus_m": 20.0},
        sun={"default": "0.1,0.2,1.0", "shared": ["1,0,0"]},
    )
    case, out = tmp_path / "auto.toml", tmp_path / "auto"
    case.write_text(Scenario.model_validate(table).to_toml())
    metered = TinyTumble(replace(tumbled.request, case=str(case), out=out, seeds=2))
    metered.render()
    onboard, frames = exposed_frames(out, run=1)
    simulation = simulation_of(metered, run=1)
    assert simulation.onboard.camera == onboard.camera
    exposures = set()
    for theirs in frames:
        ours = simulation.frame(theirs.time_s)  # the scenario's own motion
        same(ours, theirs)
        exposures.add(ours.image("image").exposure_ms)
    assert len(exposures) == 3


def test_the_sun_and_the_exposure_may_be_told(tumbled_once: TinyTumble) -> None:
    """Behind the target the Sun lights what the camera does not see; twice as long is twice."""
    pose = tumbled_once.motion.cam_from_target(0.0)
    boresight = pose.inverse().rotate([0.0, 0.0, 1.0])
    before = pose.inverse().rotate([1.0, 0.0, -1.0])  # from aside: no foil mirrors it into the lens
    means = {}
    for name, sun, exposure_ms in (
        ("before", before, 0.0005),
        ("longer", before, 0.001),
        ("behind", boresight, 0.0005),
    ):
        simulation = simulation_of(tumbled_once)
        frame = simulation.frame(0.0, pose, sun_dir_in_target=sun, exposure_ms=exposure_ms)
        assert frame.image("image").exposure_ms == exposure_ms
        means[name] = float(single(frame).mean()) - 100.0  # the bias
    assert means["longer"] == pytest.approx(2.0 * means["before"], rel=0.05)
    assert means["behind"] < 0.5 * means["before"]


def test_what_cannot_be_is_refused_and_the_simulation_goes_on(tumbled_once: TinyTumble) -> None:
    simulation = simulation_of(tumbled_once)
    frames = stored_frames(tumbled_once.folder)
    same(simulation.frame(frames[0].time_s), frames[0])
    inside = RigidTransform(np.eye(3), np.array([0.0, 0.0, 0.5]))
    refused: list[tuple[dict[str, Any], str]] = [
        ({"time_s": 0.0}, "expected time_s after the frame before"),
        ({"time_s": float("nan")}, "expected time_s after the frame before"),
        ({"time_s": 101.0}, "expected a time between 0 and 100 s"),
        ({"cam_from_target": inside}, "expected the camera outside xmm"),
        ({"cam_from_target": lambda time_s: None}, "expected a RigidTransform"),
        ({"sun_dir_in_target": [0.0, 0.0, 0.0]}, "expected a Sun direction with a length"),
        ({"exposure_ms": 0.0}, "expected exposure_ms from"),
    ]
    for options, said in refused:
        with pytest.raises(ScenarioError, match=said):
            simulation.frame(**({"time_s": frames[1].time_s} | options))
    same(simulation.frame(frames[1].time_s), frames[1])
    with pytest.raises(ScenarioError, match="expected run as a whole number"):
        simulation_of(tumbled_once, run=-1)
    assert not (tumbled_once.folder.parent / "no_store").exists()  # none is put there


def test_table_readings_are_of_the_frame(tumbled_once: TinyTumble) -> None:
    """Whatever number of frames came before, a reading has the frame's own time."""
    simulation = simulation_of(tumbled_once)
    frame = simulation.frame(12.5)
    assert frame.table(CHASER_ORBIT).time_s == [12.5]
