"""Lines of estimates files of version 1, which knew two kinds, as those of version 2."""

from __future__ import annotations

from typing import Any

from models.motion.relative_state import ROTATION, STATE_SHAPES, TRANSLATION

POSE, NO_POSE = "pose", "no pose"  # what a status said
POSE_KEYS = ("R_cam_from_target", "t_cam_from_target_m", "covariance_rad_m", "residual_rms_px")
COVARIANCES = {TRANSLATION: "translation_covariance", ROTATION: "rotation_covariance"}


def is_version_1(record: dict[str, Any]) -> bool:
    """Tell whether a line is of version 1: it, or the pose in it, has a status."""
    inner = record.get("pose")
    return "status" in record or (isinstance(inner, dict) and "status" in inner)


def converted(record: dict[str, Any]) -> dict[str, Any]:
    """Return a line as version 2 has it; what is of neither version comes back to be refused."""
    inner = record.get("pose")
    if isinstance(inner, dict) and "status" in inner:
        return _from_navigation(record, inner)
    return _from_pose(record)


def _from_pose(record: dict[str, Any]) -> dict[str, Any]:
    if record.get("status") not in (POSE, NO_POSE):
        return record
    rest = {key: value for key, value in record.items() if key != "status"}
    if record["status"] == NO_POSE:
        return rest
    pose = {key: rest.pop(key) for key in POSE_KEYS if key in rest}
    return {**rest, "pose": pose}


def _from_navigation(record: dict[str, Any], inner: dict[str, Any]) -> dict[str, Any]:
    state = record.get("state")
    known = ("pose", *(("state", *COVARIANCES.values()) if _is_table_or_none(state) else ()))
    outer = {key: value for key, value in record.items() if key not in known}
    line = {**_from_pose(inner), **outer}
    return {**line, "states": _states(record, state)} if isinstance(state, dict) else line


def _is_table_or_none(value: Any) -> bool:
    return value is None or isinstance(value, dict)


def _states(record: dict[str, Any], state: dict[str, Any]) -> dict[str, Any]:
    """Return the two states; what is of none of them goes to the first, to be refused there."""
    rest = {key: value for key, value in state.items() if key != "time_s"}
    values = {
        name: {key: rest.pop(key) for key in shapes if key in rest}
        for name, shapes in STATE_SHAPES.items()
    }
    values[TRANSLATION].update(rest)
    states: dict[str, Any] = {name: {"values": own} for name, own in values.items()}
    for name, key in COVARIANCES.items():
        if record.get(key) is not None:
            states[name]["covariance"] = record[key]
    return states
