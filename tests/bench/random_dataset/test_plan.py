"""A dataset as drawn: which pose is whose, what is split how, and what a part's scenario says."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from bench.random_dataset.plan import SPLITS, Plan, make_plan, part_of_pose, splits_of
from models.errors import ScenarioError
from models.motion.pose_table import pose_table
from tests.support.random_specs import spec_of

HERE = Path("spec.toml")
CAMERAS = [
    {"name": "wide", "width": 64},
    {"name": "own", "width": 64, "height": 48, "fov_deg": 20.0, "range_factor": 2.0},
]
TARGETS = [{"spacecraft": "hispasat", "range_m": [30.0, 50.0]}, {"spacecraft": "xmm"}]


@pytest.fixture(scope="module")
def plan() -> Plan:
    spec = spec_of(
        frames=78,
        suns_per_pose=3,
        exposures_per_sun=2,
        target=TARGETS,
        camera=CAMERAS,
        background={"space": 1.0, "stars": 1.0, "earth": 1.0},
        vary={"specimens": 2, "diffuse": 0.2, "psf_sigma_px": [0.3, 0.9]},
    )
    return make_plan(spec, HERE)


def test_each_frame_is_there_once_and_parts_share_poses_evenly(plan: Plan) -> None:
    assert [shot.number for shot in plan.shots] == list(range(78))
    assert len(plan.parts) == 8
    poses = Counter(shot.part for shot in plan.shots[::6])
    assert sum(poses.values()) == 13
    assert max(poses.values()) - min(poses.values()) <= 1
    for part in plan.used:
        assert [shot.frame for shot in plan.of_part(part)] == list(range(len(plan.of_part(part))))


def test_suns_and_exposures_of_a_pose_are_crossed(plan: Plan) -> None:
    for pose in {shot.pose_number for shot in plan.shots}:
        own = [shot for shot in plan.shots if shot.pose_number == pose]
        assert len({tuple(shot.sun_dir_in_target) for shot in own}) == 3
        assert len({shot.exposure_ms for shot in own}) == 6
        assert len({id(shot.pose) for shot in own}) == 1


def test_splits_share_no_pose_and_have_their_shares() -> None:
    spec = spec_of(frames=1000, split={"train": 0.7, "val": 0.2, "test": 0.1, "seed": 5})
    splits = splits_of(spec)
    assert Counter(splits) == {"train": 140, "val": 40, "test": 20}
    assert splits_of(spec_of(frames=1000)) != splits
    assert set(splits_of(spec_of(split={"train": 0.0, "val": 0.0, "test": 1.0}))) == {"test"}


def test_frames_of_a_pose_are_all_of_one_split(plan: Plan) -> None:
    poses = {split: {s.pose_number for s in plan.shots if s.split == split} for split in SPLITS}
    assert sum(map(len, poses.values())) == 13
    assert set().union(*poses.values()) == set(range(13))


def test_more_frames_of_the_same_seed_begin_with_the_same(plan: Plan) -> None:
    longer = make_plan(plan.spec.model_copy(update={"frames": 120}), HERE)
    for one, other in zip(plan.shots, longer.shots, strict=False):
        assert (one.part, one.frame, one.exposure_ms) == (
            other.part,
            other.frame,
            other.exposure_ms,
        )
        np.testing.assert_array_equal(one.sun_dir_in_target, other.sun_dir_in_target)
        np.testing.assert_array_equal(
            one.pose.cam_from_target.matrix(), other.pose.cam_from_target.matrix()
        )


def test_a_parts_scenario_says_what_was_drawn(plan: Plan) -> None:
    for part in plan.used:
        scenario, shots = plan.scenario(part), plan.of_part(part)
        assert scenario.motion.table is not None
        table = pose_table(scenario.motion.table, "here")
        assert len(table) == len(shots)
        for row, shot in enumerate(shots):
            drawn = shot.pose.cam_from_target.matrix()
            np.testing.assert_allclose(table.poses[row].matrix(), drawn, atol=1e-12)
            assert table.sun_dirs_in_target is not None
            np.testing.assert_allclose(table.sun_dirs_in_target[row], shot.sun_dir_in_target)
            assert table.stars is not None
            assert table.stars[row] == (shot.pose.background == "stars")
            assert table.earth_dirs_in_target is not None
            has_earth = table.earth_dirs_in_target[row].any()
            assert has_earth == (shot.pose.background == "earth")
        low, high = (30.0, 50.0) if part.target.spacecraft == "hispasat" else (10.0, 80.0)
        factor = 2.0 if part.choice.name == "own" else 1.0
        for shot in shots:
            assert factor * low <= shot.pose.range_m <= factor * high


def test_specimens_differ_in_surfaces_lens_and_noise(plan: Plan) -> None:
    scenarios = [plan.scenario(part) for part in plan.used]
    assert len({scenario.optics.psf_sigma_px for scenario in scenarios}) == len(scenarios)
    assert len({scenario.exposure.noise_seed for scenario in scenarios}) == len(scenarios)
    assert len({scenario.render.seed for scenario in scenarios}) == len(scenarios)
    assert len({scenario.surface for scenario in scenarios}) == len(scenarios)
    assert all(0.3 <= scenario.optics.psf_sigma_px <= 0.9 for scenario in scenarios)
    assert all(each.specular == 1.0 for scenario in scenarios for each in scenario.surface or ())


def test_what_was_drawn_of_a_part_does_not_depend_on_other_parts() -> None:
    spec = spec_of(frames=40, suns_per_pose=1, target=TARGETS)
    order = [part_of_pose(spec, 2, number) for number in range(40)]
    assert all(set(order[k : k + 2]) == {0, 1} for k in range(0, 40, 2))
    assert order != sorted(order)


def test_folders_have_names_of_their_own_and_are_not_too_long() -> None:
    names = [{"spacecraft": "hispasat"}, {"spacecraft": "somewhere/hispasat"}]
    with pytest.raises(ScenarioError, match="name folders of their own"):
        make_plan(spec_of(target=names), HERE)
    with pytest.raises(ScenarioError, match=r"more vary\.specimens"):
        make_plan(spec_of(frames=60_000), HERE)


def test_a_spacecraft_that_there_is_not_is_told_with_the_specification() -> None:
    with pytest.raises(ScenarioError, match=r"spec\.toml: expected a spacecraft among .*'xmn'"):
        make_plan(spec_of(target=[{"spacecraft": "xmn"}]), HERE)


def test_a_scenario_that_cannot_be_is_told_with_the_specification() -> None:
    spec = spec_of(
        images="pairs",
        exposure={"exposure_ms": [40.0, 50.0]},
        frames=5,
        target=[{"spacecraft": "maxar1300"}],
    )
    plan = make_plan(spec, HERE)
    with pytest.raises(ScenarioError, match=r"spec\.toml: maxar1300-wide.*pair_gap_ms"):
        plan.scenario(plan.parts[0])
