"""The scenario's table of the chaser's arm: which one, where it goes, and which camera looks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from models.arm.arm import Arm
from models.arm.arm_file import fixed_axes, own_arm
from models.arm.hand_camera import END_EFFECTOR_IN_CAMERA_M, with_hand_camera
from models.arm.house_arm import NEAR_DEG, house_arm
from models.arrays import Floats
from models.errors import DatasetError, ScenarioError
from models.pose import RigidTransform
from renders.scenario.motion_choice import motion_kind_of, table_motion_of, takes_stills
from renders.scenario.table import Component, Name, Table, Triple

if TYPE_CHECKING:
    from renders.scenario.scenario import Scenario

Line = Annotated[str, Field(max_length=10_000)]
Placed = Annotated[tuple[Component, Component, Component], Field(strict=False)]
BASE_OF_OWN = (0.0, -0.46, -0.03)  # on the chaser's front, above its camera


class ArmTable(Table):
    """The chaser's arm; see ``models.arm``. Where this table is, the arm moves and is seen."""

    camera: Literal["chaser", "hand"] = Field(
        "chaser", description="which camera takes the images: fixed to the chaser, or on the arm"
    )
    file: Name | None = Field(
        None, description="an arm.toml or a URDF beside the scenario; the house's arm if left out"
    )
    kind: Literal["toml", "urdf"] | None = Field(
        None, description="which of them it was, as a resolved scenario says"
    )
    lines: Annotated[tuple[Line, ...], Field(strict=False, max_length=100_000)] | None = Field(
        None, description="the file's lines, as a resolved scenario holds them"
    )
    base_in_chaser_m: Placed | None = Field(
        None, description="where the base stands, axes of the chaser-fixed camera"
    )
    base_rpy_deg: Placed = Field(
        (0.0, 0.0, 0.0), description="its turns about those axes, x first, as in a URDF"
    )
    extends_s: float = Field(240.0, ge=-1e6, le=1e6, description="set-point 1: it begins to move")
    looks_s: float = Field(
        282.3, ge=-1e6, le=1e6, description="set-point 2: its camera is on the markers"
    )
    touches_s: float = Field(330.0, ge=-1e6, le=1e6, description="set-point 3: contact")
    ready_in_chaser_m: Placed = Field(
        (-0.2, -0.85, 0.5), description="end effector at set-point 1, axes of that camera"
    )
    ready_rpy_deg: Placed = Field(
        (90.0, 0.0, 180.0), description="its turns there, x first; its z is the way it points"
    )
    grasp_in_target_m: Triple = Field(
        (0.0, 0.83, 0.0), description="end effector at contact: the grasping point, on the ring"
    )
    grasp_rpy_deg: Placed = Field(
        (180.0, 0.0, 0.0), description="its turns at set-points 2 and 3 about the target's axes"
    )
    stand_off_m: float = Field(
        1.0, gt=0, le=100, description="before the grasping point at set-point 2"
    )
    near_deg: Annotated[tuple[Component, ...], Field(strict=False, max_length=30)] | None = Field(
        None, description="a posture near which set-point 2 is met, a joint each"
    )
    end_effector_in_camera_m: Triple = Field(
        END_EFFECTOR_IN_CAMERA_M, description="how the hand camera is mounted; axes are parallel"
    )

    @property
    def chaser_from_base(self) -> RigidTransform:
        """Where the base stands."""
        own = BASE_OF_OWN if self.lines is not None else house_arm().chaser_from_base.translation
        place = own if self.base_in_chaser_m is None else self.base_in_chaser_m
        return fixed_axes(np.array(place), np.array(self.base_rpy_deg))

    @property
    def hand_from_tool(self) -> RigidTransform:
        """How the hand camera is mounted."""
        return RigidTransform(np.eye(3), np.array(self.end_effector_in_camera_m))

    @property
    def target_from_grasp(self) -> RigidTransform:
        """The end effector at contact."""
        return fixed_axes(np.array(self.grasp_in_target_m), np.array(self.grasp_rpy_deg))

    @property
    def chaser_from_ready(self) -> RigidTransform:
        """The end effector where it begins to move."""
        return fixed_axes(np.array(self.ready_in_chaser_m), np.array(self.ready_rpy_deg))


def arm_of(table: ArmTable, where: str) -> tuple[Arm, Floats | None]:
    """Return the arm of a scenario, and the posture that set-point 2 is met near, (n,) deg.

    Raises
    ------
    ScenarioError
        If its file cannot be used, or the posture is not one of its own.
    """
    near: Sequence[float] | Floats | None = table.near_deg
    if table.lines is None:
        arm = replace(house_arm(), chaser_from_base=table.chaser_from_base)
        near = NEAR_DEG if near is None else near
    else:
        try:
            own = own_arm(table.lines, f"{where}: arm.{table.kind}", table.chaser_from_base)
        except DatasetError as error:
            raise ScenarioError(str(error)) from error
        arm, near = own.arm, own.near_deg if near is None else near
    arm = with_hand_camera(arm, table.hand_from_tool)
    if near is not None and len(near) != len(arm.joints):
        raise ScenarioError(
            f"{where}: expected arm.near_deg of {len(arm.joints)} angles, one for each joint of "
            f"{arm.name}, got {len(near)}"
        )
    return arm, None if near is None else np.array(near, dtype=np.float64)


def check_arm(scenario: Scenario, where: str) -> None:
    """Refuse an arm that has nowhere to go, and times that do not rise.

    Raises
    ------
    ScenarioError
        The message names the key.
    """
    table = scenario.arm
    if table is None:
        if scenario.prior.by == "arm":
            raise ScenarioError(f'{where}: expected a table [arm] for prior.by = "arm", got none')
        return
    if table.file is not None:
        raise ScenarioError(
            f"{where}: expected arm.file of a scenario that is read from a file, beside which it "
            f"lies, got {table.file!r}"
        )
    if (table.lines is None) != (table.kind is None):
        raise ScenarioError(f"{where}: expected arm.lines with arm.kind, got one without the other")
    kind = motion_kind_of(scenario)
    if kind == "tumble" or takes_stills(scenario):
        what = "[tumble], whose chaser is tens of metres away" if kind == "tumble" else "stills"
        raise ScenarioError(
            f"{where}: expected [arm] with an approach or a motion through a table of poses "
            f'(motion.poses = "interpolated"), got {what}'
        )
    if not table.extends_s < table.looks_s < table.touches_s:
        raise ScenarioError(
            f"{where}: expected arm.extends_s before arm.looks_s before arm.touches_s, got "
            f"{table.extends_s:g}, {table.looks_s:g} and {table.touches_s:g} s"
        )
    if kind == "poses":
        times_s = table_motion_of(scenario).table.times_s
        if not times_s[0] <= table.extends_s or not table.touches_s <= times_s[-1]:
            raise ScenarioError(
                f"{where}: expected arm.extends_s, looks_s and touches_s within the table of "
                f"poses, {times_s[0]:g} to {times_s[-1]:g} s, got {table.extends_s:g} to "
                f"{table.touches_s:g} s"
            )
    if table.camera == "hand" and scenario.frame_kind == "pairs":
        raise ScenarioError(
            f'{where}: expected arm.camera = "hand" with single images (frame.kind = "single"): '
            "the lamps of image pairs stand about the camera that is fixed to the chaser; got pairs"
        )
    if scenario.prior.by == "arm" and table.camera != "hand":
        raise ScenarioError(
            f'{where}: expected prior.by = "arm" with arm.camera = "hand", whose first pose '
            f'follows from that of the other, got "{table.camera}"'
        )
    arm_of(table, where)
