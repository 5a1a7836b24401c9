"""Both cameras' poses as one state, over drawn flights in which the arm's errors last."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.arm.hand_camera import HAND_FROM_TOOL, hand_from_chaser
from models.arm.house_arm import NEAR_DEG, house_arm
from models.arm.onboard_arm import ARM_JOINTS, OnboardArm, columns_of
from models.arrays import Floats
from models.estimate import Estimate, NamedState, PoseEstimate
from models.frame import Frame, Reading, TableReading
from models.pose import RigidTransform
from pipelines.two_cameras.arm_chain import difference
from pipelines.two_cameras.pipeline import CHASER_FIXED, CHASER_POSE, HAND_POSE, TwoCameras

ARM = house_arm()
TOLD = OnboardArm(ARM, HAND_FROM_TOOL, True)
JOINTS_DEG = np.array(NEAR_DEG, dtype=np.float64)
BETWEEN = RigidTransform(np.eye(3), np.array([0.0, 0.83, 0.0]))
SIGMAS = {"arm.joints_deg": 0.02, "arm.mount_turn_deg": 0.05, "arm.mount_place_m": 0.001}
HAND = np.diag([1e-3, 2e-3, 5e-4, 2e-4, 2e-4, 1e-3]) ** 2
CHASER = np.diag([2e-3, 2e-3, 1e-3, 5e-4, 5e-4, 3e-3]) ** 2
CHASER_FROM_TARGET = RigidTransform(np.diag([1.0, -1.0, -1.0]), np.array([0.1, -0.8, 2.2]))
FLIGHTS, FRAMES = 24, 3
# The mean over the flights of a NEES of six degrees of freedom, +- 3.3 of its deviations.
BAND = 6.0 + 3.3 * np.array([-1.0, 1.0]) * np.sqrt(12.0 / FLIGHTS)


def estimate(pose: RigidTransform, covariance: Floats, time_s: float = 0.0) -> Estimate:
    return Estimate(0, time_s, PoseEstimate(pose, covariance))


def wrong_by(pose: RigidTransform, covariance: Floats, rng: np.random.Generator) -> RigidTransform:
    away = np.linalg.cholesky(covariance) @ rng.standard_normal(6)
    return pose.perturbed(away[:3], away[3:])


def frame(hand: Estimate | None, chaser: Estimate | None, joints_deg: Floats) -> Frame:
    readings: dict[str, Reading] = {
        ARM_JOINTS: TableReading(columns_of(ARM), np.zeros(1), joints_deg[None])
    }
    if hand is not None:
        readings[HAND_POSE] = hand
    if chaser is not None:
        readings[CHASER_POSE] = chaser
    return Frame(0, 0.0, readings)


def hand_truth() -> RigidTransform:
    return hand_from_chaser(ARM, JOINTS_DEG, HAND_FROM_TOOL) @ CHASER_FROM_TARGET @ BETWEEN


def drawn_frames(seed: int) -> list[tuple[TwoCameras, Estimate, Estimate, Floats]]:
    """Return frames of one flight: what the arm is told wrong by is the same in all of them."""
    rng = np.random.default_rng(seed)
    read = JOINTS_DEG + SIGMAS["arm.joints_deg"] * rng.standard_normal(len(JOINTS_DEG))
    turn = np.deg2rad(SIGMAS["arm.mount_turn_deg"]) * rng.standard_normal(3)
    place = SIGMAS["arm.mount_place_m"] * rng.standard_normal(3)
    told = replace(TOLD, hand_from_tool=HAND_FROM_TOOL.perturbed(turn, place))
    fusing = TwoCameras(told, SIGMAS, BETWEEN)
    return [
        (
            fusing,
            estimate(wrong_by(hand_truth(), HAND, rng), HAND),
            estimate(wrong_by(CHASER_FROM_TARGET, CHASER, rng), CHASER),
            read,
        )
        for _ in range(FRAMES)
    ]


def nees(pose: RigidTransform, covariance: Floats, truth: RigidTransform) -> float:
    away = difference(pose, truth)
    return float(away @ np.linalg.solve(covariance, away))


@pytest.mark.parametrize("speaks", ["both", "hand", "chaser"])
def test_both_poses_are_as_sure_as_they_say_whoever_speaks(speaks: str) -> None:
    of_hand, of_chaser = [], []
    for seed in range(FLIGHTS):
        fusing, hand, chaser, read = drawn_frames(seed)[-1]
        said = fusing.process(
            frame(hand if speaks != "chaser" else None, chaser if speaks != "hand" else None, read)
        )
        assert said.mode == speaks
        assert said.pose is not None
        own = said.pose.stated_covariance
        of_hand.append(nees(said.pose.cam_from_target, own, hand_truth()))
        state = said.states[CHASER_FIXED]
        pose = RigidTransform(
            state.values["R_cam_from_target"], state.values["t_cam_from_target_m"]
        )
        assert state.covariance is not None
        of_chaser.append(nees(pose, state.covariance, CHASER_FROM_TARGET))
    for squares in (of_hand, of_chaser):
        assert BAND[0] < np.mean(squares) < BAND[1]


def test_two_cameras_are_surer_than_either() -> None:
    fusing, hand, chaser, read = drawn_frames(0)[0]
    pairs = ((hand, None), (None, chaser))
    alone = [fusing.process(frame(pair[0], pair[1], read)) for pair in pairs]
    both = fusing.process(frame(hand, chaser, read))
    assert both.pose is not None
    for each in alone:
        assert each.pose is not None
        gained = each.pose.stated_covariance - both.pose.stated_covariance
        assert np.linalg.eigvalsh(gained)[0] > -1e-12


def test_what_lasts_is_not_averaged_away() -> None:
    """The mean of a flight's chained poses keeps the arm's error: no frame makes the next surer."""
    sures = []
    for fusing, _, chaser, read in drawn_frames(3):
        said = fusing.process(frame(None, chaser, read))
        assert said.pose is not None
        sures.append(np.trace(said.pose.stated_covariance))
    np.testing.assert_allclose(sures, sures[0], rtol=0.02)


def test_an_exact_arm_chains_exactly() -> None:
    fusing = TwoCameras(TOLD, {}, BETWEEN)
    said = fusing.process(frame(None, estimate(CHASER_FROM_TARGET, CHASER), JOINTS_DEG))
    assert said.pose is not None
    np.testing.assert_allclose(difference(said.pose.cam_from_target, hand_truth()), 0.0, atol=1e-9)


def test_cameras_that_contradict_each_other_give_a_reason() -> None:
    fusing = TwoCameras(TOLD, SIGMAS, BETWEEN)
    off = hand_truth().perturbed([0.0, 0.1, 0.0], [0.0, 0.0, 0.05])
    said = fusing.process(
        frame(estimate(off, HAND), estimate(CHASER_FROM_TARGET, CHASER), JOINTS_DEG)
    )
    assert said.pose is None
    assert said.reason is not None
    assert "contradict each other" in said.reason


def test_the_arm_decides_between_a_pose_and_its_mirror() -> None:
    truth = hand_truth()
    mirror = truth.perturbed([0.0, 0.5, 0.0], [0.0, 0.0, 0.01])
    rival = {"R_cam_from_target": truth.rotation, "t_cam_from_target_m": truth.translation}
    taken = replace(estimate(mirror, HAND), states={"rival_pose": NamedState(rival)})
    fusing = TwoCameras(TOLD, SIGMAS, BETWEEN)
    said = fusing.process(frame(taken, estimate(CHASER_FROM_TARGET, CHASER), JOINTS_DEG))
    assert said.mode == "rival"
    assert said.pose is not None
    assert np.abs(difference(said.pose.cam_from_target, truth)).max() < 1e-6


def test_an_old_pose_is_less_sure() -> None:
    fusing = TwoCameras(TOLD, SIGMAS, BETWEEN)
    old = estimate(CHASER_FROM_TARGET, CHASER, time_s=-2.0)
    said = fusing.process(frame(None, old, JOINTS_DEG))
    assert said.pose is not None
    assert np.sqrt(said.pose.stated_covariance[5, 5]) > 0.06  # 30 mm/s


def test_without_any_pose_the_cameras_reasons_are_told() -> None:
    fusing = TwoCameras(TOLD, SIGMAS, BETWEEN)
    blind = Estimate(0, 0.0, reason="2 of the 3 dots found, 3 needed")
    assert fusing.process(frame(blind, None, JOINTS_DEG)).reason == blind.reason
    assert fusing.process(frame(None, None, JOINTS_DEG)).reason
