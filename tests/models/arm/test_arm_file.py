"""A user's arm by file: rows or a URDF give the arm that they tell, and bad ones one clear line."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.arm.arm_file import own_arm
from models.arm.denavit_hartenberg import joints_of
from models.arm.house_arm import ROWS, house_arm
from models.arm.kinematics import base_from_tool, chaser_from_tool
from models.arm.onboard_arm import OnboardArm, columns_of
from models.arrays import Floats
from models.errors import RvbenchError
from models.pose import RigidTransform
from tests.support.arms import drawn_angles

BASE = RigidTransform(np.eye(3), np.array([0.1, -0.5, 0.0]))
EXACT = 1e-12


def rows_as_toml(tool: str = "", more: str = "") -> str:
    """Return the house's rows as a file."""
    text = f'name = "mine"\n{more}\n'
    for row in ROWS:
        text += (
            f'[[joint]]\nname = "{row.name}"\na_m = {row.a_m}\nalpha_deg = {row.alpha_deg}\n'
            f"d_m = {row.d_m}\ntheta_deg = {row.theta_deg}\nlower_deg = {row.lower_deg}\n"
            f"upper_deg = {row.upper_deg}\nradius_m = 0.06\n"
        )
    return text + tool


def turns(rotation: Rotation) -> Floats:
    """Return turns about the fixed axes, (3,), rad; any that do where several would."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of a gimbal lock
        return rotation.as_euler("xyz")


def as_urdf(axis: str = "0 0 1", kind: str = "revolute", more: str = "") -> str:
    """Return the house's arm as a URDF, its joints turning about another axis of their frames."""
    along = np.array([float(x) for x in axis.split()])
    along /= np.linalg.norm(along)
    tilt, _ = Rotation.align_vectors(along[None], np.array([[0.0, 0.0, 1.0]]))
    joints, flange = joints_of(ROWS)
    text, before = '<robot name="mine"><link name="l0"/>', Rotation.identity()
    for number, joint in enumerate(joints):
        stands = joint.link_from_joint
        origin = before * Rotation.from_matrix(stands.rotation) * tilt.inv()
        place = before.apply(np.array(stands.translation))
        before = tilt
        text += (
            f'<link name="l{number + 1}"><collision><origin xyz="0 0 0.2"/><geometry>'
            '<cylinder radius="0.05" length="0.3"/></geometry></collision></link>'
            f'<joint name="{joint.name}" type="{kind}"><parent link="l{number}"/>'
            f'<child link="l{number + 1}"/><axis xyz="{axis}"/>'
            f'<origin xyz="{" ".join(map(repr, place.tolist()))}" '
            f'rpy="{" ".join(map(repr, turns(origin).tolist()))}"/>'
            f'<limit lower="{joint.lower_rad!r}" upper="{joint.upper_rad!r}" effort="1" '
            'velocity="1"/></joint>'
        )
    end = before * Rotation.from_matrix(flange.rotation)
    place = before.apply(np.array(flange.translation))
    return text + (
        '<link name="hand"/><joint name="fixed" type="fixed"><parent link="l7"/>'
        f'<child link="hand"/><origin xyz="{" ".join(map(repr, place.tolist()))}" '
        f'rpy="{" ".join(map(repr, turns(end).tolist()))}"/></joint>{more}</robot>'
    )


def read(text: str, name: str = "mine.toml"):
    """Return the arm of a file."""
    return own_arm(text.splitlines(), name, BASE)


def same_as_the_house(arm) -> None:
    house, rng = house_arm(), np.random.default_rng(0)
    for _ in range(5):
        angles = drawn_angles(house, rng)
        np.testing.assert_allclose(
            base_from_tool(arm, angles).matrix(), base_from_tool(house, angles).matrix(), atol=EXACT
        )
    np.testing.assert_allclose(arm.lower_rad, house.lower_rad)
    np.testing.assert_allclose(arm.upper_rad, house.upper_rad)


def test_rows_in_a_file_are_the_arm():
    own = read(rows_as_toml(more="near_deg = [1, 2, 3, 4, 5, 6, 7]"))
    same_as_the_house(own.arm)
    assert own.near_deg.tolist() == [1, 2, 3, 4, 5, 6, 7]
    assert {capsule.radius_m for capsule in own.arm.capsules} == {0.06}


def test_every_link_that_has_a_length_is_a_tube_and_the_hand():
    """Rows of d = 0.30, 0, 1.05, 0, 1.00, 0 and 0.60 m: the arm is as long as its tubes."""
    lengths_m = {tube.link: tube.length_m for tube in read(rows_as_toml()).arm.capsules}
    told_m = {link + 1: row.d_m for link, row in enumerate(ROWS[:-1]) if row.d_m > 0.0}
    assert lengths_m == pytest.approx({**told_m, len(ROWS): ROWS[-1].d_m})


def test_a_tool_is_put_on_the_last_frame():
    plain = read(rows_as_toml()).arm
    longer = read(rows_as_toml("[tool]\nplace_m = [0.0, 0.0, 0.1]\nrpy_deg = [0, 90, 0]\n")).arm
    turned = base_from_tool(plain, np.zeros(7)).inverse() @ base_from_tool(longer, np.zeros(7))
    np.testing.assert_allclose(turned.translation, [0.0, 0.0, 0.1], atol=EXACT)
    np.testing.assert_allclose(turned.rotation[:, 2], [1.0, 0.0, 0.0], atol=EXACT)


@pytest.mark.parametrize("axis", ["0 0 1", "1 0 0", "0 -1 0", "0 0 -1", "1 2 3"])
def test_a_urdf_is_the_arm_about_whatever_axes(axis):
    arm = read(as_urdf(axis), "mine.urdf").arm
    same_as_the_house(arm)
    assert arm.name == "mine"
    tubes = [capsule for capsule in arm.capsules if capsule.radius_m == 0.05 and capsule.link == 5]
    assert [round(tube.length_m, 9) for tube in tubes] == [0.3]


def test_continuous_joints_turn_once_round_and_fingers_are_left_out():
    finger = (
        '<link name="finger"/><joint name="f" type="fixed"><parent link="l7"/>'
        '<child link="finger"/></joint>'
    )
    arm = read(as_urdf(kind="continuous", more=finger), "mine.urdf").arm
    assert len(arm.joints) == 7
    np.testing.assert_allclose(arm.upper_rad, np.pi)


LAUGHS = '<!DOCTYPE robot [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;">]><robot name="&b;"/>'
REFUSED = {
    "not TOML": ("name = ", "mine.toml", "mine.toml"),
    "no joints": ('name = "x"\njoint = []', "mine.toml", "joint as one table for each"),
    "an unknown key": (rows_as_toml(more="colour = 1"), "mine.toml", "unknown: colour"),
    "a limit missing": (rows_as_toml().replace("upper_deg", "upper"), "mine.toml", "upper"),
    "limits crossed": (
        rows_as_toml().replace("upper_deg = 170.0", "upper_deg = -190.0"),
        "mine.toml",
        "below its upper",
    ),
    "too long": (rows_as_toml().replace("d_m = 1.05", "d_m = 1e9"), "mine.toml", "d_m"),
    "near of another arm": (rows_as_toml(more="near_deg = [1.0]"), "mine.toml", "near_deg"),
    "not XML": ("<robot", "mine.urdf", "mine.urdf"),
    "another XML": ("<svg/>", "mine.urdf", "whose root is <robot>, got <svg>"),
    "a bomb": (LAUGHS, "mine.urdf", "take the DOCTYPE out"),
    "too deep": (
        "<robot>" + "<a>" * 80 + "</a>" * 80 + "</robot>",
        "mine.urdf",
        "nested more than",
    ),
    "no turning joints": (
        '<robot name="r"><link name="a"/></robot>',
        "mine.urdf",
        "joints that turn",
    ),
    "a sliding joint": (as_urdf(kind="prismatic"), "mine.urdf", "revolute, continuous, fixed"),
    "no axis": (
        as_urdf().replace('<axis xyz="0 0 1"/>', '<axis xyz="0 0 0"/>'),
        "mine.urdf",
        "with an axis",
    ),
    "no numbers": (
        as_urdf().replace('<axis xyz="0 0 1"/>', '<axis xyz="0 0 nan"/>'),
        "mine.urdf",
        "as 3 numbers",
    ),
    "a link that is not there": (
        as_urdf().replace('parent link="l3"', 'parent link="l33"'),
        "mine.urdf",
        "l33",
    ),
    "a ring": (
        as_urdf().replace('<parent link="l0"/>', '<parent link="hand"/>'),
        "mine.urdf",
        "a ring",
    ),
    "no limit": (as_urdf().replace("<limit", "<stop"), "mine.urdf", "with a <limit>"),
}


@pytest.mark.parametrize("why", REFUSED)
def test_a_bad_file_is_refused_in_one_line(why):
    text, name, said = REFUSED[why]
    with pytest.raises(RvbenchError) as raised:
        read(text, name)
    assert said in str(raised.value)
    assert "\n" not in str(raised.value)


def test_what_is_on_board_is_read_back():
    arm = read(rows_as_toml()).arm
    mount = RigidTransform(np.eye(3), np.array([0.0, 0.2, 0.4]))
    onboard = OnboardArm(arm, mount, True)
    back = OnboardArm.of_table(onboard.to_table())
    angles = np.deg2rad([10, 20, 30, 40, 50, 60, 70])
    np.testing.assert_allclose(
        chaser_from_tool(back.arm, angles).matrix(),
        chaser_from_tool(arm, angles).matrix(),
        atol=EXACT,
    )
    assert back.carries_camera
    assert columns_of(arm)[6] == "joint_7_deg"
    with pytest.raises(RvbenchError, match="images_of"):
        OnboardArm.of_table({**onboard.to_table(), "images_of": "nobody"})
