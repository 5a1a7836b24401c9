"""What is told of the arm in a run: its joints as read, its camera's mount as measured."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from models.arm.hand_camera import hand_prior
from models.arm.onboard_arm import ARM_FILE, ARM_JOINTS, OnboardArm, columns_of
from models.arrays import Floats
from models.frame import TableReading
from models.motion.prior import draw_prior
from models.onboard import PosePrior
from models.pose import RigidTransform
from renders.scenario.told_tables import PriorTable, ToldArmTable
from renders.world.arm_aboard import ArmAboard
from renders.world.told_draws import EXACT, EXACT_VECTOR, drawn, errors_of
from renders.world.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class ToldArm:
    """The arm as told, run by run.

    Attributes
    ----------
    arm : ArmAboard
    table : ToldArmTable or None
        None where it is told as it is.
    """

    arm: ArmAboard
    table: ToldArmTable | None = None

    def joints_deg(self, time_s: float, run: int) -> Floats:
        """Return the joints as read, (n,), deg: each wrong by its own constant."""
        true = self.arm.motion.angles_at(time_s)
        wrong = (None if self.table is None else self.table.joints_deg) or EXACT
        return true + wrong.offset + wrong.sigma * drawn(run, "arm.joints_deg", len(true))

    def hand_from_tool(self, run: int) -> RigidTransform:
        """Return the mount of the hand camera as measured."""
        if self.table is None:
            return self.arm.hand_from_tool
        turn_deg = errors_of(self.table.mount_turn_deg, run, "arm.mount_turn_deg")[0]
        place_m = errors_of(self.table.mount_place_m, run, "arm.mount_place_m")[0]
        return self.arm.hand_from_tool.perturbed(np.deg2rad(turn_deg), place_m)

    def tables(self, run: int) -> dict[str, dict[str, Any]]:
        """Return what is on board of it, by the name of its file."""
        onboard = OnboardArm(self.arm.motion.arm, self.hand_from_tool(run), self.arm.carries_camera)
        return {ARM_FILE: onboard.to_table()}


@dataclass(frozen=True, eq=False)
class JointReadings:
    """The stream of the arm's joints, as read once a frame.

    Attributes
    ----------
    told : ToldArm
    """

    told: ToldArm
    name: str = ARM_JOINTS
    file: str = f"{ARM_JOINTS}.csv"

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of its numbers, unit at the end."""
        return columns_of(self.told.arm.motion.arm)

    def reading(self, frame: int, time_s: float, since_s: float, run: int) -> TableReading:
        """Return the joints at a frame, one row.

        Parameters
        ----------
        frame : int
            Of no consequence.
        time_s : float, s
        since_s : float, s
            Of no consequence.
        run : int
        """
        row = self.told.joints_deg(time_s, run)
        return TableReading(self.columns, np.array([time_s]), row[None])

    def along(self, trajectory: Trajectory) -> JointReadings:
        """Return itself: a camera that is steered leaves the joints as they are."""
        return self


@dataclass(frozen=True, eq=False)
class FirstPoseByArm:
    """The hand camera's first pose: that of the chaser-fixed camera, by way of the arm as told.

    Attributes
    ----------
    told : ToldArm
    start_s : float, s
    table : PriorTable
        Sigmas of the chaser-fixed camera's pose.
    """

    told: ToldArm
    start_s: float
    table: PriorTable

    def drawn(self, run: int, draw: int) -> PosePrior:
        """Return it as a run has it.

        Parameters
        ----------
        run : int
        draw : int
            Purpose that keys the run's random numbers.
        """
        truth = self.told.arm.chaser.cam_from_target(self.start_s)
        sigma_m, sigma_deg = np.array(self.table.sigma_t_m), np.array(self.table.sigma_euler_deg)
        rng = np.random.default_rng([run, draw])
        seen = PosePrior(draw_prior(truth, sigma_m, sigma_deg, rng), sigma_m, sigma_deg)
        table = self.told.table
        joints, turn, place = (
            (EXACT, EXACT_VECTOR, EXACT_VECTOR)
            if table is None
            else (
                table.joints_deg or EXACT,
                table.mount_turn_deg or EXACT_VECTOR,
                table.mount_place_m or EXACT_VECTOR,
            )
        )
        return hand_prior(
            seen,
            self.told.arm.motion.arm,
            self.told.joints_deg(self.start_s, run),
            self.told.hand_from_tool(run),
            sigma_joint_deg=joints.sigma,
            sigma_turn_deg=turn.sigma,
            sigma_place_m=place.sigma,
        )
