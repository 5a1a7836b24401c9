"""What a pipeline says goes to a file and back to the last bit; what cannot be does not."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from models.arrays import Floats
from models.dataset.estimates_file import (
    estimate_from_json,
    estimate_to_json,
    impossible,
    read_estimates,
    read_runtimes,
    write_estimates,
    write_runtimes,
)
from models.dataset.named_states import LARGEST
from models.errors import DatasetError
from models.estimate import Detections, Estimate, NamedState, PoseEstimate
from models.motion.relative_state import RelativeState, relative_state
from models.pose import RigidTransform, rotation_from_euler_321
from models.reading.bounds import FRAME, POINT_PX, SIGMA_PX, TIME_S
from tests.support.strategies import rigid_transforms, vectors

FOUND = Detections(
    points_px=np.array([[10.25, 1 / 3], [1e-17, 2047.5]]),
    sigma_px=np.array([[0.05, 0.07], [0.1, 0.2]]),
    marker=(3, -1),
    used=(True, False),
)
STATE = RelativeState(
    0.8, np.array([0.0, 30.0, 1 / 3]), np.array([1e-4, 0.0, -1e-17]), np.eye(3), np.ones(3) / 70.0
)
STATES = STATE.named(np.diag(np.arange(6.0)) / 3.0, np.full((6, 6), 1e-9))
POSE = Estimate(
    frame=4,
    time_s=0.8,
    pose=PoseEstimate(
        cam_from_target=RigidTransform(
            rotation_from_euler_321([179.9, 1.0, -2.0]), np.array([0.1, 1 / 3, 6.7])
        ),
        covariance=np.diag(np.arange(1.0, 7.0)) * 1e-7,
        residual_rms_px=0.07,
        wrong_probability=1 / 300,
    ),
    detections=FOUND,
)
NO_POSE = Estimate(
    5, 1.0, reason="2 markers of the 4 needed \u2014 too dark", detections=Detections.none()
)
TRACKED = replace(POSE, frame=6, time_s=1.0, mode="tracked", states=STATES)
PREDICTED = replace(NO_POSE, frame=7, time_s=1.5, mode="predicted", states=STATES)


def assert_same(a: Estimate, b: Estimate) -> None:
    assert (a.frame, a.time_s, a.reason, a.mode) == (b.frame, b.time_s, b.reason, b.mode)
    assert (a.pose is None) == (b.pose is None)
    assert (a.detections is None) == (b.detections is None)
    np.testing.assert_array_equal(a.detected.points_px, b.detected.points_px)
    np.testing.assert_array_equal(a.detected.sigma_px, b.detected.sigma_px)
    assert (a.detected.marker, a.detected.used) == (b.detected.marker, b.detected.used)
    if a.pose is not None and b.pose is not None:
        ours, theirs = a.pose.cam_from_target, b.pose.cam_from_target
        assert ours.matrix().tobytes() == theirs.matrix().tobytes()
        assert_same_or_none(a.pose.covariance, b.pose.covariance)
        assert a.pose.residual_rms_px == b.pose.residual_rms_px
        assert a.pose.wrong_probability == b.pose.wrong_probability
    assert a.states.keys() == b.states.keys()
    for name, state in a.states.items():
        assert_same_or_none(state.covariance, b.states[name].covariance)
        assert state.values.keys() == b.states[name].values.keys()
        for key, value in state.values.items():
            np.testing.assert_array_equal(value, b.states[name].values[key])


def assert_same_or_none(a: Floats | None, b: Floats | None) -> None:
    assert (a is None) == (b is None)
    if a is not None:
        np.testing.assert_array_equal(a, b)


# What is written comes back.


def of_size(*shape: int | None, low: float, high: float) -> st.SearchStrategy[Floats]:
    return arrays(np.float64, shape, elements=st.floats(low, high))


def covariances(size: int) -> st.SearchStrategy[Floats]:
    """Exactly symmetric, no variance below one: beside it rounding is far from the door's limit."""
    factors = arrays(np.float64, (size, size), elements=st.floats(-10.0, 10.0))
    return factors.map(lambda factor: _symmetric(factor @ factor.T + np.eye(size)))


def _symmetric(matrix: Floats) -> Floats:
    return np.triu(matrix) + np.triu(matrix, 1).T


@st.composite
def detections(draw: st.DrawFn) -> Detections:
    count = draw(st.integers(0, 4))
    return Detections(
        draw(of_size(count, 2, low=POINT_PX[0], high=POINT_PX[1])),
        draw(of_size(count, 2, low=SIGMA_PX[0], high=SIGMA_PX[1])),
        tuple(draw(st.lists(st.integers(-1, 400), min_size=count, max_size=count))),
        tuple(draw(st.lists(st.booleans(), min_size=count, max_size=count))),
    )


TEXT = st.text(st.characters(codec="utf-8", categories=("L", "N", "P", "S")), max_size=30)
POSES = st.builds(
    PoseEstimate,
    rigid_transforms(),
    st.none() | covariances(6),
    st.none() | st.floats(0.0, POINT_PX[1]),
)
FREE_STATES = st.builds(
    NamedState,
    st.dictionaries(
        st.from_regex("[a-z][a-z_]{0,9}", fullmatch=True),
        arrays(
            np.float64, array_shapes(min_dims=0, max_dims=3), elements=st.floats(-LARGEST, LARGEST)
        ),
        min_size=1,
        max_size=3,
    ),
    st.none() | covariances(3),
)


@st.composite
def estimates(draw: st.DrawFn) -> Estimate:
    pose = draw(st.none() | POSES)
    return Estimate(
        frame=draw(st.integers(*FRAME)),
        time_s=draw(st.floats(*TIME_S)),
        pose=pose,
        reason=None if pose is not None else draw(TEXT),
        detections=draw(st.none() | detections()),
        mode=draw(TEXT),
        states=draw(st.dictionaries(TEXT.filter(bool).map("x{}".format), FREE_STATES, max_size=3)),
    )


@settings(max_examples=50, suppress_health_check=[HealthCheck.too_slow])
@given(estimates())
def test_any_estimate_comes_back_to_the_last_bit(said: Estimate) -> None:
    back = estimate_from_json(json.loads(json.dumps(estimate_to_json(said))), "here")
    assert_same(back, said)
    assert impossible(said) is None


@given(rigid_transforms(), vectors(1.0), vectors(1.0), st.floats(0.0, 1e5), covariances(6))
def test_any_relative_state_comes_back_to_the_last_bit(
    pose: RigidTransform, rate: Floats, spin: Floats, time_s: float, covariance: Floats
) -> None:
    state = RelativeState(time_s, pose.translation, rate, pose.rotation, spin)
    said = Estimate(1, time_s, states=state.named(covariance, None))
    back = estimate_from_json(json.loads(json.dumps(estimate_to_json(said))), "here")
    assert_same(back, said)
    again = relative_state(back)
    assert again is not None
    for name, value in vars(state).items():
        np.testing.assert_array_equal(getattr(again, name), value)


def test_estimates_of_every_kind_come_back_and_are_written_the_same_again(tmp_path: Path) -> None:
    path = tmp_path / "estimates" / "best.jsonl"
    said = [POSE, NO_POSE, TRACKED, PREDICTED]
    write_estimates(path, said)
    back = read_estimates(path)
    assert [bool(estimate) for estimate in back] == [True, False, True, True]
    for ours, theirs in zip(said, back, strict=True):
        assert_same(ours, theirs)
    before = path.read_bytes()
    write_estimates(path, back)
    assert path.read_bytes() == before


def test_the_first_line_says_what_the_file_is(tmp_path: Path) -> None:
    path = tmp_path / "best.jsonl"
    write_estimates(path, [])
    assert path.read_text() == '{"format": "rvbench-estimates", "version": 2}\n'
    assert read_estimates(path) == []
    for version in ("3", "true", "null", "2.5"):
        path.write_text(f'{{"format": "rvbench-estimates", "version": {version}}}\n')
        with pytest.raises(DatasetError, match="expected rvbench-estimates version 2, got version"):
            read_estimates(path)


def test_an_empty_file_is_of_no_estimates(tmp_path: Path) -> None:
    (tmp_path / "none.jsonl").write_bytes(b"")
    assert read_estimates(tmp_path / "none.jsonl") == []


def test_a_covariance_is_made_exactly_symmetric_and_then_stays(tmp_path: Path) -> None:
    """Inverting leaves the last bits of a covariance askew; reading takes that out, once."""
    draw = np.random.default_rng(5).standard_normal((6, 9))
    askew = np.linalg.inv(draw @ draw.T)
    askew[0, 1] *= 1.0 + 1e-12
    assert POSE.pose is not None
    write_estimates(
        tmp_path / "a.jsonl", [replace(POSE, pose=replace(POSE.pose, covariance=askew))]
    )
    (once,) = read_estimates(tmp_path / "a.jsonl")
    assert once.pose is not None
    covariance = once.pose.stated_covariance
    np.testing.assert_array_equal(covariance, covariance.T)
    np.testing.assert_allclose(covariance, askew, rtol=1e-11)
    write_estimates(tmp_path / "b.jsonl", [once])
    assert_same(read_estimates(tmp_path / "b.jsonl")[0], once)


# What cannot be is refused.


def test_a_missing_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match=r"expected an estimates file at .*estimate again"):
        read_estimates(tmp_path / "absent.jsonl")


def test_a_binary_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "estimates.jsonl"
    path.write_bytes(b"\x89PNG\xff\xfe")
    with pytest.raises(DatasetError, match=r"estimates\.jsonl, got: .*no UTF-8"):
        read_estimates(path)


def changed(keys: str, value: Any, said: Estimate = TRACKED) -> str:
    """Return a line with one value exchanged, by its keys with dots between; ... takes it out."""
    record = estimate_to_json(said)
    *path, last = keys.split(".")
    inner = record
    for key in path:
        inner = inner[key]
    if value is ...:
        del inner[last]
    else:
        inner[last] = value
    return json.dumps(record)


EYE = np.eye(6)
ROTATION_VALUES = "states.relative_rotation.values"
TRANSLATION_STATE = "states.relative_translation"
LINES: dict[str, tuple[str, str]] = {
    "cut short": (json.dumps(estimate_to_json(POSE))[:-20], "no JSON"),
    "a list": ("[]", r"expected a table .*, got \[\]"),
    "null": ("null", "expected a table .*, got None"),
    "empty": ("", "no JSON"),
    "a key twice": ('{"frame": 6, "frame": 7, "time_s": 1.0, "reason": "x"}', "'frame' twice"),
    "nested": ('{"frame":' + "[" * 5000 + "]" * 5000 + "}", "nested more than 32 deep"),
    "an unknown key": (changed("colour", "red"), "unknown: colour"),
    "no frame": (changed("frame", ...), "missing: frame"),
    "a frame of 2.7": (changed("frame", 2.7), "frame to be a whole number, got 2.7"),
    "a frame of 6.0": (changed("frame", 6.0), "frame to be a whole number, got 6.0"),
    "a frame that is true": (changed("frame", True), "frame to be a whole number, got True"),
    "a frame below zero": (changed("frame", -3), "frame of at least 0"),
    "a frame that is a list": (changed("frame", []), "frame to be a whole number"),
    "time 1e200": (changed("time_s", 1e200), "time_s of at least .*, got 1e.200"),
    "time NaN": (changed("time_s", float("nan")), "expected finite numbers, got NaN"),
    "time as text": (changed("time_s", "1.0"), "time_s to be a number, got '1.0'"),
    "no word": (changed("mode", 5), "mode to be text, got 5"),
    "a long word": (changed("mode", "x" * 1000), "mode of at most 200 characters, got 1000"),
    "a pose and a reason": (changed("reason", "dark"), "a pose or a reason for none, got both"),
    "nothing at all": ('{"frame": 6, "time_s": 1.0}', "expected a pose, a state or a reason"),
    "a rotation missing": (changed("pose.R_cam_from_target", ...), "missing: R_cam_from_target"),
    "no rotation": (
        changed("pose.R_cam_from_target", (2.0 * np.eye(3)).tolist()),
        "pose.R_cam_from_target as a rotation matrix",
    ),
    "a mirror": (
        changed("pose.R_cam_from_target", np.diag([1.0, 1.0, -1.0]).tolist()),
        "pose.R_cam_from_target as a rotation matrix, got one with .* determinant -1",
    ),
    "a translation NaN": (
        changed("pose.t_cam_from_target_m", [float("nan"), 0, 0]),
        "expected finite numbers, got NaN",
    ),
    "a translation of two": (changed("pose.t_cam_from_target_m", [0, 0]), "lists of 3 numbers"),
    "a translation too far": (changed("pose.t_cam_from_target_m", [0, 0, 1e7]), "at most 1e.06"),
    "a covariance negated": (
        changed("pose.covariance_rad_m", (-EYE).tolist()),
        "pose.covariance_rad_m as a covariance, got one with a variance of -1",
    ),
    "a covariance NaN": (
        changed("pose.covariance_rad_m", np.diag([np.nan] * 6).tolist()),
        "expected finite numbers, got NaN",
    ),
    "a covariance that is none": (
        changed("pose.covariance_rad_m", (EYE - 0.5 * np.ones((6, 6))).tolist()),
        "pose.covariance_rad_m as a covariance, got one whose least eigenvalue",
    ),
    "a covariance askew": (
        changed("pose.covariance_rad_m", (EYE + np.eye(6, k=1)).tolist()),
        "pose.covariance_rad_m as a covariance, got one that is not symmetric",
    ),
    "a covariance of two": (
        changed("pose.covariance_rad_m", [1.0, 2.0]),
        "pose.covariance_rad_m as lists of 6 x 6 numbers",
    ),
    "a residual below zero": (changed("pose.residual_rms_px", -0.1), "residual_rms_px of at least"),
    "a residual NaN": (changed("pose.residual_rms_px", float("nan")), "finite numbers, got NaN"),
    "a residual of infinity": (changed("pose.residual_rms_px", float("inf")), "got Infinity"),
    "a residual as text": (changed("pose.residual_rms_px", "small"), "to be a number, got 'small'"),
    "a point NaN": (
        changed("detections.points_px", [[float("nan"), 1.0], [2.0, 3.0]]),
        "expected finite numbers, got NaN",
    ),
    "a point of three": (
        changed("detections.points_px", [[1.0, 1.0, 1.0], [2.0, 3.0, 4.0]]),
        "detections.points_px as lists of n x 2 numbers",
    ),
    "a point too far": (
        changed("detections.points_px", [[1e9, 1.0], [2.0, 3.0]]),
        "detections.points_px as numbers of at least",
    ),
    "a sigma below zero": (
        changed("detections.sigma_px", [[0.1, -0.1], [0.1, 0.1]]),
        "detections.sigma_px as numbers of at least 0 .*, got -0.1",
    ),
    "used shorter than marker": (
        changed("detections.used", [True]),
        r"detections.points_px as many as sigma_px, marker and used, got lists of .1, 2.",
    ),
    "marker shorter than points": (changed("detections.marker", [3]), r"got lists of .1, 2."),
    "sigmas fewer than points": (changed("detections.sigma_px", [[0.1, 0.1]]), r"lists of .1, 2."),
    "a marker -7": (changed("detections.marker", [-7, 3]), "marker as whole numbers of -1 to"),
    "a marker 2.5": (changed("detections.marker", [2.5, 3]), "marker as whole numbers of -1 to"),
    "a marker true": (changed("detections.marker", [True, 3]), "marker as whole numbers of -1"),
    "used as 1": (changed("detections.used", [1, 0]), "used as a list of true and false, got 1"),
    "no used": (changed("detections.used", ...), "in detections; unknown: none; missing: used"),
    "states as a list": (changed("states", []), r"states with keys and values, got \[\]"),
    "a state as a number": (changed(TRANSLATION_STATE, 5), "with keys and values, got 5"),
    "a state without a value": (
        changed(f"{ROTATION_VALUES}.R_lvlh_from_target", ...),
        "missing: R_lvlh_from_target",
    ),
    "a state with a value more": (
        changed(f"{TRANSLATION_STATE}.values.bias_m", 1.0),
        "in states.relative_translation.values; unknown: bias_m",
    ),
    "values as a list": (changed(f"{TRANSLATION_STATE}.values", [1, 2]), "with keys and values"),
    "values as text": (changed(f"{TRANSLATION_STATE}.values", "ab"), "with keys and values"),
    "a place of two": (
        changed(f"{TRANSLATION_STATE}.values.rho_in_lvlh_m", [1.0, 2.0]),
        "rho_in_lvlh_m as 3 numbers",
    ),
    "a place as text": (
        changed(f"{TRANSLATION_STATE}.values.rho_in_lvlh_m", ["1", "2", "3"]),
        "rho_in_lvlh_m as numbers of at least .*, got '1'",
    ),
    "a place of lists of two lengths": (
        changed("states.other", {"values": {"a": [[1.0], [1.0, 2.0]]}}),
        "states.other.values.a as up to .* numbers in lists of one length",
    ),
    "no values": (changed("states.other", {"values": {}}), "states.other.values with at least one"),
    "an attitude that is none": (
        changed(f"{ROTATION_VALUES}.R_lvlh_from_target", np.ones((3, 3)).tolist()),
        "R_lvlh_from_target as a rotation matrix",
    ),
    "an attitude of another shape": (
        changed("states.other", {"values": {"R_a_from_b": np.ones((3, 3, 3)).tolist()}}),
        "R_a_from_b as a rotation matrix, got one of shape",
    ),
    "a state's covariance negated": (
        changed(f"{TRANSLATION_STATE}.covariance", (-EYE).tolist()),
        "states.relative_translation.covariance as a covariance, got one with a variance of -1",
    ),
    "a state's covariance of another size": (
        changed(f"{TRANSLATION_STATE}.covariance", np.eye(3).tolist()),
        "covariance as a covariance, got one of shape .3, 3.",
    ),
    "a covariance that is not square": (
        changed("states.other", {"values": {"a": [1.0]}, "covariance": [1.0, 2.0]}),
        "states.other.covariance as a covariance, got one of shape .2,., which is not square",
    ),
    "a state's name of a terminal": (
        changed("states.\x1b[2J", {"values": {"a": [1.0]}}),
        "the keys of states as printable text",
    ),
}


@pytest.mark.parametrize("name", LINES)
def test_a_line_that_cannot_be_is_named(tmp_path: Path, name: str) -> None:
    line, said = LINES[name]
    path = tmp_path / "best.jsonl"
    write_estimates(path, [POSE])
    with path.open("a") as file:
        file.write(line + "\n")
    with pytest.raises(DatasetError, match=rf"best\.jsonl.*{said}") as refusal:
        read_estimates(path)
    assert "best.jsonl:3: " in str(refusal.value) or " line 3: " in str(refusal.value)


@pytest.mark.parametrize(
    ("after", "said"),
    [
        (POSE, "best.jsonl:3: expected each frame once and in order, got 4 after 4"),
        (replace(POSE, frame=2), "best.jsonl:3: expected each frame once and in order, got 2 aft"),
        (NO_POSE, None),
        (replace(NO_POSE, time_s=0.8), None),
        (replace(NO_POSE, time_s=0.7), "best.jsonl:3: expected times that do not run back, got 0"),
    ],
)
def test_every_frame_stands_once_and_in_order(
    tmp_path: Path, after: Estimate, said: str | None
) -> None:
    path = tmp_path / "best.jsonl"
    write_estimates(path, [POSE, after])
    if said is None:
        assert len(read_estimates(path)) == 2
        return
    with pytest.raises(DatasetError, match=said):
        read_estimates(path)


# What a pipeline has just said.

NAN = float("nan")
MADE: dict[str, Callable[[], Any]] = {
    "a covariance NaN": lambda: with_pose(covariance=np.full((6, 6), NAN)),
    "a covariance negated": lambda: with_pose(covariance=-EYE),
    "a covariance too small": lambda: with_pose(covariance=np.eye(3)),
    "a residual NaN": lambda: with_pose(residual_rms_px=NAN),
    "no pose but a number": lambda: replace(POSE, pose=5.0),
    "a point NaN": lambda: replace(POSE, detections=replace(FOUND, points_px=np.full((2, 2), NAN))),
    "time of infinity": lambda: replace(POSE, time_s=float("inf")),
    "a frame of infinity": lambda: replace(POSE, frame=float("inf")),
    "a state NaN": lambda: replace(POSE, states={"bias": NamedState({"b": np.full(3, NAN)})}),
    "a state of words": lambda: replace(POSE, states={"bias": NamedState({"b": np.array("x")})}),
    "nothing": lambda: None,
}


def with_pose(**changes: Any) -> Estimate:
    assert POSE.pose is not None
    return replace(POSE, pose=replace(POSE.pose, **changes))


@pytest.mark.parametrize("name", MADE)
def test_an_impossible_estimate_is_told_before_it_is_written(name: str) -> None:
    said = impossible(MADE[name]())
    assert said is not None
    assert "expected" in said


# Runtimes.


def test_runtimes_come_back_to_the_microsecond_in_order_of_frames(tmp_path: Path) -> None:
    path = tmp_path / "runtimes.csv"
    write_runtimes(path, {7: 12.3456, 2: 1.0})
    assert path.read_text() == "frame,runtime_ms\n2,1.000\n7,12.346\n"
    assert read_runtimes(path) == {2: 1.0, 7: 12.346}


def test_absent_runtimes_are_none_and_broken_ones_an_error(tmp_path: Path) -> None:
    path = tmp_path / "runtimes.csv"
    assert read_runtimes(path) == {}
    for row, said in (
        ("1,2,3", "expected 2 cells, got 3"),
        ("1,fast", "runtime_ms to be a number, got 'fast'"),
        ("1", "expected 2 cells, got 1"),
        ("1,nan", "runtime_ms to be a number"),
        ("1,-2.0", "runtime_ms of at least 0"),
        ("1.5,2.0", "frame to be a whole number"),
    ):
        path.write_text(f"frame,runtime_ms\n{row}\n")
        with pytest.raises(DatasetError, match=rf"runtimes\.csv:2: expected .*{said}|{said}"):
            read_runtimes(path)


def test_lines_without_a_head_are_not_taken_for_an_estimate_of_version_2(tmp_path: Path) -> None:
    path = tmp_path / "best.jsonl"
    write_estimates(path, [Estimate(frame=0, time_s=0.0, reason="none")])
    path.write_text(path.read_text().split("\n", 1)[1])
    with pytest.raises(DatasetError, match="expected a head of format 'rvbench-estimates'"):
        read_estimates(path)
    path.write_text('{"format": "x", "version": 2}\n')
    with pytest.raises(DatasetError, match="got 'x'"):
        read_estimates(path)
