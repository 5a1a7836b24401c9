"""A camera that moves while its shutter is open, by what it must do to a marker's light."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.pose import RigidTransform
from renders.batches.stepping import Steered
from renders.batches.studio import Studio
from renders.scenario.scenario import Scenario
from renders.store.kept_light import LightKeeping
from renders.store.light_keys import LightKeys
from renders.store.radiance_store import RadianceStore
from renders.world.build import world_of
from renders.world.exposure import Exposure
from tests.support.small_scenes import needs_jit

WIDTH, EXPOSURE_MS, TIME_S = 256, 40.0, 10.0
SIDEWAYS_M_S = (1.6, 0.0, 0.0)
ROW_US = 300.0
OF_LIGHT = 0.015  # the median of so small a box takes a hundredth of a smear for background
CENTROID_PX = 0.03  # by the samples at a marker's rim, five sigma
SPREAD_PX2 = 0.06  # by the face's glow within the box: a tenth of what is looked for
MARKER = 0  # in the middle of the face, alone within ten pixels
REACH_PX = (4, 2)  # columns and rows: the face round it shines in the lamps, too

AHEAD = RigidTransform(np.diag([1.0, -1.0, -1.0]), np.array([0.0, -0.9, 6.0]))


def sideways(time_s):
    away = np.array(SIDEWAYS_M_S) * (time_s - TIME_S)
    return RigidTransform(AHEAD.rotation, AHEAD.translation + away)


def studio(tmp_path, shutter=None, motion=sideways):
    needs_jit()
    scenario = Scenario(
        name="t",
        camera={"preset": "chaser_fixed", "width": WIDTH},
        exposure={"mode": "fixed", "exposure_ms": EXPOSURE_MS},
        render={"samples": 16, "marker_samples": 4096},
        shutter=shutter,
    )
    world = world_of(scenario)
    world = replace(world, trajectory=Steered(motion), sky=replace(world.sky, shared=()))
    store, keys = RadianceStore(tmp_path / "none"), LightKeys(world, "jit")
    return Studio(world, store, keys, world.target.markers, kept=LightKeeping("none"))


def lamp_light(made):
    exposure = Exposure(0, 850, TIME_S)
    pose = made.world.trajectory.cam_from_target(exposure.time_s)
    lamps = [made.world.lamps(exposure.band)]
    return made.trace(exposure, pose, lamps)[lamps[0].name].astype(np.float64)


def at_marker(made, image):
    """Return a marker's light, centroid from its projection and mean square spread, px."""
    point = AHEAD @ made.world.target.markers.points_in_target[MARKER]
    centre = made.world.camera.project(point[None])[0]
    column, row = np.rint(centre).astype(int)
    across, down = REACH_PX
    bright = image[row - down : row + down + 1, column - across : column + across + 1]
    bright = bright - np.median(bright)
    rows, columns = np.mgrid[-down : down + 1, -across : across + 1]
    light = bright.sum()
    u, v = (bright * columns).sum() / light, (bright * rows).sum() / light
    spread = (bright * (columns - u) ** 2).sum() / light, (bright * (rows - v) ** 2).sum() / light
    off = np.array([u + column - centre[0], v + row - centre[1]])
    return light, off, np.array(spread), centre


def test_blur_keeps_the_light_and_its_middle_and_spreads_it_along_the_way(tmp_path):
    still, moved = studio(tmp_path), studio(tmp_path, {"blur": True})
    light, off, spread, _ = at_marker(still, lamp_light(still))
    blurred, off_blurred, spread_blurred, _ = at_marker(moved, lamp_light(moved))
    depth_m = (AHEAD @ moved.world.target.markers.points_in_target[MARKER])[2]
    way_px = moved.world.camera.fx * SIDEWAYS_M_S[0] * 1e-3 * EXPOSURE_MS / depth_m
    assert way_px**2 / 12.0 > 10.0 * SPREAD_PX2
    assert blurred == pytest.approx(light, rel=OF_LIGHT)
    np.testing.assert_allclose(off_blurred, off, atol=CENTROID_PX)
    wider = spread_blurred - spread
    np.testing.assert_allclose(wider, [way_px**2 / 12.0, 0.0], atol=SPREAD_PX2)


def test_a_rolling_shutter_shifts_a_marker_by_its_rows_time(tmp_path):
    still, rolled = studio(tmp_path), studio(tmp_path, {"row_us": ROW_US})
    light, off, _, _ = at_marker(still, lamp_light(still))
    seen, off_rolled, _, centre = at_marker(rolled, lamp_light(rolled))
    depth_m = (AHEAD @ rolled.world.target.markers.points_in_target[MARKER])[2]
    late_s = 1e-6 * ROW_US * (centre[1] - 0.5 * (rolled.world.camera.height - 1))
    shift_px = rolled.world.camera.fx * SIDEWAYS_M_S[0] * late_s / depth_m
    assert abs(shift_px) > 0.5
    np.testing.assert_allclose(off_rolled - off, [shift_px, 0.0], atol=CENTROID_PX)
    assert seen == pytest.approx(light, rel=OF_LIGHT)


def test_a_camera_at_rest_sees_the_same_bits_whatever_its_shutter(tmp_path):
    plain = studio(tmp_path, None, AHEAD)
    opened = studio(tmp_path, {"blur": True, "row_us": ROW_US}, AHEAD)
    np.testing.assert_array_equal(lamp_light(plain), lamp_light(opened))


def test_light_of_a_moving_camera_has_a_key_of_its_own(tmp_path):
    exposure = Exposure(0, 850, TIME_S)
    keys = [
        studio(tmp_path, shutter, motion).group_keys(exposure, AHEAD)
        for shutter, motion in (
            (None, sideways),
            ({"blur": True}, sideways),
            ({"blur": True, "row_us": ROW_US}, sideways),
            ({"blur": True}, AHEAD),
        )
    ]
    plain, blurred, rolled, at_rest = keys
    assert plain == at_rest
    assert not set(plain.values()) & set(blurred.values())
    assert not set(blurred.values()) & set(rolled.values())
