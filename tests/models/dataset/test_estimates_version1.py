"""Lines that version 1 wrote, typed by hand: they still read, and damage is still refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.dataset.estimates_file import read_estimates, write_estimates
from models.errors import DatasetError
from models.motion.relative_state import ROTATION, TRANSLATION, relative_state

IDENTITY = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
EYE = np.eye(6).tolist()
FOUND = {"points_px": [[1.0, 2.0]], "sigma_px": [[0.1, 0.2]], "marker": [4], "used": [True]}
NOTHING: dict[str, Any] = {"points_px": [], "sigma_px": [], "marker": [], "used": []}
POSE = {
    "status": "pose",
    "frame": 3,
    "time_s": 2.5,
    "detections": FOUND,
    "R_cam_from_target": IDENTITY,
    "t_cam_from_target_m": [0.1, 0.2, 6.7],
    "covariance_rad_m": EYE,
    "residual_rms_px": 0.25,
}
NO_POSE = {
    "status": "no pose",
    "frame": 4,
    "time_s": 2.75,
    "detections": NOTHING,
    "reason": "too dark",
}
STATE = {
    "time_s": 2.5,
    "rho_in_lvlh_m": [0.0, 30.0, 1 / 3],
    "rho_dot_in_lvlh_m_s": [1e-4, 0.0, 0.0],
    "R_lvlh_from_target": IDENTITY,
    "omega_target_wrt_lvlh_in_target_rad_s": [0.01, 0.0, 0.0],
}
TRACKED = {
    "frame": 3,
    "time_s": 2.5,
    "mode": "tracked",
    "pose": POSE,
    "state": STATE,
    "translation_covariance": EYE,
    "rotation_covariance": (2.0 * np.eye(6)).tolist(),
}
PREDICTED = {**TRACKED, "frame": 4, "time_s": 2.75, "mode": "predicted", "pose": NO_POSE}
SEARCHING = {
    "frame": 4,
    "time_s": 2.75,
    "mode": "searching",
    "pose": NO_POSE,
    "state": None,
    "translation_covariance": None,
    "rotation_covariance": None,
}


def written(folder: Path, *lines: dict[str, Any]) -> Path:
    path = folder / "best.jsonl"
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    return path


def test_poses_and_reasons_come_back(tmp_path: Path) -> None:
    pose, none = read_estimates(written(tmp_path, POSE, NO_POSE))
    assert (pose.frame, pose.time_s, pose.reason) == (3, 2.5, None)
    assert pose.pose is not None
    assert pose.pose.cam_from_target.translation.tolist() == [0.1, 0.2, 6.7]
    np.testing.assert_array_equal(pose.pose.stated_covariance, np.eye(6))
    assert pose.pose.residual_rms_px == 0.25
    assert pose.detected.marker == (4,)
    assert (none.frame, none.reason, none.pose) == (4, "too dark", None)
    assert none.detections is not None
    assert not pose.states
    assert not none.states


def test_relative_states_come_back(tmp_path: Path) -> None:
    tracked, predicted = read_estimates(written(tmp_path, TRACKED, PREDICTED))
    assert (tracked.mode, predicted.mode) == ("tracked", "predicted")
    assert tracked.pose is not None
    assert (predicted.pose, predicted.reason) == (None, "too dark")
    for estimate in (tracked, predicted):
        state = relative_state(estimate)
        assert state is not None
        assert state.rho_in_lvlh.tolist() == [0.0, 30.0, 1 / 3]
        np.testing.assert_array_equal(estimate.states[TRANSLATION].covariance, np.eye(6))
        np.testing.assert_array_equal(estimate.states[ROTATION].covariance, 2.0 * np.eye(6))
    (searching,) = read_estimates(written(tmp_path, SEARCHING))
    assert (searching.mode, searching.reason) == ("searching", "too dark")
    assert relative_state(searching) is None


def test_they_are_written_as_version_2(tmp_path: Path) -> None:
    path = written(tmp_path, TRACKED, PREDICTED)
    first = read_estimates(path)
    write_estimates(path, first)
    assert path.read_text().startswith('{"format": "rvbench-estimates", "version": 2}\n')
    before = path.read_bytes()
    write_estimates(path, read_estimates(path))
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ({**NO_POSE, "status": "perhaps"}, "unknown: status"),
        ({**NO_POSE, "status": None}, "unknown: status"),
        ({**NO_POSE, "reason": 5}, "reason to be text, got 5"),
        ({**NO_POSE, "R_cam_from_target": IDENTITY}, "unknown: R_cam_from_target"),
        ({**POSE, "frame": 4, "colour": "red"}, "unknown: colour"),
        ({**POSE, "frame": 4, "covariance_rad_m": [[1.0, 2.0]]}, "lists of 6 x 6 numbers"),
        ({**POSE}, "each frame once and in order, got 3 after 3"),
        ({**PREDICTED, "mode": 5}, "mode to be text"),
        ({**PREDICTED, "frame": 2.7}, "frame to be a whole number, got 2.7"),
        ({**PREDICTED, "state": {"time_s": 0.0}}, "missing: rho_in_lvlh_m"),
        ({**PREDICTED, "state": {**STATE, "bias": 1.0}}, "unknown: bias"),
        ({**PREDICTED, "state": 5}, "unknown: .*state"),
        ({**PREDICTED, "colour": "red"}, "unknown: colour"),
        ({**PREDICTED, "rotation_covariance": [[1.0, 2.0]]}, "got one of shape"),
        ({**PREDICTED, "pose": {"status": "pose"}}, "missing: R_cam_from_target"),
        ({**PREDICTED, "pose": 5}, "pose with keys and values|unknown: "),
    ],
)
def test_a_damaged_line_is_named(tmp_path: Path, line: dict[str, Any], said: str) -> None:
    with pytest.raises(DatasetError, match=rf"best\.jsonl:2: .*{said}"):
        read_estimates(written(tmp_path, POSE, line))


def test_a_state_without_covariances_has_none(tmp_path: Path) -> None:
    line = {**TRACKED, "translation_covariance": None}
    (estimate,) = read_estimates(written(tmp_path, line))
    assert estimate.states[TRANSLATION].covariance is None
    assert estimate.states[ROTATION].covariance is not None
