"""What is drawn of the tumbles: keyed, within its bounds, and what the scenario then moves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bench.suites.uncooperative_suns.cases import (
    PHASES_DEG,
    RATES_DEG_S,
    SHARES,
    STEPS_S,
    MotionTask,
)
from bench.suites.uncooperative_tumbles.cases import (
    DrawnTumble,
    draw_tumble,
    drawn_scenario,
)
from models.camera import camera_preset
from models.motion.tumble import CAM_FROM_LVLH
from models.spacecraft.wireframes import wireframe_by_name
from renders.world.build import world_of

TASK = MotionTask("xmm", "", 0, 3, 256, 4, 6)
CAMERA = camera_preset("chaser_fixed").resized(256)
RADIUS_M = 8.0
TURN_SHARE = 0.02  # nutation lets the rate vary, but hardly over a second
ROUNDING = 1e-9


def tumble(number: int, seed: int = 3) -> DrawnTumble:
    return draw_tumble(replace(TASK, number=number, seed=seed), CAMERA, RADIUS_M)


def test_a_tumble_is_the_same_however_many_are_drawn() -> None:
    drawn = [tumble(number) for number in range(9)]
    again = tumble(7)
    assert again.rho_m.tobytes() == drawn[7].rho_m.tobytes()
    assert again.omega_deg_s.tobytes() == drawn[7].omega_deg_s.tobytes()
    assert tumble(7, seed=4).share != again.share


def test_all_is_within_its_bounds_and_half_have_the_earths_light() -> None:
    drawn = [tumble(number) for number in range(60)]
    for one in drawn:
        assert RATES_DEG_S[0] <= one.rate_deg_s <= RATES_DEG_S[1]
        assert STEPS_S[0] <= one.step_s <= STEPS_S[1]
        assert SHARES[0] <= one.share <= SHARES[1]
        assert PHASES_DEG[0] <= one.phase_deg <= PHASES_DEG[1]
        across = 2.0 * RADIUS_M * CAMERA.fx / np.linalg.norm(one.rho_m)
        assert across == pytest.approx(one.share * CAMERA.width)
    assert sum(one.earth_shines for one in drawn) == len(drawn) // 2


@pytest.mark.parametrize("target", ["xmm", "hispasat", "maxar1300_unmarked"])
def test_the_scenario_moves_what_was_drawn_under_the_sun_that_was_drawn(target: str) -> None:
    """The world is asked, not the table: pose, turn over a second, and the phase angle."""
    drawn, scenario = drawn_scenario(replace(TASK, target=target))
    assert drawn.share * CAMERA.width == pytest.approx(
        2.0 * wireframe_by_name(target).radius_m * CAMERA.fx / np.linalg.norm(drawn.rho_m)
    )
    world = world_of(scenario)
    assert len(world.exposures) == TASK.images
    assert np.diff([each.time_s for each in world.exposures]) == pytest.approx(drawn.step_s)
    pose = world.trajectory.cam_from_target(0.0)
    np.testing.assert_allclose(pose.translation, CAM_FROM_LVLH @ drawn.rho_m, atol=ROUNDING)
    later = world.trajectory.cam_from_target(1.0)
    turn = Rotation.from_matrix(pose.rotation.T @ later.rotation).magnitude()
    assert np.rad2deg(turn) == pytest.approx(drawn.rate_deg_s, rel=TURN_SHARE, abs=0.01)
    first = world.exposures[0]
    sun = np.array(world.sun_at(world.sun, first.time_s).direction_in_target)
    to_camera = world.trajectory.cam_from_target(first.time_s).inverse().translation
    cosine = sun @ to_camera / np.linalg.norm(to_camera)
    assert np.rad2deg(np.arccos(cosine)) == pytest.approx(drawn.phase_deg, abs=0.01)


def test_what_a_flight_computer_knows_is_told_with_its_errors() -> None:
    one, other = (world_of(drawn_scenario(TASK)[1]).onboard(run) for run in (0, 1))
    for onboard in (one, other):
        assert onboard.expectations is not None
        assert onboard.expectations.sun_dir_in_inertial is not None
        assert onboard.expectations.earth_shines
        assert onboard.wireframe is not None
        assert onboard.wireframe.finish is not None
    assert one.expectations is not None
    assert other.expectations is not None
    assert one.expectations.white_dn_ms != other.expectations.white_dn_ms
