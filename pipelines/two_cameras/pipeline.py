"""Frame by frame, what the chaser-fixed camera and the one in the arm's hand say together.

Its readings are estimates of both, each from a pipeline of its own, and the joints as read. Where
one camera has no pose the other speaks for both, by way of the arm; where they contradict each
other, the second pose that fits three dots is tried, and else there is a reason for none.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from models.arm.onboard_arm import ARM_JOINTS, OnboardArm
from models.arrays import Floats
from models.estimate import Estimate, NamedState, PoseEstimate
from models.frame import Frame, TableReading
from models.pose import RigidTransform
from pipelines.two_cameras.fusion import MOST_CHI2, BothPoses, both_poses

HAND_POSE, CHASER_POSE = "hand_pose", "chaser_pose"
CHASER_FIXED, RIVAL = "chaser_fixed_pose", "rival_pose"
# 1-sigma of what a target does in the chaser's frame while an estimate grows old.
DRIFT_M_S, DRIFT_DEG_S = 0.03, 0.05


class TwoCameras:
    """One state of two cameras.

    Parameters
    ----------
    arm : OnboardArm
    sigmas : mapping of str to float
        1-sigma of what it is told wrong by.
    chaser_target_from_hand_target : RigidTransform
        Between the frames of the target in which the cameras' poses are told.
    """

    streams = (HAND_POSE, CHASER_POSE, ARM_JOINTS)

    def __init__(
        self,
        arm: OnboardArm,
        sigmas: Mapping[str, float],
        chaser_target_from_hand_target: RigidTransform,
    ) -> None:
        self._arm, self._sigmas = arm, sigmas
        self._between = chaser_target_from_hand_target

    def process(self, frame: Frame) -> Estimate:
        """Say the hand camera's pose, and as the state ``chaser_fixed_pose`` that of the other.

        Parameters
        ----------
        frame : Frame
            With estimates as ``hand_pose`` and ``chaser_pose``, where there are any.
        """
        hand, chaser = (said_in(frame, name) for name in (HAND_POSE, CHASER_POSE))
        joints = frame.readings[ARM_JOINTS]
        assert isinstance(joints, TableReading)
        joints_deg = joints.rows[-1]
        own = None if hand is None else hand.pose
        other = None if chaser is None else _aged(chaser, frame.time_s)
        seen = None if hand is None else hand.detections
        if own is None and other is None:
            told = [each.reason for each in (hand, chaser) if each is not None and each.reason]
            reason = "; ".join(told) or "no camera has said anything yet"
            return Estimate(frame.index, frame.time_s, reason=reason, detections=seen)
        if own is not None and other is not None:
            fitting = [own] if hand is None else [own, *rivals(hand)]
            found = [self._both(joints_deg, each, other) for each in fitting]
            place = next((n for n, each in enumerate(found) if each.chi2 < MOST_CHI2), None)
            if place is None:
                reason = (
                    f"the two cameras contradict each other: {found[0].chi2:.0f} sigmas squared "
                    "of six, by the arm as told"
                )
                return Estimate(frame.index, frame.time_s, reason=reason, detections=seen)
            return self._stated(frame, found[place], "both" if place == 0 else "rival", hand)
        mode = "hand" if other is None else "chaser"
        return self._stated(frame, self._both(joints_deg, own, other), mode, hand)

    def _both(
        self, joints_deg: Floats, hand: PoseEstimate | None, chaser: PoseEstimate | None
    ) -> BothPoses:
        return both_poses(self._arm, joints_deg, self._sigmas, hand, chaser, self._between)

    @staticmethod
    def _stated(frame: Frame, found: BothPoses, mode: str, hand: Estimate | None) -> Estimate:
        return Estimate(
            frame.index,
            frame.time_s,
            pose=found.hand,
            detections=None if hand is None else hand.detections,
            mode=mode,
            states=chaser_state(found.chaser),
        )


def chaser_state(pose: PoseEstimate) -> dict[str, NamedState]:
    """Return the chaser-fixed camera's pose as the state that stands beside the hand camera's.

    Parameters
    ----------
    pose : PoseEstimate
    """
    at = pose.cam_from_target
    values = {"R_cam_from_target": at.rotation, "t_cam_from_target_m": at.translation}
    return {CHASER_FIXED: NamedState(values, pose.covariance)}


def said_in(frame: Frame, name: str) -> Estimate | None:
    """Return what a camera says in a frame, if anything.

    Parameters
    ----------
    frame : Frame
    name : str
        ``HAND_POSE`` or ``CHASER_POSE``.
    """
    reading = frame.readings.get(name)
    return reading if isinstance(reading, Estimate) else None


def _aged(said: Estimate, time_s: float) -> PoseEstimate | None:
    """Return a pose as it is some time later, less sure."""
    if said.pose is None or said.pose.covariance is None:
        return None
    age_s = abs(time_s - said.time_s)
    turn, shift = np.deg2rad(DRIFT_DEG_S) * age_s, DRIFT_M_S * age_s
    grown = said.pose.covariance + np.diag([*3 * [turn**2], *3 * [shift**2]])
    return replace(said.pose, covariance=grown)


def rivals(said: Estimate) -> list[PoseEstimate]:
    """Return the second pose that fits, with the covariance of the first.

    Parameters
    ----------
    said : Estimate
        Of the hand camera.
    """
    state = said.states.get(RIVAL)
    if state is None or said.pose is None:
        return []
    values = state.values
    pose = RigidTransform(values["R_cam_from_target"], values["t_cam_from_target_m"])
    return [replace(said.pose, cam_from_target=pose)]
