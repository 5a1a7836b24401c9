"""A table of poses: its header names the frames, its numbers are poses, or it is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.errors import DatasetError
from models.motion.pose_table import EARTH, pose_columns, pose_table, read_pose_lines
from models.pose import RigidTransform
from tests.support.own_scenario import facing, pose_lines, row_of

CAM, TARGET = pose_columns("cam_from_target"), pose_columns("target_from_cam")
FACING = row_of(0.0, facing(5.0))


def refusal(lines: list[str]) -> str:
    with pytest.raises(DatasetError) as told:
        pose_table(lines, "poses.csv")
    assert str(told.value).startswith("poses.csv")
    return str(told.value)


@given(
    angles=st.tuples(*[st.floats(-179.0, 179.0)] * 3),
    place=st.tuples(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0), st.floats(0.5, 100.0)),
)
def test_what_is_written_is_what_is_read_whichever_way_the_poses_map(
    angles: tuple[float, float, float], place: tuple[float, float, float]
) -> None:
    turn = Rotation.from_euler("xyz", angles, degrees=True).as_matrix()
    cam_from_target = RigidTransform(turn, np.array(place))
    ways = ((CAM, cam_from_target), (TARGET, cam_from_target.inverse()))
    for columns, pose in ways:
        table = pose_table([",".join(columns), row_of(2.5, pose)], "poses.csv")
        assert table.times_s.tolist() == [2.5]
        # A quaternion and back: a few roundings of numbers up to 100.
        np.testing.assert_allclose(table.poses[0].matrix(), cam_from_target.matrix(), atol=1e-12)


def test_a_scalar_first_quaternion_turns_by_the_angle_it_says() -> None:
    """90 deg about z: x of the target lies along y of the camera; worked by hand."""
    half = repr(float(np.sqrt(0.5)))
    table = pose_table([",".join(CAM), f"0,0,0,5,{half},0,0,{half}"], "poses.csv")
    np.testing.assert_allclose(table.poses[0].rotate([1.0, 0.0, 0.0]), [0.0, 1.0, 0.0], atol=1e-15)


def test_a_quaternion_typed_with_four_digits_is_made_exact() -> None:
    table = pose_table([",".join(CAM), "0,0,0,5,0.7071,0,0.7071,0"], "poses.csv")
    rotation = table.poses[0].rotation
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-15)


def test_columns_stand_in_any_order_and_more_may_be_known() -> None:
    header = ["exposure_ms", *reversed(CAM), "sun_x", "sun_y", "sun_z"]
    cells = ["2.5", *reversed(FACING.split(",")), "0.6", "0.0", "0.8"]
    table = pose_table([",".join(header), ",".join(cells)], "poses.csv")
    assert table.poses[0].translation.tolist() == [0.0, 0.0, 5.0]
    assert table.exposures_ms is not None
    assert table.exposures_ms.tolist() == [2.5]
    assert table.sun_dirs_in_target is not None
    np.testing.assert_allclose(table.sun_dirs_in_target, [[0.6, 0.0, 0.8]], rtol=1e-15)


def test_a_plain_table_knows_neither_sun_nor_exposure() -> None:
    table = pose_table(pose_lines(3), "poses.csv")
    assert (len(table), table.sun_dirs_in_target, table.exposures_ms) == (3, None, None)


def test_rows_may_say_what_stands_behind() -> None:
    lines = [",".join((*CAM, *EARTH, "stars")), FACING + ",0,0.6,-0.8,0", row_of(1.0, facing(4.0))]
    lines[2] += ",0,0,0,1"
    table = pose_table(lines, "poses.csv")
    assert table.earth_dirs_in_target is not None
    np.testing.assert_allclose(table.earth_dirs_in_target, [[0.0, 0.6, -0.8], [0.0, 0.0, 0.0]])
    assert table.stars is not None
    assert table.stars.tolist() == [False, True]


@pytest.mark.parametrize(
    "header",
    [
        "time_s,tx_m,ty_m,tz_m,qw,qx,qy,qz",
        ",".join(CAM).replace("cam_from_target", "cam2target"),
        ",".join(CAM[:4] + TARGET[4:]),
        "",
    ],
)
def test_a_header_that_does_not_say_which_way_is_refused_with_one_that_does(header: str) -> None:
    said = refusal([header, FACING])
    assert "t_cam_from_target_x_m" in said
    assert "target_from_cam" in said


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ([], "names the frames"),
        ([",".join(CAM)], "1 to 100000 rows, got 0"),
        ([",".join(CAM[:-1]), "0,0,0,5,1,0,0"], "missing: q_cam_from_target_z"),
        ([",".join((*CAM, "roll_deg")), FACING + ",0"], "unknown: 'roll_deg'"),
        ([",".join(CAM), FACING, row_of(0.0, facing(4.0))], "poses.csv:3: expected time_s to rise"),
        ([",".join(CAM), "nan,0,0,5,1,0,0,0"], "expected time_s to be a number"),
        ([",".join(CAM), "0,0,0,inf,1,0,0,0"], "t_cam_from_target_z_m to be a number"),
        ([",".join(CAM), "-1,0,0,5,1,0,0,0"], "time_s of at least 0"),
        ([",".join(CAM), "0,0,0,5,1,1,0,0"], "quaternion of length 1, got length 1.41421"),
        ([",".join(CAM), "0,0,0,5,0,0,0,0"], "quaternion of length 1, got length 0"),
        ([",".join(CAM), "0,0,0,-5,1,0,0,0"], "in front of the camera"),
        ([",".join(TARGET), "0,0,0,5,1,0,0,0"], "in front of the camera"),
        ([",".join(CAM), "0,0,0,5,1,0,0"], "expected 8 cells, got 7"),
        ([",".join((*CAM, "sun_x")), FACING + ",1"], "all of the columns sun_x, sun_y, sun_z"),
        ([",".join((*CAM, "sun_x", "sun_y", "sun_z")), FACING + ",1,1,0"], "towards the Sun"),
        ([",".join((*CAM, "exposure_ms")), FACING + ",0"], "exposure_ms of at least 1e-06"),
        ([",".join((*CAM, "earth_y")), FACING + ",1"], "all of the columns earth_x, earth_y"),
        ([",".join((*CAM, *EARTH)), FACING + ",0,2,0"], "towards the Earth, in target axes, or"),
        ([",".join((*CAM, "stars")), FACING + ",0.5"], "expected stars as 0 or 1, got 0.5"),
    ],
)
def test_what_is_no_table_of_poses_is_refused_where_it_is_wrong(
    lines: list[str], said: str
) -> None:
    assert said in refusal(lines)


def test_lines_are_read_as_spreadsheets_write_them(tmp_path: Path) -> None:
    path = tmp_path / "poses.csv"
    path.write_bytes(b"\xef\xbb\xbf" + "\r\n".join([*pose_lines(2), "", ""]).encode())
    assert read_pose_lines(path) == pose_lines(2)
