"""The pipeline for an uncooperative target on simulated corners: found, followed, lost, found."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.errors import ScenarioError
from models.estimate import Estimate
from models.frame import Frame
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.relative_state import RelativeState, relative_state
from models.motion.tumble import CAM_FROM_LVLH, Tumble
from models.pose import pose_error
from pipelines.uncooperative.knowledge import (
    PointFrame,
    UncooperativeKnowledge,
    points_frame,
    seen,
)
from pipelines.uncooperative.pipeline import VARIANTS, Uncooperative, options_for
from tests.support.point_targets import (
    CAMERA,
    normalised_squared_error,
    seen_points,
    telescope_target,
)

SIGMA_PX = 2.0
TARGET = telescope_target()
KNOWLEDGE = UncooperativeKnowledge(CAMERA, TARGET, CAM_FROM_LVLH, SIGMA_PX)
TUMBLE = Tumble.from_case(
    KeplerOrbit.from_elements_deg(
        a_km=7143.1,
        e=1.4e-4,
        i_deg=98.2,
        raan_deg=79.2,
        argument_of_perigee_deg=85.9,
        true_anomaly_deg=0.0,
    ),
    rho0_m=(0.0, 30.0, 0.0),
    rho_dot0_m_s=(0.0, 1e-4, 0.0),
    omega_t0_deg_s=(0.5, -0.3, 0.2),
    inertia_kg_m2=np.diag([7000.0, 129000.0, 131000.0]),
    duration_s=400.0,
)
# Turned so that no axis of the target lies along the boresight at the start.
TUMBLE = replace(TUMBLE, R_lvlh_from_target=Rotation.from_rotvec([0.4, -0.7, 0.5]).as_matrix())
WRONG_M, WRONG_DEG = 1.0, 10.0
LONGEST_WRONG_FRAMES = 10


def frames(count: int, seed: int = 0, outliers: int = 1, start: int = 0) -> Iterator[Frame]:
    for index in range(start, start + count):
        rng = np.random.default_rng([seed, index])
        pose = TUMBLE.cam_from_target(float(index))
        points, _ = seen_points(TARGET, pose, rng, SIGMA_PX, outliers)
        yield points_frame(index, float(index), points, TUMBLE.chaser_state(float(index)))


def with_points(frame: Frame, points_px: Floats) -> Frame:
    return points_frame(frame.index, frame.time_s, points_px, seen(frame).chaser)


def points_of(frame: Frame) -> Floats:
    shown = seen(frame)
    assert isinstance(shown, PointFrame)
    return shown.points_px


def empty(frame: Frame) -> Frame:
    return with_points(frame, np.zeros((0, 2)))


def state_of(estimate: Estimate) -> RelativeState:
    state = relative_state(estimate)
    assert state is not None
    return state


def errors(estimate: Estimate) -> tuple[float, float]:
    """Return the filtered state's error of position in m and of attitude in deg."""
    truth = TUMBLE.cam_from_target(estimate.time_s)
    error = pose_error(state_of(estimate).cam_from_target(CAM_FROM_LVLH), truth)
    return float(np.linalg.norm(error.position_m)), error.attitude_deg


@pytest.fixture(scope="module")
def followed() -> list[Estimate]:
    pipeline = Uncooperative(KNOWLEDGE, options_for("best"))
    return [pipeline.process(frame) for frame in frames(120)]


def test_it_acquires_at_once_and_keeps_the_target(followed: list[Estimate]) -> None:
    assert [one.mode for one in followed] == ["acquired"] + ["tracked"] * 119
    for one in followed[20:]:
        moved, turned = errors(one)
        assert moved < 0.05
        assert turned < 1.0


def test_tracked_poses_are_as_good_as_they_say(followed: list[Estimate]) -> None:
    squared = []
    for one in followed:
        assert one.pose is not None
        truth = TUMBLE.cam_from_target(one.time_s)
        squared.append(
            normalised_squared_error(one.pose.cam_from_target, truth, one.pose.stated_covariance)
        )
    # chi2 with six degrees of freedom each: 3.3 sigmas of sqrt(12 / 120).
    assert abs(np.mean(squared) - 6.0) < 3.3 * np.sqrt(12.0 / len(squared))


def test_the_filters_beat_the_raw_pose(followed: list[Estimate]) -> None:
    raw, filtered = [], []
    for one in followed[40:]:
        assert one.pose is not None
        truth = TUMBLE.cam_from_target(one.time_s)
        raw.append(np.linalg.norm(one.pose.cam_from_target.translation - truth.translation))
        filtered.append(errors(one)[0])
    assert np.sqrt(np.mean(np.square(filtered))) < 0.5 * np.sqrt(np.mean(np.square(raw)))


def test_it_says_the_same_every_time(followed: list[Estimate]) -> None:
    pipeline = Uncooperative(KNOWLEDGE, options_for("best"))
    for frame, before in zip(frames(15), followed, strict=False):
        again, state = state_of(pipeline.process(frame)), state_of(before)
        assert (again.rho_in_lvlh == state.rho_in_lvlh).all()
        assert (again.R_lvlh_from_target == state.R_lvlh_from_target).all()


@pytest.mark.parametrize("variant", VARIANTS)
def test_a_start_that_is_given_saves_the_acquisition(variant: str) -> None:
    truth = TUMBLE.state(0.0)
    rng = np.random.default_rng(3)
    start = RelativeState(
        0.0,
        truth.rho_in_lvlh + 0.1 * rng.standard_normal(3),
        np.zeros(3),
        truth.R_lvlh_from_target @ Rotation.from_rotvec(0.01 * rng.standard_normal(3)).as_matrix(),
        np.zeros(3),
    )
    pipeline = Uncooperative(KNOWLEDGE, options_for(variant), start)
    estimates = [pipeline.process(frame) for frame in frames(40)]
    assert not any(one.mode in ("searching", "acquired") for one in estimates)
    assert sum(one.mode == "tracked" for one in estimates) >= 36
    moved, turned = errors(estimates[-1])
    assert moved < 0.15
    assert turned < 1.5


def test_it_goes_on_without_images_and_finds_the_target_again() -> None:
    pipeline = Uncooperative(KNOWLEDGE, options_for("best"))
    modes = []
    for frame in frames(60):
        blind = 20 <= frame.index < 25 or 35 <= frame.index < 50
        estimate = pipeline.process(empty(frame) if blind else frame)
        modes.append(estimate.mode)
        if blind:
            assert estimate.pose is None
            assert estimate.reason
    assert modes[20:25] == ["predicted"] * 5
    assert modes[25:35] == ["tracked"] * 10  # ten frames are not long enough to forget
    lost = options_for("best").lost_frames
    assert modes[35 : 35 + lost - 1] == ["predicted"] * (lost - 1)
    assert modes[35 + lost - 1 : 50] == ["searching"] * (50 - 35 - lost + 1)
    assert modes[50] == "acquired"
    assert modes[51:] == ["tracked"] * 9


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_wrong_pose_is_not_held(axis: int) -> None:
    """Half a turn about each axis: the wings fall on wings, and still it is found out."""
    truth = TUMBLE.state(0.0)
    half_turn = Rotation.from_rotvec(np.pi * np.eye(3)[axis]).as_matrix()
    start = replace(truth, R_lvlh_from_target=truth.R_lvlh_from_target @ half_turn)
    pipeline = Uncooperative(KNOWLEDGE, options_for("best"), start)
    held = 0
    for frame in frames(LONGEST_WRONG_FRAMES + 2):
        estimate = pipeline.process(frame)
        if not estimate.states:
            return
        moved, turned = errors(estimate)
        held += moved > WRONG_M or turned > WRONG_DEG
    assert held <= LONGEST_WRONG_FRAMES


def test_every_refusal_has_its_reason() -> None:
    pipeline = Uncooperative(KNOWLEDGE, options_for("best"))
    given = list(frames(12))
    for frame in given[:6]:
        assert pipeline.process(frame)
    clutter = np.random.default_rng(5).uniform(300.0, 1700.0, (25, 2))
    reasons = set()
    for frame, points in (
        (given[6], np.zeros((2, 2))),
        (given[7], clutter),
        (given[8], points_of(given[8])[:9]),
    ):
        estimate = pipeline.process(with_points(frame, points))
        if estimate.pose is None:
            assert estimate.mode == "predicted"
            assert not any(estimate.detected.used)
            reasons.add(estimate.reason)
    assert len(reasons) >= 2
    assert pipeline.process(given[9]).mode == "tracked"


def test_a_jump_is_refused_by_its_innovation() -> None:
    pipeline = Uncooperative(KNOWLEDGE, options_for("best"))
    for frame in frames(30):
        pipeline.process(frame)
    elsewhere = (
        CAM_FROM_LVLH
        @ replace(
            TUMBLE.state(30.0),
            rho_in_lvlh=TUMBLE.state(30.0).rho_in_lvlh + np.array([0.0, 0.8, 0.0]),
        ).lvlh_from_target
    )
    points, _ = seen_points(TARGET, elsewhere, np.random.default_rng(6), SIGMA_PX)
    estimate = pipeline.process(points_frame(30, 30.0, points, TUMBLE.chaser_state(30.0)))
    assert estimate.pose is None
    assert estimate.reason is not None
    assert "filters refuse" in estimate.reason
    assert estimate.mode == "predicted"
    assert errors(estimate)[0] < 0.1


def test_the_paper_variant_is_the_papers() -> None:
    paper, best = (options_for(variant) for variant in VARIANTS)
    assert paper.acquisition == "hypothesize_and_test"
    assert not paper.refine
    assert paper.navigation.translation == "h_infinity"
    assert paper.navigation.rotation == "minimum_energy"
    assert best.acquisition == "triple_search"
    assert best.refine


def test_unknown_settings_are_refused() -> None:
    with pytest.raises(ScenarioError, match="best"):
        options_for("bset")
    with pytest.raises(ScenarioError, match="share_to_believe"):
        replace(options_for("best"), share_to_believe=1.5)
    with pytest.raises(ScenarioError, match="lost_frames"):
        replace(options_for("best"), lost_frames=0)
