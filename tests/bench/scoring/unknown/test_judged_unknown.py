"""Judged up to one turn of the axes: what is right but for that is right, and nothing else is."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bench.scoring.limits import Limits
from bench.scoring.unknown.judged_unknown import (
    TrueUnknown,
    judge_run,
    second_half,
    true_rate,
)
from models.errors import DatasetError
from models.estimate import Estimate, NamedState, PoseEstimate
from models.motion.tumble import CAM_FROM_LVLH
from models.pose import RigidTransform
from pipelines.unknown_target.pipeline import MOTION
from renders.truth.image_truth import ImageTruth
from tests.support.synthetic_images import small_tumble

FRAMES = 12
OWN_AXES = Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix()  # true_from_own


@dataclass(frozen=True)
class Run:
    estimates: dict[int, Estimate]
    number: int = 0


@pytest.fixture(scope="module")
def truths() -> dict[int, ImageTruth]:
    tumble = small_tumble(60.0)
    found = {}
    for frame in range(FRAMES):
        state = tumble.state(5.0 * frame)
        found[frame] = ImageTruth(
            frame, 5.0 * frame, state.cam_from_target(CAM_FROM_LVLH), state,
            tumble.chaser_state(5.0 * frame), np.ones(3), np.ones(3), np.zeros((0, 2)),
            np.zeros(0, dtype=bool),
        )  # fmt: skip
    return found


def said(truth: ImageTruth, scale: float = 1.0, rate_rad_s: float = 0.0) -> Estimate:
    """Return the truth in the pipeline's own axes, scaled, with a rate that is off along x."""
    pose = RigidTransform(
        truth.cam_from_target.rotation @ OWN_AXES, scale * truth.cam_from_target.translation
    )
    omega = OWN_AXES.T @ (true_rate(truth) + np.array([rate_rad_s, 0.0, 0.0]))
    motion = NamedState(
        {
            "rho_in_lvlh_m": -scale * truth.state.rho_in_lvlh,
            "rho_dot_in_lvlh_m_s": -truth.state.rho_dot_in_lvlh,
            "omega_in_target_rad_s": omega,
        },
        1e-6 * np.eye(12),
    )
    posed = PoseEstimate(pose, 1e-6 * np.eye(6))
    return Estimate(truth.frame, truth.time_s, posed, states={MOTION: motion})


def judged(truths, **changes):
    dataset = SimpleNamespace(indices=sorted(truths))
    known = TrueUnknown(dataset, truths, {}, Limits())
    return judge_run(Run({k: said(truth, **changes) for k, truth in truths.items()}), known)


def test_the_turn_of_the_axes_is_no_error(truths):
    for each in judged(truths):
        assert each.position_m == pytest.approx(0.0, abs=1e-9)
        assert each.attitude_deg == pytest.approx(0.0, abs=1e-5)
        assert each.motion.rate_deg_s == pytest.approx(0.0, abs=1e-9)
        assert each.motion.axis_deg == pytest.approx(0.0, abs=1e-5)
        assert each.motion.velocity_m_s == pytest.approx(0.0, abs=1e-12)
        assert not each.wrong


def test_a_scale_is_an_error_of_the_distance(truths):
    one = judged(truths, scale=1.02)[3]
    assert one.motion.range_share == pytest.approx(0.02)
    assert one.position_m == pytest.approx(0.02 * one.range_m)
    assert one.attitude_deg == pytest.approx(0.0, abs=1e-5)


def test_a_rate_that_is_off_is_told(truths):
    off = np.deg2rad(0.01)
    one = second_half(judged(truths, rate_rad_s=off))[-1]
    true = true_rate(truths[FRAMES - 1])
    told = true + np.array([off, 0.0, 0.0])
    assert one.rate_deg_s == pytest.approx(0.01)
    cosine = true @ told / (np.linalg.norm(true) * np.linalg.norm(told))
    assert one.axis_deg == pytest.approx(np.rad2deg(np.arccos(cosine)), rel=1e-3)


def test_the_true_rate_is_that_of_the_true_attitudes(truths):
    """Differences of the inertial attitude, which knows nothing of Euler's equations here."""
    tumble, step_s = small_tumble(60.0), 0.01
    ends = [
        tumble.orbit.inertial_from_lvlh(t) @ tumble.state(t).R_lvlh_from_target
        for t in (20.0 - step_s, 20.0 + step_s)
    ]
    turned = Rotation.from_matrix(ends[0].T @ ends[1]).as_rotvec() / (2.0 * step_s)
    np.testing.assert_allclose(true_rate(truths[4]), turned, atol=1e-8)


def test_a_frame_without_a_pose_is_missed_once_there_was_one(truths):
    estimates = {k: said(truth) for k, truth in truths.items()}
    for k in (0, 7):
        estimates[k] = Estimate(k, 5.0 * k, reason="dark")
    dataset = SimpleNamespace(indices=sorted(truths))
    found = judge_run(Run(estimates), TrueUnknown(dataset, truths, {}, Limits()))
    assert [each.missed for each in found] == [k == 7 for k in range(FRAMES)]
    assert found[0].position_m is None


def test_a_state_of_another_shape_is_refused(truths):
    estimates = {k: said(truth) for k, truth in truths.items()}
    states = {MOTION: NamedState({"rho_in_lvlh_m": np.zeros(2)})}
    estimates[2] = Estimate(2, 10.0, estimates[2].pose, states=states)
    dataset = SimpleNamespace(indices=sorted(truths))
    with pytest.raises(DatasetError, match="expected the state relative_motion with"):
        judge_run(Run(estimates), TrueUnknown(dataset, truths, {}, Limits()))
