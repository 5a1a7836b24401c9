"""Both cameras over time: one state that lasts from frame to frame, handed over between them.

Where ``TwoCameras`` begins anew with each frame, this carries pose and rates on, learns what the
arm is told wrong by while both cameras speak, and so knows the hand camera's pose better when its
dots are lost. A pose that contradicts the state is refused; where that lasts, the state is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from models.arm.onboard_arm import ARM_JOINTS, OnboardArm
from models.arrays import Floats
from models.estimate import Detections, Estimate, NamedState, PoseEstimate
from models.frame import Frame, TableReading
from models.pose import RigidTransform
from pipelines.filters.covariance_fault import covariance_fault
from pipelines.two_cameras.arm_chain import POSE, ArmChain, chained_jacobian
from pipelines.two_cameras.flight_state import RATES, CameraName, FlightOptions, FlightState
from pipelines.two_cameras.fusion import MOST_CHI2
from pipelines.two_cameras.pipeline import CHASER_POSE, HAND_POSE, chaser_state, rivals, said_in

CARRIED = "carried"
RATES_STATE = "chaser_fixed_rates"
MOST_REFUSED = 3  # frames in a row in which a camera contradicts the state
LONGEST_CARRIED_S = 30.0


@dataclass(frozen=True, eq=False)
class _Offer:
    """A camera's poses of one frame, the likeliest first, and how the state tells of them."""

    camera: CameraName
    poses: tuple[PoseEstimate, ...]
    chain: ArmChain | None

    def expected(self, state: FlightState) -> tuple[RigidTransform, Floats]:
        if self.chain is None:
            own = np.hstack([np.eye(POSE), np.zeros((POSE, len(state.arm_errors)))])
            return state.pose, own
        return (
            self.chain.hand(state.pose, state.arm_errors),
            chained_jacobian(self.chain.hand, state.pose, state.arm_errors),
        )


class TwoCamerasOverTime:
    """One state of two cameras that lasts.

    Parameters
    ----------
    arm : OnboardArm
    sigmas : mapping of str to float
        1-sigma of what it is told wrong by.
    chaser_target_from_hand_target : RigidTransform
        Between the frames of the target in which the cameras' poses are told.
    options : FlightOptions
    """

    streams = (HAND_POSE, CHASER_POSE, ARM_JOINTS)

    def __init__(
        self,
        arm: OnboardArm,
        sigmas: Mapping[str, float],
        chaser_target_from_hand_target: RigidTransform,
        options: FlightOptions | None = None,
    ) -> None:
        self._arm, self._between = arm, chaser_target_from_hand_target
        still = self._chain(np.zeros(len(arm.arm.joints)))
        self._arm_sigmas = still.spread(sigmas)
        self._options = options or FlightOptions()
        self._forget()

    def take_in(self, chaser: Estimate) -> None:
        """Take in what the chaser-fixed camera says between two frames of the hand's.

        Parameters
        ----------
        chaser : Estimate
        """
        self._meet(chaser.time_s, _offers(None, chaser, None))

    def process(self, frame: Frame) -> Estimate:
        """Say the hand camera's pose, and the chaser-fixed one's with its rates as states.

        Parameters
        ----------
        frame : Frame
            With estimates as ``hand_pose`` and ``chaser_pose``, where there are any of its time.
        """
        hand, chaser = (said_in(frame, name) for name in (HAND_POSE, CHASER_POSE))
        joints = frame.readings[ARM_JOINTS]
        assert isinstance(joints, TableReading)
        chain = self._chain(joints.rows[-1])
        mode, reason = self._meet(frame.time_s, _offers(hand, chaser, chain))
        seen = None if hand is None else hand.detections
        if self._state is None:
            told = [each.reason for each in (hand, chaser) if each is not None and each.reason]
            why = reason or "; ".join(told) or "no camera has said anything yet"
            return Estimate(frame.index, frame.time_s, reason=why, detections=seen)
        return self._stated(frame, chain, mode, seen)

    def _chain(self, joints_deg: Floats) -> ArmChain:
        return ArmChain(self._arm, np.asarray(joints_deg, dtype=np.float64), self._between)

    def _forget(self) -> None:
        self._state: FlightState | None = None
        self._refused_in_row = 0
        self._last_said_s = -np.inf

    def _meet(self, time_s: float, offers: list[_Offer]) -> tuple[str, str]:
        """Carry the state to a time and take in what is offered; return mode, reason for none."""
        fresh = self._state is None
        if self._state is not None:
            self._state = self._state.later(time_s)
        taken: list[str] = []
        refused: list[str] = []
        for offer in offers:
            told, chi2 = self._take(offer, time_s)
            if told:
                taken.append(told)
            else:
                refused.append(f"{chi2:.0f} sigmas squared of six off for the {offer.camera}'s")
        self._refused_in_row = self._refused_in_row + 1 if refused else 0
        if taken:
            self._last_said_s = time_s
        if refused and (fresh or self._refused_in_row >= MOST_REFUSED):
            self._forget()
            return "", f"the two cameras contradict each other: {', '.join(refused)}"
        if self._state is not None and time_s - self._last_said_s > LONGEST_CARRIED_S:
            since_s = time_s - self._last_said_s
            self._forget()
            return "", f"no camera has had a pose for {since_s:.0f} s"
        if "hand" in taken or "rival" in taken:
            own = "rival" if "rival" in taken else "hand"
            return ("both" if own == "hand" and "chaser" in taken else own), ""
        return ("chaser" if taken else CARRIED), ""

    def _take(self, offer: _Offer, time_s: float) -> tuple[str, float]:
        """Take in a camera's first pose that agrees; return whose it is, if any, and the chi2."""
        if self._state is None:
            self._state = FlightState.unknown(
                time_s, self._near(offer), self._arm_sigmas, self._options
            )
        expected, jacobian = offer.expected(self._state)
        nearest = np.inf
        for number, pose in enumerate(offer.poses):
            state, chi2 = self._state.told(offer.camera, pose, expected, jacobian)
            if chi2 < MOST_CHI2:
                self._state = state
                return ("rival" if number else offer.camera), chi2
            nearest = min(nearest, chi2)
        return "", nearest

    def _near(self, offer: _Offer) -> RigidTransform:
        pose = offer.poses[0].cam_from_target
        if offer.chain is None:
            return pose
        return offer.chain.chaser(pose, np.zeros(len(self._arm_sigmas)))

    def _stated(
        self, frame: Frame, chain: ArmChain, mode: str, seen: Detections | None
    ) -> Estimate:
        state = self._state
        assert state is not None
        own = chained_jacobian(chain.hand, state.pose, state.arm_errors)
        hand = PoseEstimate(chain.hand(state.pose, state.arm_errors), state.known(own))
        chaser = PoseEstimate(state.pose, state.covariance[:POSE, :POSE])
        rates = state.numbers[RATES]
        motion = NamedState(
            {"turn_rate_rad_s": rates[:3], "velocity_m_s": rates[3:]},
            state.covariance[RATES, RATES],
        )
        return Estimate(
            frame.index,
            frame.time_s,
            pose=hand,
            detections=seen,
            mode=mode,
            states={**chaser_state(chaser), RATES_STATE: motion},
        )


def _offers(hand: Estimate | None, chaser: Estimate | None, chain: ArmChain | None) -> list[_Offer]:
    """Return what the cameras offer, the chaser-fixed one first: its markers have no mirror."""
    offers = []
    if chaser is not None and _sure(chaser.pose):
        assert chaser.pose is not None
        offers.append(_Offer("chaser", (chaser.pose,), None))
    if hand is not None and _sure(hand.pose):
        assert hand.pose is not None
        offers.append(_Offer("hand", (hand.pose, *rivals(hand)), chain))
    return offers


def _sure(pose: PoseEstimate | None) -> bool:
    return pose is not None and not covariance_fault(pose.covariance)
