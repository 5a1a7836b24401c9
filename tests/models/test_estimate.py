"""An estimate says a pose, a state, or why neither; never both, never nothing."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

from models.estimate import Detections, Estimate, NamedState, PoseEstimate
from models.motion.relative_state import ROTATION, TRANSLATION, RelativeState, relative_state
from models.pose import RigidTransform

POSE = PoseEstimate(RigidTransform.identity(), np.eye(6), 0.1)
STATE = RelativeState(2.5, np.arange(3.0), np.ones(3), np.eye(3), np.full(3, 0.1))
STATES = STATE.named(np.eye(6), None)


def test_a_pose_or_a_state_is_true_and_a_reason_alone_false() -> None:
    assert Estimate(4, 2.5, POSE)
    assert Estimate(4, 2.5, reason="hidden", states=STATES)
    assert Estimate(4, 2.5, states=STATES)
    assert not Estimate(4, 2.5, reason="hidden")


def test_both_a_pose_and_a_reason_for_none_cannot_be() -> None:
    with pytest.raises(ValueError, match="frame 4: expected a pose or a reason for none, got both"):
        Estimate(4, 2.5, POSE, reason="hidden")


def test_an_estimate_that_says_nothing_cannot_be() -> None:
    with pytest.raises(ValueError, match="frame 4: expected a pose, a state or a reason"):
        Estimate(4, 2.5, mode="tracked")


def test_detections_that_are_not_told_of_are_none() -> None:
    found = Estimate(4, 2.5, POSE).detected
    assert found.points_px.shape == found.sigma_px.shape == (0, 2)
    assert found.marker == found.used == ()
    told = Detections(np.ones((1, 2)), np.ones((1, 2)), (3,), (True,))
    assert Estimate(4, 2.5, POSE, detections=told).detected is told


def test_a_covariance_that_is_not_stated_is_an_error_to_ask_for() -> None:
    assert POSE.stated_covariance is POSE.covariance
    with pytest.raises(ValueError, match="expected a pose with a covariance"):
        _ = PoseEstimate(POSE.cam_from_target).stated_covariance


def test_the_relative_state_comes_back_out_of_the_estimate() -> None:
    back = relative_state(Estimate(4, 2.5, states=STATES))
    assert back is not None
    assert vars(back).keys() == vars(STATE).keys()
    for name, value in vars(STATE).items():
        np.testing.assert_array_equal(getattr(back, name), value)
    assert relative_state(Estimate(4, 2.5, POSE)) is None
    for name in (TRANSLATION, ROTATION):
        assert relative_state(Estimate(4, 2.5, states={name: STATES[name]})) is None


@pytest.mark.parametrize("carried", [lambda x: pickle.loads(pickle.dumps(x)), copy.deepcopy])
@pytest.mark.parametrize(
    "estimate",
    [
        Estimate(4, 2.5, POSE),  # without states: the default may not be what cannot be sent
        Estimate(5, 2.5, reason="hidden", detections=Detections.none(), mode="predicted"),
        Estimate(6, 2.5, POSE, mode="tracked", states=STATES),
        Estimate(7, 2.5, states={"bias": NamedState({"bias_deg_s": np.ones((2, 3, 4))})}),
    ],
)
def test_an_estimate_goes_to_another_process_and_back(carried, estimate: Estimate) -> None:
    back = carried(estimate)
    assert (back.frame, back.time_s, back.reason, back.mode) == (
        estimate.frame,
        estimate.time_s,
        estimate.reason,
        estimate.mode,
    )
    assert (back.pose is None) == (estimate.pose is None)
    assert (back.detections is None) == (estimate.detections is None)
    assert back.states.keys() == estimate.states.keys()
    for name, state in estimate.states.items():
        for key, value in state.values.items():
            np.testing.assert_array_equal(back.states[name].values[key], value)
