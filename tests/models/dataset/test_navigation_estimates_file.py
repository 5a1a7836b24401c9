"""What a pipeline says of a relative state goes to a file and back to the last bit."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from models.dataset.navigation_estimates_file import (
    navigation_estimate_from_json,
    navigation_estimate_to_json,
    read_navigation_estimates,
    state_from_json,
    state_to_json,
    write_navigation_estimates,
)
from models.uncooperative import NavigationEstimate

from models.errors import DatasetError
from models.estimate import Detections, NoPose, PoseEstimate
from models.motion.relative_state import RelativeState
from models.pose import RigidTransform
from tests.support.strategies import rigid_transforms, vectors

NOTHING = Detections(np.empty((0, 2)), np.empty((0, 2)), (), ())
CORNERS = Detections(np.array([[1 / 3, 7.0]]), np.array([[0.5, 0.5]]), (4,), (True,))
STATE = RelativeState(
    2.5, np.array([0.0, 30.0, 1 / 3]), np.array([1e-4, 0.0, -1e-17]), np.eye(3), np.ones(3) / 70.0
)
TRACKED = NavigationEstimate(
    frame=3,
    time_s=2.5,
    mode="tracked",
    pose=PoseEstimate(3, 2.5, RigidTransform.identity(), np.eye(6), CORNERS, 0.4),
    state=STATE,
    translation_covariance=np.diag(np.arange(6.0)) / 3.0,
    rotation_covariance=np.full((6, 6), 1e-9),
)
SEARCHING = NavigationEstimate(
    1,
    0.5,
    "searching",
    NoPose(1, 0.5, "too dark \u2014 12 of 30 corners", NOTHING),
    None,
    None,
    None,
)
PREDICTED = replace(TRACKED, frame=4, mode="predicted", pose=NoPose(4, 2.5, "hidden", NOTHING))


@given(rigid_transforms(), vectors(1.0), vectors(1.0), st.floats(0.0, 1e5))
def test_any_state_comes_back_to_the_last_bit(
    pose: RigidTransform, rate: np.ndarray, spin: np.ndarray, time_s: float
) -> None:
    state = RelativeState(time_s, pose.translation, rate, pose.rotation, spin)
    back = state_from_json(json.loads(json.dumps(state_to_json(state))))
    assert back.time_s == state.time_s
    for name in (
        "rho_in_lvlh",
        "rho_dot_in_lvlh",
        "R_lvlh_from_target",
        "omega_target_wrt_lvlh_in_target",
    ):
        np.testing.assert_array_equal(getattr(back, name), getattr(state, name))


def test_estimates_of_every_mode_come_back_and_are_written_the_same_again(tmp_path: Path) -> None:
    said = [SEARCHING, replace(TRACKED, frame=2, mode="acquired"), TRACKED, PREDICTED]
    path = tmp_path / "best.jsonl"
    write_navigation_estimates(path, said)
    back = read_navigation_estimates(path)
    assert [e.mode for e in back] == ["searching", "acquired", "tracked", "predicted"]
    assert [bool(e) for e in back] == [False, True, True, True]
    assert [bool(e.pose) for e in back] == [False, True, True, False]
    assert back[0].state is None
    assert back[0].translation_covariance is None
    np.testing.assert_array_equal(back[2].translation_covariance, TRACKED.translation_covariance)
    np.testing.assert_array_equal(back[2].rotation_covariance, TRACKED.rotation_covariance)
    assert back[2].pose.detections.marker == (4,)
    before = path.read_bytes()
    write_navigation_estimates(path, back)
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("mode", "guessing"),
        ("state", {"time_s": 0.0}),
        ("rotation_covariance", [[1.0, 2.0]]),
        ("pose", {"status": "pose"}),
    ],
)
def test_a_damaged_line_is_named(key: str, value: object, tmp_path: Path) -> None:
    lines = [navigation_estimate_to_json(TRACKED), navigation_estimate_to_json(TRACKED)]
    lines[1][key] = value
    path = tmp_path / "best.jsonl"
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    with pytest.raises(DatasetError, match=r"best\.jsonl:2: expected one navigation estimate"):
        read_navigation_estimates(path)
    with pytest.raises((KeyError, ValueError, TypeError)):
        navigation_estimate_from_json(lines[1])


def test_an_absent_file_says_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="run the estimate"):
        read_navigation_estimates(tmp_path / "best.jsonl")
