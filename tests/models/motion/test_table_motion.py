"""Motions through a table: stills stand, smooth ones run through every row."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.errors import ScenarioError
from models.motion.approach import Approach
from models.motion.pose_table import PoseTable, pose_table
from models.motion.table_motion import SmoothMotion, Stills
from models.pose import RigidTransform, pose_error
from tests.support.own_scenario import facing, pose_lines

TABLE = pose_table(pose_lines(6, step_s=2.0), "poses.csv")
SUNS = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])


def spinning(rate_deg_s: float, times_s: list[float]) -> PoseTable:
    """Return a target that turns about an oblique axis and falls from 5 m as a cubic does."""
    axis = np.array([0.6, 0.0, 0.8])
    poses = [
        RigidTransform(
            Rotation.from_rotvec(rate_deg_s * t * axis, degrees=True).as_matrix(),
            np.array([0.1 * t, 0.02 * t**2, 5.0 + 0.01 * t**3]),
        )
        for t in times_s
    ]
    return PoseTable(np.array(times_s), tuple(poses))


def test_stills_hold_both_exposures_of_a_pair_at_their_row() -> None:
    stills = Stills(TABLE, lead_s=0.033)
    for row, time_s in enumerate(TABLE.times_s.tolist()):
        for instant in (time_s - 0.033 - 0.9, time_s - 0.033, time_s, time_s + 0.9):
            assert stills.cam_from_target(instant) is TABLE.poses[row]


@given(row=st.integers(0, 5), off=st.floats(-0.99, 0.99))
def test_a_still_lasts_while_its_shutter_is_open(row: int, off: float) -> None:
    assert Stills(TABLE).row(float(TABLE.times_s[row]) + off) == row


def test_a_smooth_motion_runs_through_every_row() -> None:
    motion = SmoothMotion(TABLE)
    for time_s, pose in zip(TABLE.times_s.tolist(), TABLE.poses, strict=True):
        np.testing.assert_allclose(
            motion.cam_from_target(time_s).matrix(), pose.matrix(), atol=1e-12
        )


@given(time_s=st.floats(-0.1, 8.1))
def test_a_steady_spin_and_a_cubic_fall_are_met_exactly_between_rows(time_s: float) -> None:
    """Slerp is exact for a constant rate, a not-a-knot spline for a cubic: also beyond the ends."""
    motion = SmoothMotion(spinning(13.0, [0.0, 0.7, 2.0, 3.5, 5.0, 8.0]), overtime_s=0.1)
    truth = spinning(13.0, [time_s]).poses[0]
    np.testing.assert_allclose(motion.cam_from_target(time_s).matrix(), truth.matrix(), atol=1e-11)


def test_an_approach_logged_every_second_is_met_within_a_micrometre() -> None:
    """The sway is slow: at 0.02 deg/s, its rate changes by far less than 1e-3 deg/s in a second."""
    approach = Approach()
    times_s = np.arange(100.0, 111.0)
    table = PoseTable(times_s, tuple(approach.cam_from_target(float(t)) for t in times_s))
    motion = SmoothMotion(table)
    for time_s in (102.5, 105.25, 107.9):
        error = pose_error(motion.cam_from_target(time_s), approach.cam_from_target(time_s))
        assert np.abs(error.position_m).max() < 1e-6
        assert error.attitude_deg < 1e-4


def test_beyond_the_table_there_is_no_motion() -> None:
    motion = SmoothMotion(TABLE, overtime_s=0.033)
    motion.cam_from_target(-0.033)
    for time_s in (-0.04, 10.04):
        with pytest.raises(ScenarioError, match="within the table of poses, 0 to 10 s"):
            motion.cam_from_target(time_s)


def test_rows_too_far_apart_to_know_the_way_round_are_refused() -> None:
    wide = spinning(50.0, [0.0, 1.0, 4.0, 5.0])
    with pytest.raises(ScenarioError, match=r"got 150 deg from 1 to 4 s"):
        SmoothMotion(wide)
    assert Stills(wide).row(4.0) == 2


def test_one_row_is_a_still_and_no_motion() -> None:
    alone = PoseTable(np.array([0.0]), (facing(5.0),))
    assert Stills(alone).cam_from_target(0.0) is alone.poses[0]
    with pytest.raises(ScenarioError, match="two rows"):
        SmoothMotion(alone)


def test_sun_and_exposure_are_those_of_their_row_or_between() -> None:
    times_s = np.array([0.0, 1.0, 2.0])
    table = PoseTable(times_s, TABLE.poses[:3], SUNS, np.array([1.0, 2.0, 4.0]))
    stills, smooth = Stills(table), SmoothMotion(table)
    for row, time_s in enumerate(times_s.tolist()):
        np.testing.assert_array_equal(stills.sun_dir_in_target(time_s), SUNS[row])
        np.testing.assert_allclose(smooth.sun_dir_in_target(time_s), SUNS[row], atol=1e-15)
    third = smooth.sun_dir_in_target(1.0 / 3.0)  # 30 deg of 90
    np.testing.assert_allclose(third, [np.sqrt(0.75), 0.5, 0.0], atol=1e-12)
    assert (stills.exposure_ms(1.5), smooth.exposure_ms(1.5)) == (2.0, 3.0)


def test_what_a_table_does_not_know_is_not_made_up() -> None:
    for motion in (Stills(TABLE), SmoothMotion(TABLE)):
        with pytest.raises(ScenarioError, match="a Sun"):
            motion.sun_dir_in_target(0.0)
        with pytest.raises(ScenarioError, match="exposure_ms"):
            motion.exposure_ms(0.0)
