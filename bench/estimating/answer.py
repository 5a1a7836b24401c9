"""What a pipeline's process says, as text: nothing of its package is loaded where it is read."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from models.dataset.estimates_file import (
    MOST_DETECTIONS,
    estimate_from_json,
    estimate_to_json,
)
from models.errors import DatasetError
from models.estimate import Estimate, NamedState, PoseEstimate
from models.pose import RigidTransform

MOST_BYTES = 100_000_000
LAST_WORDS = 300


@dataclass(frozen=True, eq=False)
class Answer:
    """What came back.

    Attributes
    ----------
    estimate : Estimate or None
        As the pipeline said it.
    reason : str
        Why there is none.
    runtime_ms : float, ms
    """

    estimate: Estimate | None
    reason: str
    runtime_ms: float


def answer_to_bytes(said: Any, runtime_ms: float) -> bytes:
    """Return the message of what a pipeline returned, whatever that is."""
    if not isinstance(said, Estimate):
        return reason_to_bytes(no_estimate(said), runtime_ms)
    if much := too_much(said):
        return reason_to_bytes(much, runtime_ms)
    try:
        record = json.dumps(estimate_to_json(said))
    except (Exception, SystemExit) as error:
        return reason_to_bytes(f"the pipeline said what cannot be: {_words(error)}", runtime_ms)
    if len(record) > MOST_BYTES // 2:
        told = f"expected an estimate of at most {MOST_BYTES // 2} bytes, got {len(record)}"
        return reason_to_bytes(f"the pipeline said what cannot be: {told}", runtime_ms)
    return f'{{"runtime_ms": {runtime_ms!r}, "estimate": {record}}}'.encode()


def reason_to_bytes(reason: str, runtime_ms: float) -> bytes:
    """Return the message of why there is no estimate."""
    return json.dumps({"runtime_ms": runtime_ms, "reason": reason}).encode()


def answer_from_bytes(message: bytes) -> Answer:
    """Read a message.

    Raises
    ------
    ValueError
        If it is none.
    """
    try:
        table = json.loads(message)
        runtime_ms = float(table["runtime_ms"])
        if "reason" in table:
            return Answer(None, str(table["reason"]), runtime_ms)
        record = table["estimate"]
        try:
            possible = estimate_from_json(record, "the estimate")
        except DatasetError as error:
            return Answer(None, f"the pipeline said what cannot be: {error}", runtime_ms)
        return Answer(_as_said(possible, record), "", runtime_ms)
    except (KeyError, TypeError, RecursionError) as error:
        raise ValueError(f"expected an answer, got {message[:80]!r}") from error


def no_estimate(said: Any) -> str:
    """Return the reason of a frame of which something else was said."""
    if said is None:
        return "the pipeline said nothing"
    return f"the pipeline said a {type(said).__name__}, which is no Estimate"


def too_much(said: Estimate) -> str:
    """Return why an estimate is not even looked through; empty if it is."""
    try:
        points = 0 if said.detections is None else len(said.detections.points_px)
    except (TypeError, AttributeError):
        return ""  # no list at all, which others will say
    if points > MOST_DETECTIONS:
        return (
            f"the pipeline said what cannot be: expected at most {MOST_DETECTIONS} detections, "
            f"got {points}"
        )
    return ""


def told(error: BaseException, place: str = "") -> str:
    """Say what a pipeline raised."""
    return f"the pipeline raised {_words(error)}{place}"


def _words(error: BaseException) -> str:
    try:
        words = str(error)[:LAST_WORDS]
    except Exception:  # an exception of anybody's, which may fail in any way
        words = ""
    return f"{type(error).__name__}: {words}" if words else type(error).__name__


def _as_said(possible: Estimate, record: dict[str, Any]) -> Estimate:
    """Return an estimate with the very numbers of its record: reading makes some exact."""
    pose, own = possible.pose, record.get("pose")
    if pose is not None and own is not None:
        rotation, translation = own["R_cam_from_target"], own["t_cam_from_target_m"]
        pose = PoseEstimate(
            RigidTransform(_array(rotation), _array(translation)),
            None if pose.covariance is None else _array(own["covariance_rad_m"]),
            pose.residual_rms_px,
            pose.wrong_probability,
        )
    states = {
        name: NamedState(
            {key: _array(value) for key, value in state["values"].items()},
            _array(state["covariance"]) if "covariance" in state else None,
        )
        for name, state in record.get("states", {}).items()
    }
    return replace(possible, pose=pose, states=states)


def _array(value: Any) -> Any:
    return np.array(value, dtype=np.float64)
