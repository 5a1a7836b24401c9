"""A tumbling target from scenario to dataset: whole, resumable, and lit from where the Sun is."""

from __future__ import annotations

import json
import shutil
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tomli_w
import trimesh

from models.dataset.dataset import open_dataset
from models.errors import DatasetError, ScenarioError
from models.frame import CHASER_ORBIT, Frame
from models.spacecraft.part import Part, Spacecraft
from renders.batches.dataset_writer import image_path
from renders.batches.render_case import exposure_note
from renders.batches.replay import exposed_frames, light_held
from renders.scenario.scenario import Scenario
from renders.store.sealed_exr import read_exr
from renders.truth.exposure_truth import read_part_names
from renders.truth.image_truth import read_image_truths
from renders.world.bodies import Bodies
from renders.world.build import world_of
from renders.world.exposure import FILTERED
from tests.renders.conftest import TinyTumble
from tests.support.frame_images import exposed_ms, single, stored_frames
from tests.support.small_scenes import LAMBERT, activate_best
from tests.support.tumble_scenario import TUMBLE, tumble_table

FRAMES = 3
TWO_PIXELS_M = 0.9  # at 30 m and 64 columns, on a surface aslant by 45 deg


# What is there


def test_every_file_is_there_and_no_other(tumbled_once: TinyTumble) -> None:
    names = [f"{frame:06d}" for frame in range(FRAMES)]
    public = ["camera.toml", "dataset.json", "detector.toml", "frames.csv", "knowledge.toml"]
    public += ["navigation.csv", "wireframe.json", *(f"frames/{name}.png" for name in names)]
    sealed = ["exposures.jsonl", "light.json", "parts.json", "scenario.toml"]
    sealed += [f"labels/{name}.png" for name in names] + [f"geometry/{name}.exr" for name in names]
    found = {name for name in tumbled_once.files() if not name.startswith("truth/exposures/")}
    assert found == {*public, *(f"truth/{name}" for name in sealed)}


def test_the_public_half_reads_back_as_what_is_known_on_board(tumbled_once: TinyTumble) -> None:
    folder, world = tumbled_once.folder, tumbled_once.world
    dataset = open_dataset(folder)
    info = dataset.info
    assert info.chain == "tumble_images"
    assert (info.case, info.frames, info.target) == ("small-tumble", FRAMES, "xmm")
    assert info.sun == "0.1,0.2,1.0"
    assert dataset.onboard.camera == world.camera
    frames = list(dataset.frames())
    assert [frame.time_s for frame in frames] == [0.0, 50.0, 100.0]
    assert [len(frame.table(CHASER_ORBIT).rows) for frame in frames] == [1] * FRAMES
    assert [exposed_ms(frame) for frame in frames] == [4.0 / 32**2] * FRAMES


def test_the_public_half_tells_no_pose(tumbled_once: TinyTumble) -> None:
    """Of the motion only what the chaser believes of its own orbit, not where the target is."""
    public = b"".join(
        data for name, data in tumbled_once.files().items() if not name.startswith("truth")
    )
    for truth in read_image_truths(tumbled_once.folder).values():
        numbers = [*truth.cam_from_target.translation, *truth.cam_from_target.rotation.ravel()]
        numbers += [*truth.chaser.position_in_inertial, *truth.chaser.velocity_in_inertial]
        for number in numbers:
            if abs(number) > 1e-6 and number not in (1.0, -1.0, 0.0):
                assert repr(float(number)).encode() not in public
    assert b"omega" not in public
    assert b"rho" not in public


def test_the_truth_is_the_motion(tumbled_once: TinyTumble) -> None:
    world, truths = tumbled_once.world, read_image_truths(tumbled_once.folder)
    assert list(truths) == [0, 1, 2]
    for exposure in world.exposures:
        truth = truths[exposure.frame]
        pose = tumbled_once.motion.cam_from_target(exposure.time_s)
        np.testing.assert_allclose(truth.cam_from_target.matrix(), pose.matrix(), atol=1e-12)
        points = tumbled_once.landmarks
        np.testing.assert_allclose(truth.landmarks_px, world.camera.project(pose @ points))
        assert 4 <= truth.landmarks_visible.sum() < len(points)
        np.testing.assert_allclose(np.linalg.norm(truth.sun_dir_in_target), 1.0)


def test_landmarks_are_seen_where_nothing_lies_before_them(tumbled_once: TinyTumble) -> None:
    """The depth of the pixels around tells, too: somewhere near it is open, or something nearer."""
    parts = read_part_names(tumbled_once.folder)
    points = tumbled_once.landmarks
    told = []
    for frame, truth in read_image_truths(tumbled_once.folder).items():
        if frame == 0:  # the wings are seen edge-on: thinner than a pixel, they hide corners
            continue
        geometry = read_exr(tumbled_once.folder / "truth" / "geometry" / f"{frame:06d}.exr")
        assert geometry is not None
        depth = (truth.cam_from_target @ points)[:, 2]
        places = np.rint(truth.landmarks_px).astype(int)
        for (u, v), z, seen in zip(places, depth, truth.landmarks_visible, strict=True):
            near = geometry["Z"][v - 2 : v + 3, u - 2 : u + 3]
            if seen:
                assert (near == 0.0).any() or near.max() > z - TWO_PIXELS_M
            else:
                assert near[near > 0.0].min() < z + TWO_PIXELS_M
            told.append(bool(seen))
        labels = np.unique(geometry["label"])
        assert len(labels) >= 4
        assert labels.max() <= len(parts)
    assert 0.2 < np.mean(told) < 0.9


def test_space_is_dark_and_the_craft_is_lit(tumbled_once: TinyTumble) -> None:
    detector = tumbled_once.world.scenario.simulated_detector
    for frame in stored_frames(tumbled_once.folder):
        geometry = read_exr(tumbled_once.folder / "truth" / "geometry" / f"{frame.index:06d}.exr")
        assert geometry is not None
        craft = geometry["label"] > 0
        assert np.median(single(frame)[~craft]) == pytest.approx(detector.bias_dn, abs=1.0)
        lit = single(frame)[craft] > detector.bias_dn + 5.0 * detector.noise_dn(np.array(100.0))
        assert lit.mean() > 0.5


# Again


def test_nothing_is_done_twice(tumbled: TinyTumble, traced: Callable[[], int]) -> None:
    before = tumbled.files()
    assert "3 images at 64 x 64" in (said := tumbled.render())
    assert "3 of 3 exposures are there already" in said
    assert traced() == 0
    assert tumbled.files() == before


def test_what_was_lost_comes_back_bit_by_bit(
    tumbled: TinyTumble, traced: Callable[[], int]
) -> None:
    before = tumbled.files()
    image_path(tumbled.folder, 1, FILTERED).unlink()
    (tumbled.folder / "truth" / "labels" / "000002.png").unlink()
    (tumbled.folder / "truth" / "exposures.jsonl").unlink()
    tumbled.render()
    assert tumbled.files() == before
    assert traced() == 0  # the light of each is in the store
    light = json.loads((tumbled.folder / "truth" / "light.json").read_text())["exposures"]
    assert sorted(light) == ["000000", "000001", "000002"]
    assert len({key for keys in light.values() for key in keys.values()}) == 2 * FRAMES
    shutil.rmtree(tumbled.store.folder)
    shutil.rmtree(tumbled.folder / "frames")
    tumbled.render()
    assert traced() == FRAMES
    assert tumbled.files() == before


def test_metered_exposures_follow_from_the_image_before(tumbled: TinyTumble) -> None:
    table = tumble_table(
        exposure={"mode": "auto", "exposure_ms": 1.0, "percentile": 98.0, "max_ms": 40.0}
    )
    case = tumbled.folder.parent / "auto.toml"
    case.write_text(Scenario.model_validate(table).to_toml())
    out = tumbled.folder.parent / "auto"
    metered = TinyTumble(replace(tumbled.request, case=str(case), out=out))
    metered.render()
    times = [exposed_ms(frame) for frame in stored_frames(out)]
    assert times[0] == 1.0 / 32**2
    assert times[1] == times[0] * 2.0  # 1 us at f/16: too dark by far more than one step
    before = metered.files()
    image_path(out, 2, FILTERED).unlink()
    metered.render()
    assert metered.files() == before


# Other runs


def same_readings(ours: Frame, theirs: Frame) -> None:
    np.testing.assert_array_equal(single(ours), single(theirs))
    for of in (Frame.image, Frame.table):
        names = ("time_s", "exposure_ms") if of is Frame.image else ("time_s", "rows")
        stream = "image" if of is Frame.image else CHASER_ORBIT
        for name in names:
            np.testing.assert_array_equal(
                getattr(of(ours, stream), name), getattr(of(theirs, stream), name)
            )


def test_run_0_is_the_dataset_itself(tumbled_once: TinyTumble) -> None:
    onboard, frames = exposed_frames(tumbled_once.folder, run=0)
    stored = open_dataset(tumbled_once.folder)
    assert onboard.camera == stored.onboard.camera
    for ours, theirs in zip(frames, stored.frames(), strict=True):
        assert (ours.index, ours.time_s) == (theirs.index, theirs.time_s)
        assert ours.readings.keys() == theirs.readings.keys()
        same_readings(ours, theirs)


def test_another_run_has_other_noise_in_image_and_navigation(
    tumbled: TinyTumble, traced: Callable[[], int]
) -> None:
    """``--seeds`` brings back the light of all frames; then no run renders."""
    case = tumbled.folder.parent / "rough.toml"
    table = tumble_table(calibration={"sigma_focal_px": 0.5})
    case.write_text(Scenario.model_validate(table).to_toml())
    out = tumbled.folder.parent / "rough"
    rough = TinyTumble(replace(tumbled.request, case=str(case), out=out, seeds=2))
    rough.render()
    (onboard, frames), (_, again) = (exposed_frames(out, run=1) for _ in range(2))
    stored = open_dataset(out)
    assert onboard.camera != stored.onboard.camera
    with light_held(out):
        for ours, same, other in zip(frames, again, stored.frames(), strict=True):
            same_readings(ours, same)
            assert (single(ours) != single(other)).mean() > 0.3
            off_m = ours.table(CHASER_ORBIT).rows - other.table(CHASER_ORBIT).rows
            assert 0.0 < np.abs(off_m[0, :3]).max() < 10.0 * 5.0 * np.sqrt(2.0)  # five sigma
            assert exposed_ms(ours) == exposed_ms(other)
    assert traced() == 0  # the light is that of the other case, whose calibration was exact


def test_light_that_has_left_is_told_and_seeds_bring_it_back(tumbled: TinyTumble) -> None:
    shutil.rmtree(tumbled.store.folder)
    with pytest.raises(DatasetError, match="expected the light of frame 0 in"):
        next(exposed_frames(tumbled.folder, run=1)[1])
    TinyTumble(replace(tumbled.request, seeds=2)).render()
    assert len(list(exposed_frames(tumbled.folder, run=1)[1])) == FRAMES


def test_typed_exposures_are_linear_between_their_instants(tumbled: TinyTumble) -> None:
    table = tumble_table(exposure={"schedule_ms": [[0.0, 4.0], [80.0, 12.0]]})
    case = tumbled.folder.parent / "typed.toml"
    case.write_text(Scenario.model_validate(table).to_toml())
    out = tumbled.folder.parent / "typed"
    TinyTumble(replace(tumbled.request, case=str(case), out=out)).render()
    native_ms = [32.0**2 * exposed_ms(frame) for frame in stored_frames(out)]
    assert native_ms == pytest.approx([4.0, 9.0, 12.0])  # at 0, 50 and 100 s: beyond, as at 80


# Refusals


def test_what_needs_another_sky_is_refused(tumbled: TinyTumble) -> None:
    before = tumbled.files()
    for options, said in (({"sun": "S2"}, "in the inertial frame"),):
        with pytest.raises(ScenarioError, match=said):
            TinyTumble(replace(tumbled.request, **options)).render()  # type: ignore[arg-type]
    assert tumbled.files() == before


def test_which_setting_differs_is_told(tumbled: TinyTumble, tmp_path: Path) -> None:
    table = tomllib.loads(Path(tumbled.request.case).read_text())
    table["optics"] = {**table.get("optics", {}), "psf_sigma_px": 0.77}
    case = tmp_path / Path(tumbled.request.case).name
    case.write_text(tomli_w.dumps(table))
    with pytest.raises(DatasetError, match=r"with optics\.psf_sigma_px \S+, now 0\.77\)"):
        TinyTumble(replace(tumbled.request, case=str(case))).render()


@pytest.mark.parametrize(
    ("mode", "width", "told"), [("fixed", 64, "1024 times"), ("fixed", 0, ""), ("schedule", 64, "")]
)
def test_what_a_typed_exposure_comes_to_at_another_width_is_told(
    mode: str, width: int, told: str
) -> None:
    """Of pixels 32 times as wide an exposure of 2 s is 32^2 times shorter."""
    table = tumble_table(exposure={"mode": mode, "exposure_ms": 2048.0})
    table["camera"] = {"preset": "chaser_fixed", "width": width or 2048}
    note = exposure_note(Scenario.model_validate(table))
    assert ("2 ms for these, 32 times as wide" in note) == bool(told)
    assert bool(note) == bool(told)


def test_a_folder_of_pairs_is_left_alone(tumbled: TinyTumble) -> None:
    before = tumbled.files()
    pairs = TinyTumble(replace(tumbled.request, case="maxar-demo", width=64))
    with pytest.raises(DatasetError, match="it holds another \\(small-tumble"):
        pairs.render()
    assert tumbled.files() == before


# Light


def matt_ball() -> Spacecraft:
    """Return a target that looks the same however it turns."""
    ball = trimesh.creation.icosphere(subdivisions=4, radius=3.0)
    return Spacecraft("ball", (Part("ball", ball, LAMBERT, smooth=True),), None, np.zeros(3))


def test_a_balls_lit_side_faces_the_sun_however_fast_it_turns(tmp_path: Path) -> None:
    """The light's centroid lies off the ball's centre towards the Sun's place in the image.

    At phase angle a, a Lambert ball's picture has its centroid on the line of the Sun's direction
    as the camera sees it; the ball turns by 31 deg a step, the orbit by 3.
    """
    activate_best()
    from renders.batches.studio import Studio
    from renders.store.light_keys import LightKeys
    from renders.store.radiance_store import RadianceStore

    table = tumble_table(
        earth={"shines": False}, sun={"default": "-0.6,-0.3,0.5"}, tumble={**TUMBLE}
    )
    craft = world_of(Scenario.model_validate(table))
    world = replace(craft, bodies=Bodies(matt_ball, craft.optics))
    assert craft.absolute is not None
    orbit = craft.absolute.tumble.orbit
    studio = Studio(world, RadianceStore(tmp_path / "none"), LightKeys(world, "jit"), None)
    for exposure in world.exposures:
        pose = world.trajectory.cam_from_target(exposure.time_s)
        groups = world.lit_by(exposure)
        image = studio.trace(exposure, pose, groups)[groups[0].name]
        v, u = np.mgrid[0:64, 0:64]
        centroid = np.array([(u * image).sum(), (v * image).sum()]) / image.sum()
        towards = centroid - world.camera.project(pose.translation)
        sun_in_lvlh = orbit.inertial_from_lvlh(exposure.time_s).T @ np.array(
            world.sun.direction_in_target
        )
        # The camera's x is -z of the local frame, its y is -x (see models.motion.tumble).
        expected = np.array([-sun_in_lvlh[2], -sun_in_lvlh[0]])
        cosine = towards @ expected / np.linalg.norm(towards) / np.linalg.norm(expected)
        assert np.rad2deg(np.arccos(cosine)) < 4.0  # 13 pixels across, 4 samples each
        assert np.linalg.norm(towards) > 1.0
