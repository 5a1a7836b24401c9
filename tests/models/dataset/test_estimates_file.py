from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from models.dataset.estimates_file import (
    estimate_from_json,
    estimate_to_json,
    read_estimates,
    read_runtimes,
    write_estimates,
    write_runtimes,
)
from models.errors import DatasetError
from models.estimate import Detections, Estimate, NoPose, PoseEstimate
from models.pose import RigidTransform, rotation_from_euler_321
from tests.support.strategies import rigid_transforms

NOTHING_FOUND = Detections(np.empty((0, 2)), np.empty((0, 2)), (), ())
FOUND = Detections(
    points_px=np.array([[10.25, 1 / 3], [1e-17, 2047.5]]),
    sigma_px=np.array([[0.05, 0.07], [0.1, 0.2]]),
    marker=(3, -1),
    used=(True, False),
)
POSE = PoseEstimate(
    frame=4,
    time_s=0.8,
    cam_from_target=RigidTransform(
        rotation_from_euler_321([179.9, 1.0, -2.0]), np.array([0.1, 1 / 3, 6.7])
    ),
    covariance=np.diag(np.arange(1.0, 7.0)) * 1e-7,
    detections=FOUND,
    residual_rms_px=0.07,
)
NO_POSE = NoPose(5, 1.0, "2 markers of the 4 needed \u2014 too dark", NOTHING_FOUND)


def assert_same(a: Estimate, b: Estimate) -> None:
    assert type(a) is type(b)
    assert (a.frame, a.time_s, a.status) == (b.frame, b.time_s, b.status)
    np.testing.assert_array_equal(a.detections.points_px, b.detections.points_px)
    np.testing.assert_array_equal(a.detections.sigma_px, b.detections.sigma_px)
    assert (a.detections.marker, a.detections.used) == (b.detections.marker, b.detections.used)
    if isinstance(a, NoPose) or isinstance(b, NoPose):
        assert isinstance(a, NoPose)
        assert isinstance(b, NoPose)
        assert a.reason == b.reason
        return
    np.testing.assert_array_equal(a.cam_from_target.rotation, b.cam_from_target.rotation)
    np.testing.assert_array_equal(a.cam_from_target.translation, b.cam_from_target.translation)
    np.testing.assert_array_equal(a.covariance, b.covariance)
    assert a.residual_rms_px == b.residual_rms_px


def finite_arrays(*shape: int) -> st.SearchStrategy[Any]:
    return arrays(np.float64, shape, elements=st.floats(-1e9, 1e9))


def test_a_pose_is_true_and_no_pose_is_false() -> None:
    assert POSE
    assert not NO_POSE


def test_estimates_come_back_bit_for_bit(tmp_path: Path) -> None:
    path = tmp_path / "estimates" / "best.jsonl"
    write_estimates(path, [POSE, NO_POSE])
    pose, no_pose = read_estimates(path)
    assert_same(pose, POSE)
    assert_same(no_pose, NO_POSE)


@given(
    rigid_transforms(), finite_arrays(6, 6), finite_arrays(3, 2), st.floats(0, 10), st.floats(0, 9)
)
def test_any_pose_survives_its_line(
    pose: RigidTransform, covariance: Any, points: Any, rms: float, time_s: float
) -> None:
    detections = Detections(points, np.abs(points), (0, 1, -1), (True, True, False))
    estimate = PoseEstimate(1, time_s, pose, covariance, detections, rms)
    assert_same(estimate, estimate_from_json(json.loads(json.dumps(estimate_to_json(estimate)))))


def test_reading_and_writing_again_gives_the_same_bytes(tmp_path: Path) -> None:
    first, second = tmp_path / "first.jsonl", tmp_path / "second.jsonl"
    write_estimates(first, [POSE, NO_POSE])
    write_estimates(second, read_estimates(first))
    assert first.read_bytes() == second.read_bytes()


def test_no_estimates_is_an_empty_file(tmp_path: Path) -> None:
    write_estimates(tmp_path / "none.jsonl", [])
    assert (tmp_path / "none.jsonl").read_bytes() == b""
    assert read_estimates(tmp_path / "none.jsonl") == []


def test_a_missing_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match=r"expected an estimates file at .*none; run the estim"):
        read_estimates(tmp_path / "absent.jsonl")


def broken(**changes: Any) -> str:
    record = estimate_to_json(POSE)
    for key, value in changes.items():
        if value is None:
            del record[key]
        else:
            record[key] = value
    return json.dumps(record)


@pytest.mark.parametrize(
    "line",
    [
        broken()[:-20],
        "[]",
        "null",
        broken(R_cam_from_target=None),
        broken(detections=None),
        broken(status="perhaps"),
        broken(covariance_rad_m=[1.0, 2.0]),
        broken(R_cam_from_target=[[2, 0, 0], [0, 2, 0], [0, 0, 2]]),
        broken(t_cam_from_target_m=[float("nan"), 0, 0]),
        broken(t_cam_from_target_m=[0, 0]),
        broken(residual_rms_px="small"),
        broken(frame=[]),
    ],
)
def test_a_line_that_is_no_estimate_is_named(tmp_path: Path, line: str) -> None:
    path = tmp_path / "estimates.jsonl"
    path.write_text(broken() + "\n" + line + "\n")
    with pytest.raises(DatasetError, match=r"estimates\.jsonl:2: expected one estimate .*again"):
        read_estimates(path)


def test_a_binary_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "estimates.jsonl"
    path.write_bytes(b"\x89PNG\xff\xfe")
    with pytest.raises(DatasetError, match="expected text at"):
        read_estimates(path)


def test_runtimes_come_back_to_the_microsecond_in_order_of_frames(tmp_path: Path) -> None:
    path = tmp_path / "runtimes.csv"
    write_runtimes(path, {7: 12.3456, 2: 1.0})
    assert path.read_text() == "frame,runtime_ms\n2,1.000\n7,12.346\n"
    assert read_runtimes(path) == {2: 1.0, 7: 12.346}


def test_absent_runtimes_are_none_and_broken_ones_an_error(tmp_path: Path) -> None:
    path = tmp_path / "runtimes.csv"
    assert read_runtimes(path) == {}
    for text in (
        "frame,runtime_ms\n1,2,3\n",
        "frame,runtime_ms\n1,fast\n",
        "frame,runtime_ms\n1\n",
    ):
        path.write_text(text)
        with pytest.raises(DatasetError, match=r"expected rows of frame,runtime_ms"):
            read_runtimes(path)
