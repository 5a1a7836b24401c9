"""One state of two cameras over drawn flights, in which what is wrong lasts, as in a mission."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from models.arm.hand_camera import HAND_FROM_TOOL, hand_from_chaser
from models.arrays import Floats
from models.estimate import Estimate, NamedState, PoseEstimate
from models.frame import Frame
from models.pose import RigidTransform
from pipelines.two_cameras.arm_chain import difference
from pipelines.two_cameras.flight_state import FlightOptions
from pipelines.two_cameras.over_time import CARRIED, RATES_STATE, TwoCamerasOverTime
from pipelines.two_cameras.pipeline import CHASER_FIXED
from tests.pipelines.two_cameras.test_two_cameras import (
    ARM,
    BETWEEN,
    CHASER,
    CHASER_FROM_TARGET,
    HAND,
    JOINTS_DEG,
    SIGMAS,
    TOLD,
    estimate,
    frame,
    nees,
)

OPTIONS = FlightOptions()
STEP_S, FRAMES, FLIGHTS = 2.0, 14, 16
DOTS_LOST = 9  # from this frame on the hand camera has no pose
DOUBTED = (
    0.4  # of an honest NEES, at least: what is drawn anew is allowed for as well as what lasts
)
# The mean over the flights of a NEES of six degrees of freedom, +- 3.3 of its deviations.
BAND = 6.0 + 3.3 * np.array([-1.0, 1.0]) * np.sqrt(12.0 / FLIGHTS)


@dataclass(frozen=True, eq=False)
class Flight:
    """True poses and rates of each frame, and what the cameras say of them."""

    fusing: TwoCamerasOverTime
    truth: list[RigidTransform]
    rates: list[Floats]
    hand: list[Estimate | None]
    chaser: list[Estimate]
    read: Floats

    def said(self) -> list[Estimate]:
        return [
            self.fusing.process(at(n * STEP_S, frame(hand, chaser, self.read)))
            for n, (hand, chaser) in enumerate(zip(self.hand, self.chaser, strict=True))
        ]


def at(time_s: float, one: Frame) -> Frame:
    return replace(one, time_s=time_s)


def hand_of(chaser_from_target: RigidTransform) -> RigidTransform:
    return hand_from_chaser(ARM, JOINTS_DEG, HAND_FROM_TOOL) @ chaser_from_target @ BETWEEN


def drawn_flight(seed: int, lasting: float = OPTIONS.lasting_share) -> Flight:
    """Draw motion, the arm's errors and the cameras', of which a share is alike in all frames."""
    rng = np.random.default_rng(seed)
    read = JOINTS_DEG + SIGMAS["arm.joints_deg"] * rng.standard_normal(len(JOINTS_DEG))
    turn = np.deg2rad(SIGMAS["arm.mount_turn_deg"]) * rng.standard_normal(3)
    place = SIGMAS["arm.mount_place_m"] * rng.standard_normal(3)
    told = replace(TOLD, hand_from_tool=HAND_FROM_TOOL.perturbed(turn, place))
    limits = np.array([*3 * [np.deg2rad(OPTIONS.velocity_deg_s)], *3 * [OPTIONS.velocity_m_s]])
    pushes = np.array(
        [*3 * [np.deg2rad(OPTIONS.acceleration_deg_s2)], *3 * [OPTIONS.acceleration_m_s2]]
    ) * np.sqrt(OPTIONS.acceleration_lasts_s)
    pose, rates = CHASER_FROM_TARGET, 0.3 * limits * rng.standard_normal(6)
    kept = np.exp(-STEP_S / OPTIONS.lasting_s)
    alike = {"hand": rng.standard_normal(6), "chaser": rng.standard_normal(6)}
    truth, speeds, hand, chaser = [], [], [], []
    for number in range(FRAMES):
        if number:
            for _ in range(20):  # white accelerations, a tenth of a second each
                rates = rates + pushes * np.sqrt(STEP_S / 20) * rng.standard_normal(6)
                step = rates * STEP_S / 20
                pose = pose.perturbed(step[:3], step[3:])
            for name, error in alike.items():
                alike[name] = kept * error + np.sqrt(1.0 - kept**2) * rng.standard_normal(6)
        truth.append(pose)
        speeds.append(rates)
        time_s = number * STEP_S
        for name, of, covariance, kept_in in (
            ("hand", hand_of(pose), HAND, hand),
            ("chaser", pose, CHASER, chaser),
        ):
            drawn = np.sqrt(lasting) * alike[name] + np.sqrt(1 - lasting) * rng.standard_normal(6)
            away = np.linalg.cholesky(covariance) @ drawn
            kept_in.append(estimate(of.perturbed(away[:3], away[3:]), covariance, time_s))
    for number in range(DOTS_LOST, FRAMES):
        hand[number] = Estimate(number, number * STEP_S, reason="2 of 3 dots")
    fusing = TwoCamerasOverTime(told, SIGMAS, BETWEEN)
    return Flight(fusing, truth, speeds, list(hand), chaser, read)


def pose_of(said: Estimate) -> PoseEstimate:
    assert said.pose is not None, said.reason
    return said.pose


def state_covariance(state: NamedState) -> Floats:
    assert state.covariance is not None
    return state.covariance


@pytest.mark.parametrize("lasting", [0.0, OPTIONS.lasting_share])
def test_poses_and_rates_are_as_sure_as_they_say_whatever_lasts(lasting: float) -> None:
    """Before the dots are lost and after, whether errors are alike in all frames or drawn anew."""
    squares: dict[tuple[str, int], list[float]] = {}
    for seed in range(FLIGHTS):
        flight = drawn_flight(seed, lasting)
        said = flight.said()
        for number in (0, DOTS_LOST - 1, FRAMES - 1):
            one, truth = said[number], flight.truth[number]
            assert one.mode == ("both" if number < DOTS_LOST else "chaser")
            hand = pose_of(one)
            fixed, moving = one.states[CHASER_FIXED], one.states[RATES_STATE]
            pose = RigidTransform(
                fixed.values["R_cam_from_target"], fixed.values["t_cam_from_target_m"]
            )
            rates = np.concatenate(
                [moving.values["turn_rate_rad_s"], moving.values["velocity_m_s"]]
            )
            off = rates - flight.rates[number]
            for name, square in (
                ("hand", nees(hand.cam_from_target, hand.stated_covariance, hand_of(truth))),
                ("chaser", nees(pose, state_covariance(fixed), truth)),
                ("rates", float(off @ np.linalg.solve(state_covariance(moving), off))),
            ):
                squares.setdefault((name, number), []).append(square)
    for (name, number), drawn in squares.items():
        assert np.mean(drawn) < BAND[1], (name, number)
        if lasting and number == FRAMES - 1:
            assert np.mean(drawn) > DOUBTED * BAND[0], (name, number)


def test_the_arm_is_known_better_once_both_cameras_have_spoken() -> None:
    """When the dots are lost the hand's pose is surer than by the arm as it was told."""
    flight = drawn_flight(0)
    taught = pose_of(flight.said()[-1]).stated_covariance
    alone = drawn_flight(0)
    alone = replace(alone, hand=[None] * FRAMES)
    untaught = pose_of(alone.said()[-1]).stated_covariance
    assert np.trace(taught[3:, 3:]) < 0.8 * np.trace(untaught[3:, 3:])
    assert np.linalg.eigvalsh(untaught - taught)[0] > -1e-9


def test_what_lasts_is_not_averaged_away() -> None:
    """No number of frames makes a pose surer than the share that is alike in all of them."""
    flight = replace(drawn_flight(1), hand=[None] * FRAMES)
    said = flight.said()
    first, last = (
        np.diagonal(state_covariance(each.states[CHASER_FIXED])) for each in (said[0], said[-1])
    )
    floor = OPTIONS.lasting_share * np.exp(-2.0 * FRAMES * STEP_S / OPTIONS.lasting_s)
    assert (last > floor * np.diagonal(CHASER)).all()
    assert (last < first).all()


def test_neither_camera_speaking_is_bridged_less_and_less_surely_and_then_no_more() -> None:
    flight = drawn_flight(2)
    flight.said()
    dark, spread = FRAMES * STEP_S, []
    for ahead_s in (0.0, 10.0, 20.0):
        said = flight.fusing.process(at(dark + ahead_s, frame(None, None, flight.read)))
        assert said.mode == CARRIED
        spread.append(np.trace(pose_of(said).stated_covariance))
    assert spread == sorted(spread)
    assert spread[-1] > 4.0 * spread[0]
    late = flight.fusing.process(at(dark + 40.0, frame(None, None, flight.read)))
    assert late.pose is None
    assert late.reason is not None
    assert "no camera has had a pose for" in late.reason


def test_one_wrong_pose_is_refused_and_lasting_contradiction_ends_the_state() -> None:
    flight = drawn_flight(3)
    for number in (2, 5, 6, 7):
        off = hand_of(flight.truth[number]).perturbed([0.0, 0.1, 0.0], [0.0, 0.0, 0.05])
        flight.hand[number] = estimate(off, HAND, number * STEP_S)
    said = flight.said()
    assert [each.mode for each in said[1:9]] == [
        *("both", "chaser", "both", "both"),
        *("chaser", "chaser", "", "both"),
    ]
    assert said[7].pose is None
    assert said[7].reason is not None
    assert "contradict each other" in said[7].reason


def test_the_state_decides_between_a_pose_and_its_mirror() -> None:
    flight = drawn_flight(4)
    truth = hand_of(flight.truth[0])
    rival = {"R_cam_from_target": truth.rotation, "t_cam_from_target_m": truth.translation}
    mirror = truth.perturbed([0.0, 0.5, 0.0], [0.0, 0.0, 0.01])
    taken = replace(estimate(mirror, HAND), states={"rival_pose": NamedState(rival)})
    said = flight.fusing.process(at(0.0, frame(taken, flight.chaser[0], flight.read)))
    assert said.mode == "rival"
    away = difference(pose_of(said).cam_from_target, truth)
    assert np.abs(away).max() < 5.0 * np.sqrt(np.diagonal(HAND).max())


def test_poses_between_frames_are_taken_in_and_old_ones_refused() -> None:
    flight = drawn_flight(5)
    for each in flight.chaser[:5]:
        flight.fusing.take_in(each)
    said = flight.fusing.process(at(5 * STEP_S, frame(None, None, flight.read)))
    assert said.mode == CARRIED
    truth = flight.truth[5]
    assert nees(pose_of(said).cam_from_target, pose_of(said).stated_covariance, hand_of(truth)) < 40
    with pytest.raises(ValueError, match="expected a time from 10"):
        flight.fusing.take_in(flight.chaser[0])
