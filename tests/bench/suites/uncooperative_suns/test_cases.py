"""What is drawn of the study: keyed, within its bounds, and physically one motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bench.suites.uncooperative_suns.cases import (
    EARTH_AWAY_DEG,
    PHASES_DEG,
    RATES_DEG_S,
    SHARES,
    STEPS_S,
    SUNS,
    MotionTask,
    draw_motion,
    told_sun,
)
from models.camera import camera_preset
from models.lights.earth import EARTH_RADIUS_KM, GEO_RADIUS_KM

TASK = MotionTask("xmm", "", 0, 3, 256, 8)
CAMERA = camera_preset("chaser_fixed").resized(256)
RADIUS_M = 8.0
MOTIONS = [draw_motion(replace(TASK, number=n), CAMERA, RADIUS_M) for n in range(40)]


def test_a_motion_is_the_same_however_many_are_drawn() -> None:
    again = draw_motion(replace(TASK, number=7), CAMERA, RADIUS_M)
    assert again.poses[3].matrix().tobytes() == MOTIONS[7].poses[3].matrix().tobytes()
    assert again.suns_in_inertial.tobytes() == MOTIONS[7].suns_in_inertial.tobytes()
    other = draw_motion(replace(TASK, number=7, seed=4), CAMERA, RADIUS_M)
    assert other.share != again.share


def test_all_is_within_its_bounds() -> None:
    phases = np.concatenate([motion.phases_deg for motion in MOTIONS])
    assert phases.min() >= PHASES_DEG[0]
    assert phases.max() <= PHASES_DEG[1]
    for motion in MOTIONS:
        assert SHARES[0] <= motion.share <= SHARES[1]
        assert RATES_DEG_S[0] <= motion.rate_deg_s <= RATES_DEG_S[1]
        assert STEPS_S[0] <= motion.step_s <= STEPS_S[1]
        across = 2.0 * RADIUS_M * CAMERA.fx / np.linalg.norm(motion.poses[0].translation)
        assert across == pytest.approx(motion.share * CAMERA.width)


def test_the_target_turns_at_its_rate() -> None:
    for motion in MOTIONS[:5]:
        turn = Rotation.from_matrix(motion.poses[0].rotation.T @ motion.poses[1].rotation)
        turned = np.rad2deg(turn.magnitude())
        assert turned == pytest.approx(motion.rate_deg_s * motion.step_s)


def test_neither_does_the_earth_stand_in_the_image_nor_hide_a_sun() -> None:
    radius = np.arcsin(EARTH_RADIUS_KM / GEO_RADIUS_KM)
    for motion in MOTIONS:
        earth = motion.cam_from_inertial(0) @ motion.earth_in_inertial
        assert np.rad2deg(np.arccos(earth[2])) > EARTH_AWAY_DEG
        assert (motion.suns_in_inertial @ motion.earth_in_inertial < np.cos(radius)).all()
        assert sum(motion.earth_shines) == SUNS // 2


def test_a_start_is_told_its_own_sun() -> None:
    sun = MOTIONS[0].suns_in_inertial[0]
    one, other = told_sun(TASK, 0, sun, 0.3), told_sun(TASK, 1, sun, 0.3)
    assert one.tobytes() == told_sun(TASK, 0, sun, 0.3).tobytes()
    assert not np.array_equal(one, other)
    assert told_sun(TASK, 0, sun, 0.0) @ sun == pytest.approx(1.0)
