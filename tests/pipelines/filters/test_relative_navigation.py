from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from models.arrays import Floats
from models.errors import ScenarioError
from models.estimate import Estimate, PoseEstimate
from models.motion.chaser_navigation import SIGMA_M, SIGMA_M_S, corrupted
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.relative_state import ChaserState, RelativeState
from models.motion.tumble import CAM_FROM_LVLH, Tumble
from models.pose import RigidTransform
from pipelines.filters.navigation_options import (
    BEST,
    PAPER,
    NavigationOptions,
    navigation_options_for,
)
from pipelines.filters.relative_navigation import FilteredState, RelativeNavigation
from pipelines.filters.rotation_process import turn_between

XMM = np.array([[7052.0, -820.0, -3991.0], [-820.0, 129129.0, 0.0], [-3991.0, 0.0, 131196.0]])
HISPASAT = np.array([[6396.0, 0.0, -46.0], [0.0, 3703.0, 0.0], [-46.0, 0.0, 5918.0]])
LEO = KeplerOrbit(7.1431e6, 1.4e-4, np.deg2rad(98.2), 1.38, 1.5, 0.0)
HEO = KeplerOrbit(6.69316e7, 0.808, np.deg2rad(69.9), 6.15, 1.68, np.deg2rad(30.0))
GEO = KeplerOrbit(4.21641e7, 1.1e-4, np.deg2rad(0.005), 4.8, 0.73, 0.0)
FRAMES = 200


def case(number: int) -> Tumble:
    """Return a case of Pesce et al. 2019, Table 4."""
    orbit, rho, rate, omega, inertia = {
        1: (LEO, 30.0, [0.0, 1e-4, 0.0], [0.1, 0.0, 0.0], XMM),
        2: (LEO, 30.0, [0.0, 1e-4, 0.0], [1.0, 0.0, 0.0], XMM),
        3: (LEO, 30.0, [0.0, 1e-4, 0.0], [0.5, -0.3, 0.2], XMM),
        4: (HEO, 30.0, [3e-3, -1e-3, 0.0], [0.1, 0.0, 0.0], XMM),
        5: (GEO, 40.0, [0.0, -1e-4, 0.0], [0.1, 0.0, 0.0], HISPASAT),
    }[number]
    return Tumble(
        orbit,
        np.array([0.0, rho, 0.0]),
        np.array(rate),
        np.deg2rad(omega),
        inertia,
        float(FRAMES),
    )


@cache
def truth(number: int) -> list[tuple[RelativeState, ChaserState]]:
    tumble = case(number)
    return [(tumble.state(float(k)), tumble.chaser_state(float(k))) for k in range(FRAMES + 1)]


def pose_noise() -> Floats:
    """Return a (6, 6) covariance like that of 24 corners of 2 px at 30 m: depth is the worst."""
    sigma = np.array([*np.deg2rad([0.16, 0.14, 0.05]), 0.008, 0.008, 0.043])
    covariance = np.diag(sigma**2)
    for i, j, share in ((0, 4, 0.3), (1, 3, -0.3), (0, 5, 0.2)):
        covariance[i, j] = covariance[j, i] = share * sigma[i] * sigma[j]
    return covariance


NOISE = pose_noise()
ROOT = np.linalg.cholesky(NOISE)


def measured(state: RelativeState, run: int, frame: int, scale: float = 1.0) -> Estimate:
    draw = scale * ROOT @ np.random.default_rng([3, run, frame]).standard_normal(6)
    pose = state.cam_from_target(CAM_FROM_LVLH).perturbed(draw[:3], draw[3:])
    return Estimate(frame, state.time_s, PoseEstimate(pose, NOISE, 2.0))


def pose_in(estimate: Estimate) -> RigidTransform:
    assert estimate.pose is not None
    return estimate.pose.cam_from_target


def moved(estimate: Estimate, pose: RigidTransform) -> Estimate:
    """Return an estimate that says another pose as sure as its own."""
    assert estimate.pose is not None
    return replace(estimate, pose=replace(estimate.pose, cam_from_target=pose))


def navigation(options: NavigationOptions, inertia: Floats | None = None) -> RelativeNavigation:
    return RelativeNavigation(
        options,
        CAM_FROM_LVLH,
        chaser_sigma_m=SIGMA_M,
        chaser_sigma_m_s=SIGMA_M_S,
        inertia_kg_m2=inertia,
    )


@dataclass
class Followed:
    """A run of frames: what was said, and errors by frame."""

    said: list[FilteredState]
    translation: Floats
    rotation: Floats
    raw_m: Floats
    raw_rad: Floats


@cache
def follow(
    number: int,
    options: NavigationOptions,
    *,
    run: int = 0,
    knows_inertia: bool = False,
    frames: int = FRAMES,
    scale: float = 1.0,
) -> Followed:
    filters = navigation(options, XMM if knows_inertia else None)
    said, translation, rotation, raw_m, raw_rad = [], [], [], [], []
    for k, (state, chaser) in enumerate(truth(number)[: frames + 1]):
        pose = measured(state, run, k, scale)
        believed = corrupted(chaser, seed=0, run=run, frame=k)
        if k == 0:
            now = filters.start_from_pose(pose, believed)
        else:
            filters.predict(state.time_s, believed)
            now = filters.update(pose)
        ours = now.state
        turn = turn_between(ours.R_lvlh_from_target, state.R_lvlh_from_target)
        rate = state.omega_target_wrt_lvlh_in_target - ours.omega_target_wrt_lvlh_in_target
        said.append(now)
        translation.append(
            np.concatenate(
                [state.rho_in_lvlh - ours.rho_in_lvlh, state.rho_dot_in_lvlh - ours.rho_dot_in_lvlh]
            )
        )
        rotation.append(np.concatenate([turn, rate]))
        right = state.cam_from_target(CAM_FROM_LVLH)
        raw_m.append(pose_in(pose).translation - right.translation)
        raw_rad.append(turn_between(pose_in(pose).rotation, right.rotation))
    return Followed(said, *map(np.array, (translation, rotation, raw_m, raw_rad)))


def rms(errors: Floats) -> float:
    return float(np.sqrt((errors[FRAMES // 2 :] ** 2).sum(axis=1).mean()))


@pytest.mark.parametrize("number", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("options", [PAPER, BEST], ids=["paper", "best"])
def test_it_beats_the_pose_that_feeds_it_and_its_gains_stay_positive(
    number: int, options: NavigationOptions
) -> None:
    found = follow(number, options)
    assert rms(found.translation[:, :3]) < 0.3 * rms(found.raw_m)
    assert rms(found.rotation[:, :3]) < 0.9 * rms(found.raw_rad)
    for now in found.said:
        assert np.linalg.eigvalsh(now.translation_covariance)[0] > 0.0
        assert np.linalg.eigvalsh(now.rotation_covariance)[0] > 0.0
    assert all(now.used_pose for now in found.said)
    assert not any(now.reason for now in found.said)  # H-infinity existed at every step


@pytest.mark.parametrize("number", [2, 3])
def test_the_inertia_pays(number: int) -> None:
    """A body at 1 deg/s, or about no axis of its own, accelerates; Euler's equation says how."""
    without = follow(number, BEST)
    knowing = follow(number, BEST, knows_inertia=True)
    assert rms(knowing.rotation[:, :3]) < 0.6 * rms(without.rotation[:, :3])


@pytest.mark.parametrize("number", [1, 3])
def test_the_minimum_energy_filter_is_as_good_as_the_mekf(number: int) -> None:
    """Neither is better by a tenth: the second order pays only far from the truth."""
    energy = follow(number, replace(BEST, rotation="minimum_energy"))
    mekf = follow(number, BEST)
    assert rms(energy.rotation[:, :3]) == pytest.approx(rms(mekf.rotation[:, :3]), rel=0.1)
    assert rms(energy.rotation[:, 3:]) == pytest.approx(rms(mekf.rotation[:, 3:]), rel=0.1)


def test_its_errors_are_as_large_as_it_says_and_no_smaller_than_its_bound() -> None:
    """Over runs, at the last frame: NEES against what it says, and against perfect knowledge."""
    runs, frames = 30, 25
    exact = replace(BEST, acceleration_m_s2=0.0, inertia_accuracy=0.0)
    nees, beyond_bound = [], []
    for run in range(runs):
        found = follow(3, exact, run=run, knows_inertia=True, frames=frames)
        last = found.said[-1]
        place, turn = found.translation[-1], found.rotation[-1]
        nees.append(
            [
                place @ np.linalg.solve(last.translation_covariance, place),
                turn @ np.linalg.solve(last.rotation_covariance, turn),
            ]
        )
        if run == 0:  # what noise-free poses of the same covariance would leave open
            bound = follow(3, exact, run=0, knows_inertia=True, frames=frames, scale=0.0).said[-1]
        beyond_bound.append(place @ np.linalg.solve(bound.translation_covariance, place))
    low, high = chi2.ppf([0.0005, 0.9995], 6 * runs) / runs
    assert ((low < np.mean(nees, axis=0)) & (np.mean(nees, axis=0) < high)).all()
    assert np.mean(beyond_bound) > low


def test_a_wrong_pose_is_refused_and_changes_nothing() -> None:
    filters = navigation(BEST)
    for k, (state, chaser) in enumerate(truth(1)[:20]):
        if k == 0:
            filters.start_from_pose(measured(state, 0, k), chaser)
            continue
        predicted = filters.predict(state.time_s, chaser)
        pose = measured(state, 0, k)
        if k in (15, 16):
            wrong = pose_in(pose).perturbed([0.0, 0.0, np.pi / 2.2], [0.0, 0.0, 0.1])
            now = filters.update(moved(pose, wrong))
            assert not now.used_pose
            assert "innovation squared" in now.reason
            assert now.refused_in_row == k - 14
            assert now.since_pose_s == pytest.approx(k - 14.0)
            np.testing.assert_array_equal(now.state.rho_in_lvlh, predicted.state.rho_in_lvlh)
            np.testing.assert_array_equal(now.rotation_covariance, predicted.rotation_covariance)
            assert now.rotation_nis is not None
            assert now.rotation_nis > BEST.gate
        else:
            now = filters.update(pose)
            assert now.used_pose
            assert now.refused_in_row == 0


def test_the_paper_takes_every_pose_but_one_turned_round() -> None:
    filters = navigation(PAPER)
    first, chaser = truth(1)[0]
    filters.start_from_pose(measured(first, 0, 0), chaser)
    state, chaser = truth(1)[1]
    filters.predict(1.0, chaser)
    pose = measured(state, 0, 1)
    turned = moved(pose, pose_in(pose).perturbed([0, 0, 2.0], np.zeros(3)))
    assert "right angle" in filters.update(turned).reason
    off = moved(pose, pose_in(pose).perturbed([0, 0, 0.5], [1.0, 0, 0]))
    assert filters.update(off).used_pose


@pytest.mark.parametrize("options", [PAPER, BEST], ids=["paper", "best"])
def test_without_poses_it_coasts_and_says_how_unsure_it_is(options: NavigationOptions) -> None:
    filters = navigation(options, XMM)
    for k, (state, chaser) in enumerate(truth(3)[:101]):
        if k == 0:
            now = filters.start_from_pose(measured(state, 0, k), chaser)
            continue
        now = filters.predict(state.time_s, corrupted(chaser, seed=0, run=0, frame=k))
        if k <= 60:
            last = now = filters.update(measured(state, 0, k))
    state, _ = truth(3)[100]
    assert now.since_pose_s == pytest.approx(40.0)
    assert not now.used_pose
    grown = np.diag(now.translation_covariance) / np.diag(last.translation_covariance)
    assert (grown[:3] > 1.0).all()
    off = (state.rho_in_lvlh - now.state.rho_in_lvlh) / np.sqrt(
        np.diag(now.translation_covariance)[:3]
    )
    turn = turn_between(now.state.R_lvlh_from_target, state.R_lvlh_from_target)
    assert np.abs(off).max() < 5.0
    assert np.abs(turn / np.sqrt(np.diag(now.rotation_covariance)[:3])).max() < 5.0


def test_a_pose_becomes_a_state_whatever_the_camera_mount() -> None:
    mount = RigidTransform(
        Rotation.from_rotvec([0.2, 1.0, -0.5]).as_matrix(), np.array([0.5, -1.0, 2.0])
    )
    state, chaser = truth(3)[7]
    pose = Estimate(7, 7.0, PoseEstimate(state.cam_from_target(mount), NOISE, 1.0))
    begun = RelativeNavigation(BEST, mount).start_from_pose(pose, chaser)
    np.testing.assert_allclose(begun.state.rho_in_lvlh, state.rho_in_lvlh, atol=1e-12)
    np.testing.assert_allclose(begun.state.R_lvlh_from_target, state.R_lvlh_from_target, atol=1e-14)
    back = begun.pose_covariance(mount)
    np.testing.assert_allclose(back[:3, :3], NOISE[:3, :3], atol=1e-18)
    np.testing.assert_allclose(back[3:, 3:], NOISE[3:, 3:], atol=1e-18)
    assert begun.used_pose


def test_its_turn_covariance_is_that_of_poses_drawn() -> None:
    """The pose turns on the left in camera axes, the state on the right in target axes."""
    state, chaser = truth(3)[100]
    begun = navigation(BEST).start_from_pose(measured(state, 0, 100), chaser)
    turns = np.array(
        [
            turn_between(
                state.R_lvlh_from_target,
                (CAM_FROM_LVLH.inverse() @ pose_in(measured(state, run, 100))).rotation,
            )
            for run in range(400)
        ]
    )
    expected = begun.rotation_covariance[:3, :3]
    sigma = np.sqrt(np.diag(expected))
    spread = 5.0 * np.sqrt(2.0 / 400)  # five sigmas of a drawn covariance, relative
    np.testing.assert_allclose(
        np.cov(turns.T) / np.outer(sigma, sigma), expected / np.outer(sigma, sigma), atol=spread
    )


def test_where_h_infinity_does_not_exist_kalman_steps_in_and_it_says_so() -> None:
    filters = navigation(replace(PAPER, theta_share=0.9, start_sigma_m_s=10.0))
    state, chaser = truth(1)[0]
    filters.start_from_pose(measured(state, 0, 0), chaser)
    later, chaser = truth(1)[1]
    filters.predict(1.0, chaser)
    said = filters.update(measured(later, 0, 1))
    assert said.used_pose
    assert "Kalman for once: theta" in said.reason
    assert np.linalg.eigvalsh(said.translation_covariance)[0] > 0.0


def test_a_negative_forgetting_is_the_papers_alpha_and_overconfident() -> None:
    """The printed ``-alpha K`` shrinks the gain between images; positive forgets."""
    spread = {
        rate: np.trace(
            follow(1, replace(PAPER, forgetting_per_s=rate), frames=60).said[-1].rotation_covariance
        )
        for rate in (-0.05, 0.0, 0.05)
    }
    assert spread[-0.05] < spread[0.0] < spread[0.05]


def test_frames_out_of_order_are_refused() -> None:
    filters = navigation(BEST)
    state, chaser = truth(1)[5]
    assert not filters.started
    with pytest.raises(ValueError, match="call start or start_from_pose first"):
        filters.predict(5.0, chaser)
    filters.start(state, chaser)
    assert filters.started
    with pytest.raises(ValueError, match="frames go forward in time"):
        filters.predict(4.0, chaser)
    filters.predict(6.0, chaser)
    with pytest.raises(ValueError, match="predict first"):
        filters.update(measured(state, 0, 5))


def test_a_start_keeps_its_state() -> None:
    state, chaser = truth(3)[5]
    begun = navigation(BEST, XMM).start(state, chaser)
    np.testing.assert_allclose(begun.state.rho_dot_in_lvlh, state.rho_dot_in_lvlh)
    np.testing.assert_allclose(
        begun.state.omega_target_wrt_lvlh_in_target,
        state.omega_target_wrt_lvlh_in_target,
        atol=1e-15,
    )


def test_settings_are_checked() -> None:
    assert navigation_options_for("paper") is PAPER
    assert navigation_options_for("best") is BEST
    with pytest.raises(ScenarioError, match="among paper, best, got 'good'"):
        navigation_options_for("good")
    with pytest.raises(ScenarioError, match=r"theta_share in \[0, 1\)"):
        NavigationOptions(theta_share=1.0)
    with pytest.raises(ScenarioError, match="gate finite and not below zero"):
        NavigationOptions(gate=-1.0)
    assert NavigationOptions(forgetting_per_s=-0.1).forgetting_per_s == -0.1
