"""The poses of two cameras of one chaser, fixed and in the arm's hand, as one state in one frame.

The state is the hand camera's pose and what the arm's joints and the camera's mount are told wrong
by; from it follows the chaser-fixed camera's pose, so whichever camera speaks, both are known. What
the arm is told wrong by lasts: it enters each frame's information (Maybeck 1979, section 5.7) with
its whole sigma, and no frame teaches the next about it, for the cameras' own errors may last, too.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from models.arm.onboard_arm import OnboardArm
from models.arrays import Floats
from models.estimate import PoseEstimate
from models.pose import RigidTransform
from pipelines.two_cameras.arm_chain import POSE, ArmChain, chained_jacobian, difference

TURNS = 2
MOST_CHI2 = 30.0  # of six numbers that two cameras tell of one pose: one in 25,000 is above


@dataclass(frozen=True, eq=False)
class BothPoses:
    """What two cameras come to.

    Attributes
    ----------
    hand, chaser : PoseEstimate
        Of either camera, from the one state.
    chi2 : float
        Of what is left of the readings and of the arm's errors.
    """

    hand: PoseEstimate
    chaser: PoseEstimate
    chi2: float


def both_poses(
    arm: OnboardArm,
    joints_deg: ArrayLike,
    sigmas: Mapping[str, float],
    hand: PoseEstimate | None,
    chaser: PoseEstimate | None,
    chaser_target_from_hand_target: RigidTransform,
) -> BothPoses:
    """Bring the poses of two cameras to one state.

    Parameters
    ----------
    arm : OnboardArm
    joints_deg : (n,) array, deg
        As read.
    sigmas : mapping of str to float
        1-sigma of what the arm is told wrong by: ``arm.joints_deg`` and so on.
    hand, chaser : PoseEstimate or None
        Of the camera in the hand, and of the one fixed to the chaser; one may have none.
    chaser_target_from_hand_target : RigidTransform
        Between the frames of the target in which they are told.

    Raises
    ------
    ValueError
        If neither camera has a pose, or one states no covariance.
    """
    if hand is None and chaser is None:
        raise ValueError("expected a pose of at least one camera, got none")
    chain = ArmChain(arm, np.asarray(joints_deg, dtype=np.float64), chaser_target_from_hand_target)
    spread = chain.spread(sigmas)
    at = hand.cam_from_target if hand is not None else None
    if at is None:
        assert chaser is not None
        at = chain.hand(chaser.cam_from_target, np.zeros(len(spread)))
    errors = np.zeros(len(spread))
    free = spread > 0.0
    kept = np.concatenate([np.ones(POSE, dtype=np.bool_), free])
    weights = np.divide(1.0, spread**2, out=np.zeros_like(spread), where=free)
    information, chi2 = np.zeros((0, 0)), 0.0
    by_state = chained_jacobian(chain.chaser, at, errors)
    for turn in range(TURNS + 1):
        information = np.diag(np.concatenate([np.zeros(POSE), weights]))
        pull = np.concatenate([np.zeros(POSE), -weights * errors])
        chi2 = float(weights @ errors**2)
        by_state = chained_jacobian(chain.chaser, at, errors)
        own = np.hstack([np.eye(POSE), np.zeros((POSE, len(spread)))])
        for said, rows, now in (
            (hand, own, at),
            (chaser, by_state, chain.chaser(at, errors)),
        ):
            if said is None:
                continue
            inverse = np.linalg.inv(said.stated_covariance)
            left = difference(said.cam_from_target, now)
            information += rows.T @ inverse @ rows
            pull += rows.T @ inverse @ left
            chi2 += float(left @ inverse @ left)
        if turn == TURNS:
            break
        step = np.zeros(len(kept))
        step[kept] = np.linalg.solve(information[np.ix_(kept, kept)], pull[kept])
        at = at.perturbed(step[:3], step[3:POSE])
        errors = errors + step[POSE:]
    covariance = np.zeros_like(information)
    covariance[np.ix_(kept, kept)] = np.linalg.inv(information[np.ix_(kept, kept)])
    return BothPoses(
        PoseEstimate(at, _symmetric(covariance[:POSE, :POSE])),
        PoseEstimate(chain.chaser(at, errors), _symmetric(by_state @ covariance @ by_state.T)),
        chi2,
    )


def _symmetric(matrix: Floats) -> Floats:
    return np.asarray(0.5 * (matrix + matrix.T))
