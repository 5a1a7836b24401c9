"""An arm of a user's own: ``arm.toml``, its Denavit-Hartenberg rows, or a URDF.

::

    name = "my arm"
    convention = "denavit_hartenberg"   # or "craig": alpha and a of the link before
    near_deg = [0, 40, 0, -90, 0, 50, 0]  # a posture to go near, if you like one

    [[joint]]
    name = "shoulder"
    a_m = 0.0
    alpha_deg = -90.0
    d_m = 0.3
    theta_deg = 0.0                     # where the joint reads zero
    lower_deg = -170.0
    upper_deg = 170.0
    radius_m = 0.06                     # of the link from here to the next joint

    [tool]                              # the end effector in the last frame; left out: that frame
    place_m = [0.0, 0.0, 0.1]
    rpy_deg = [0.0, 0.0, 0.0]           # turns about the fixed axes x, y and z, as in a URDF
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from models.arm.arm import Arm, Capsule, Joint
from models.arm.denavit_hartenberg import Row, joints_of
from models.arm.urdf_file import arm_of_urdf
from models.arrays import Floats
from models.errors import DatasetError, UnreadableError
from models.pose import RigidTransform
from models.reading.bounds import ANGLE_DEG
from models.reading.fields import Fields
from models.reading.nesting import check_toml_nesting
from models.reading.regular_file import MEGABYTE, read_lines
from models.reading.shown import shown_line

MOST_ARM_BYTES = 4 * MEGABYTE
MOST_JOINTS = 30
LINK_M = (-50.0, 50.0)  # a dimension of a link
RADIUS_M = 0.05  # of a link whose radius is not told
CONVENTIONS = ("denavit_hartenberg", "craig")
URDF = "urdf"
NUMBERS = ("a_m", "alpha_deg", "d_m", "lower_deg", "upper_deg")


@dataclass(frozen=True, eq=False)
class OwnArm:
    """An arm as its file tells it.

    Attributes
    ----------
    arm : Arm
    near_deg : (n,) array or None, deg
        A posture that it had better be near.
    """

    arm: Arm
    near_deg: Floats | None


def read_arm_lines(path: Path) -> list[str]:
    """Read the lines of an arm's file.

    Raises
    ------
    UnreadableError
        If it cannot be read.
    """
    return read_lines(path, MOST_ARM_BYTES)


def is_urdf(where: Path | str) -> bool:
    """Tell by the end of its name whether a file is a URDF."""
    return str(where).lower().endswith(URDF)


def own_arm(lines: Sequence[str], where: Path | str, chaser_from_base: RigidTransform) -> OwnArm:
    """Return the arm of a file.

    Parameters
    ----------
    lines : sequence of str
        The file's.
    where : Path or str
        The file; its ending says which kind it is.
    chaser_from_base : RigidTransform
        Where the base stands.

    Raises
    ------
    DatasetError, UnreadableError
        If a key is missing or unknown, a value cannot be, or it is no arm of turning joints.
    """
    text = "\n".join(lines)
    if is_urdf(where):
        return OwnArm(arm_of_urdf(text, where, chaser_from_base), None)
    try:
        check_toml_nesting(Path(where), text)
        fields = Fields(tomllib.loads(text), where)
    except (ValueError, RecursionError) as error:
        raise UnreadableError(Path(where), shown_line(str(error))) from error
    return _of_rows(fields, chaser_from_base)


def _of_rows(fields: Fields, chaser_from_base: RigidTransform) -> OwnArm:
    fields.only(("name", "joint"), ("convention", "near_deg", "tool"))
    convention = CONVENTIONS[0]
    if "convention" in fields:
        convention = fields.choice("convention", CONVENTIONS)
    tables = fields.tables("joint", MOST_JOINTS)
    if not tables:
        raise fields.refusal("joint", "as one table for each joint", "none")
    rows = [_row(table) for table in tables]
    radii = [
        table.number("radius_m", 1e-3, 5.0) if "radius_m" in table else RADIUS_M for table in tables
    ]
    try:
        joints, flange = joints_of(rows, convention == "craig")
    except ValueError as error:
        raise DatasetError(f"{fields.where}: {error}") from error
    tool = flange @ (
        _placed(fields.table("tool")) if "tool" in fields else RigidTransform.identity()
    )
    near = None
    if "near_deg" in fields:
        near = fields.vector("near_deg", len(joints), *ANGLE_DEG)
    arm = Arm(
        fields.text("name"), chaser_from_base, joints, tool, links_as_capsules(joints, tool, radii)
    )
    return OwnArm(arm, near)


def links_as_capsules(
    joints: Sequence[Joint], last_from_tool: RigidTransform, radii_m: Sequence[float]
) -> tuple[Capsule, ...]:
    """Return straight links: from each joint to the next, and from the last to the tool.

    Parameters
    ----------
    joints : sequence of Joint
    last_from_tool : RigidTransform
    radii_m : sequence of float, m
        Of the link after each joint; the base has that of the first.
    """
    ends = [joint.link_from_joint.translation for joint in joints] + [last_from_tool.translation]
    names = ["base", *(f"link after {joint.name}" for joint in joints)]
    return tuple(
        Capsule(link, name, np.zeros(3), end, radius_m)
        for link, (name, end, radius_m) in enumerate(
            zip(names, ends, [radii_m[0], *radii_m], strict=True)
        )
        if link == len(joints) or np.linalg.norm(end) > 0.0
    )


def _row(table: Fields) -> Row:
    table.only(("name", *NUMBERS), ("theta_deg", "radius_m"))
    return Row(
        name=table.text("name"),
        a_m=table.number("a_m", *LINK_M),
        alpha_deg=table.number("alpha_deg", *ANGLE_DEG),
        d_m=table.number("d_m", *LINK_M),
        theta_deg=table.number("theta_deg", *ANGLE_DEG) if "theta_deg" in table else 0.0,
        lower_deg=table.number("lower_deg", *ANGLE_DEG),
        upper_deg=table.number("upper_deg", *ANGLE_DEG),
    )


def _placed(table: Fields) -> RigidTransform:
    table.only((), ("place_m", "rpy_deg"))
    place = table.vector("place_m", 3, *LINK_M) if "place_m" in table else np.zeros(3)
    rpy_deg = table.vector("rpy_deg", 3, *ANGLE_DEG) if "rpy_deg" in table else np.zeros(3)
    return fixed_axes(place, rpy_deg)


def fixed_axes(place_m: Floats, rpy_deg: Floats) -> RigidTransform:
    """Return a pose from its place and its turns about the fixed axes x, y and z, in that order.

    Parameters
    ----------
    place_m : (3,) array, m
    rpy_deg : (3,) array, deg
    """
    from scipy.spatial.transform import Rotation

    return RigidTransform(Rotation.from_euler("xyz", rpy_deg, degrees=True).as_matrix(), place_m)
