"""The arm in pictures: it hides markers, throws a shadow, and is the same in any order."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.arrays import Radiance
from renders.batches.studio import Studio
from renders.scenario.scenario import Scenario
from renders.store.light_keys import LightKeys
from renders.store.radiance_store import RadianceStore
from renders.truth.exposure_truth import ExposureTruth
from renders.truth.part_names import CHASER_LABEL, MARKER_LABEL
from renders.world.build import world_of
from renders.world.exposure import Exposure
from renders.world.world import World
from tests.support.small_scenes import needs_jit

WIDTH = 96
HIDES_S = 262.5  # the upper arm passes before #2
STOWED_S, THERE_S = 200.0, 330.0


def small(**tables: Any) -> World:
    table: dict[str, Any] = {
        "name": "armed",
        "arm": {},
        "camera": {"width": WIDTH},
        "sun": {"default": "S1"},
        "render": {"samples": 2, "marker_samples": 16, "max_depth": 2},
        "motion": {"start_s": HIDES_S, "end_s": HIDES_S},
    }
    return world_of(Scenario(**(table | tables)))


def studio_of(world: World, folder: Path) -> Studio:
    return Studio(world, RadianceStore(folder), LightKeys(world, "jit"), world.target.markers)


def image(studio: Studio, exposure: Exposure) -> Radiance:
    """Return sunlight and lamps of an exposure, nothing stored."""
    pose = studio.world.trajectory.cam_from_target(exposure.time_s)
    traced = studio.trace(exposure, pose, studio.world.groups(exposure))
    return np.stack([traced[name] for name in sorted(traced)])


@pytest.fixture(scope="module")
def armed() -> World:
    needs_jit()
    return small()


def sealed(studio: Studio, exposure: Exposure) -> ExposureTruth:
    record = studio.sealed(exposure, studio.world.trajectory.cam_from_target(exposure.time_s))
    assert isinstance(record, ExposureTruth)
    return record


@pytest.mark.slow
def test_it_is_the_same_in_any_order_and_company(armed: World, tmp_path: Path) -> None:
    exposures = [
        exposure
        for frame, time_s in enumerate((STOWED_S, HIDES_S, THERE_S))
        for exposure in armed.sensor.exposures(frame, time_s)
    ]
    first = studio_of(armed, tmp_path)
    forward = {exposure: image(first, exposure) for exposure in exposures}
    for exposure in reversed(exposures):
        np.testing.assert_array_equal(image(first, exposure), forward[exposure])
    alone = image(studio_of(armed, tmp_path), exposures[3])
    np.testing.assert_array_equal(alone, forward[exposures[3]])


def test_a_camera_that_stands_still_sees_the_arm_move(armed: World, tmp_path: Path) -> None:
    """One pose object for two instants: what is kept of the first must not serve the second."""
    studio = studio_of(armed, tmp_path)
    pose = armed.trajectory.cam_from_target(HIDES_S)
    masks = []
    for time_s in (STOWED_S, HIDES_S, STOWED_S):
        truth = studio.pixel_truth(Exposure(0, 850, time_s), pose)
        masks.append(truth.labels == studio.geometry.labels.index(CHASER_LABEL) + 1)
    assert not masks[0].any()
    assert masks[1].mean() > 0.02
    assert not masks[2].any()


def test_it_hides_markers_from_the_chasers_camera_on_its_way(armed: World, tmp_path: Path) -> None:
    studio, bare = studio_of(armed, tmp_path), studio_of(small(arm=None), tmp_path)
    exposure = Exposure(0, 850, HIDES_S)
    with_arm, without = sealed(studio, exposure), sealed(bare, exposure)
    hidden = with_arm.visible < 0.5
    assert (without.visible > 0.99).all()
    assert 1 <= hidden.sum() <= 3
    stowed = sealed(studio, Exposure(0, 850, STOWED_S))
    np.testing.assert_array_equal(
        stowed.visible > 0.5, sealed(bare, replace(exposure, time_s=STOWED_S)).visible > 0.5
    )
    pose = armed.trajectory.cam_from_target(HIDES_S)
    labels = studio.pixel_truth(exposure, pose).labels
    column, row = np.rint(with_arm.markers_px[hidden][0]).astype(int)
    assert labels[row, column] == studio.geometry.labels.index(CHASER_LABEL) + 1
    assert labels[row, column] != studio.geometry.labels.index(MARKER_LABEL) + 1


def test_every_pixel_of_the_arm_is_traced(armed: World, tmp_path: Path) -> None:
    studio = studio_of(armed, tmp_path)
    exposure = Exposure(0, 850, HIDES_S)
    pose = armed.trajectory.cam_from_target(HIDES_S)
    mask = armed.silhouette(pose, armed.stance(HIDES_S))
    assert mask is not None
    from renders.truth.pixel_truth import pixel_truth

    studio.build(exposure, pose)
    whole = pixel_truth(studio.scene, studio.geometry, armed.camera, pose, None).labels
    assert (whole > 0).any()
    assert mask[whole > 0].all()


def test_it_throws_a_shadow_where_the_hand_camera_looks(tmp_path: Path) -> None:
    """At contact the gripper stands on the ring, and the Sun comes from the side."""
    needs_jit()
    hand: dict[str, Any] = {
        "arm": {"camera": "hand"},
        "frame": {"kind": "single"},
        "camera": {"preset": "eye_in_hand", "width": WIDTH},
        "exposure": {"mode": "fixed"},
        "sun": {"default": "0.3,-0.6,0.5"},
        "motion": {"start_s": THERE_S, "end_s": THERE_S},
    }
    armed = small(**hand)
    bare = replace(armed, arm=None, bodies=replace(armed.bodies, make_chaser=None))
    (exposure,) = armed.exposures
    lit = image(studio_of(bare, tmp_path), exposure)[0]
    studio = studio_of(armed, tmp_path)
    shaded = image(studio, exposure)[0]
    pose = armed.trajectory.cam_from_target(THERE_S)
    labels = studio.pixel_truth(exposure, pose).labels
    seen = (labels > 0) & (labels != studio.geometry.labels.index(CHASER_LABEL) + 1)
    bright = seen & (lit > np.percentile(lit[seen], 50))
    dark = bright & (shaded < 0.3 * lit)
    assert 0.005 < dark.sum() / bright.sum() < 0.6
    assert not (labels[: WIDTH // 2] == studio.geometry.labels.index(CHASER_LABEL) + 1).any()
