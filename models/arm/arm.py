"""An arm as a chain of turning joints, each fixed to the link before it.

Link 0 is the base, link k what joint k carries, the last link carries the tool. In its link's frame
joint k turns about z. How the chain was told, by Denavit-Hartenberg rows or a URDF, is forgotten
here: :mod:`models.arm.denavit_hartenberg`, :mod:`models.arm.urdf_file`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models.arrays import Floats
from models.pose import RigidTransform


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint that turns.

    Attributes
    ----------
    name : str
    link_from_joint : RigidTransform
        Its frame at angle zero, in the frame of the link before it; it turns about its own z.
    lower_rad, upper_rad : float, rad
        Where it stops.

    Raises
    ------
    ValueError
        If it stops before it starts, or not at all.
    """

    name: str
    link_from_joint: RigidTransform
    lower_rad: float
    upper_rad: float

    def __post_init__(self) -> None:
        if not -np.inf < self.lower_rad < self.upper_rad < np.inf:
            raise ValueError(
                f"expected joint {self.name} with a lower limit below its upper one, both finite, "
                f"got {np.rad2deg(self.lower_rad):g} to {np.rad2deg(self.upper_rad):g} deg"
            )


@dataclass(frozen=True, eq=False)
class Capsule:
    """A cylinder with round ends about part of a link; a sphere where its ends are one.

    Attributes
    ----------
    link : int
        0 for the base, k for what joint k carries.
    name : str
        What an engineer calls that part of the arm.
    start_in_link, end_in_link : (3,) array, m
        Ends of its axis.
    radius_m : float, m

    Raises
    ------
    ValueError
        If the radius is not positive.
    """

    link: int
    name: str
    start_in_link: Floats
    end_in_link: Floats
    radius_m: float

    def __post_init__(self) -> None:
        if not 0.0 < self.radius_m < np.inf:
            raise ValueError(f"expected {self.name} with a radius above 0, got {self.radius_m} m")

    @property
    def length_m(self) -> float:
        """Of its axis."""
        return float(np.linalg.norm(self.end_in_link - self.start_in_link))


@dataclass(frozen=True, eq=False)
class Arm:
    """An arm.

    Attributes
    ----------
    name : str
    chaser_from_base : RigidTransform
        Where its base stands, in the frame of the chaser-fixed camera (OpenCV's axes).
    joints : tuple of Joint
        From the base outwards.
    last_from_tool : RigidTransform
        The end effector in the last link: origin where it grasps, z the way it points.
    capsules : tuple of Capsule
        What the arm fills, from the base outwards.

    Raises
    ------
    ValueError
        If it has no joint, or a capsule belongs to no link.
    """

    name: str
    chaser_from_base: RigidTransform
    joints: tuple[Joint, ...]
    last_from_tool: RigidTransform
    capsules: tuple[Capsule, ...]

    def __post_init__(self) -> None:
        if not self.joints:
            raise ValueError(f"expected an arm with joints, {self.name} has none")
        beyond = [c.name for c in self.capsules if not 0 <= c.link <= len(self.joints)]
        if beyond:
            raise ValueError(f"expected capsules on links of {self.name}, got {beyond[0]} on none")

    @cached_property
    def lower_rad(self) -> Floats:
        """(n,) array, rad."""
        return np.array([joint.lower_rad for joint in self.joints])

    @cached_property
    def upper_rad(self) -> Floats:
        """(n,) array, rad."""
        return np.array([joint.upper_rad for joint in self.joints])

    @cached_property
    def middle_rad(self) -> Floats:
        """(n,) array, rad: halfway between the limits."""
        return 0.5 * (self.lower_rad + self.upper_rad)

    @cached_property
    def fixed(self) -> Floats:
        """(n + 1, 4, 4) array: each joint in the link before it, at zero, and the tool."""
        transforms = [joint.link_from_joint for joint in self.joints] + [self.last_from_tool]
        return np.stack([each.matrix() for each in transforms])

    @cached_property
    def reach_m(self) -> float:
        """The length of the chain from the first joint to the end effector, stretched."""
        return float(np.linalg.norm(self.fixed[1:, :3, 3], axis=1).sum())
