"""Lines of estimates files of version 1, which knew two kinds, as those of version 2."""

from __future__ import annotations

from typing import Any

POSE_KEYS = (
    "R_cam_from_target",
    "t_cam_from_target_m",
    "covariance_rad_m",
    "residual_rms_px",
)
STATES = {
    "relative_translation": (
        ("rho_in_lvlh_m", "rho_dot_in_lvlh_m_s"),
        "translation_covariance",
    ),
    "relative_rotation": (
        ("R_lvlh_from_target", "omega_target_wrt_lvlh_in_target_rad_s"),
        "rotation_covariance",
    ),
}


def converted(record: dict[str, Any]) -> dict[str, Any]:
    """Return a line as version 2 has it; one of version 2, or broken, comes back as it is."""
    if "status" in record:
        return _from_pose(record)
    inner = record.get("pose")
    if isinstance(inner, dict) and "status" in inner:
        line = {**_from_pose(inner), "mode": record.get("mode", "")}
        state = record.get("state")
        return {**line, "states": _states(record, state)} if isinstance(state, dict) else line
    return record


def _from_pose(record: dict[str, Any]) -> dict[str, Any]:
    rest = {key: value for key, value in record.items() if key not in (*POSE_KEYS, "status")}
    if record["status"] != "pose":
        return rest
    return {**rest, "pose": {key: record[key] for key in POSE_KEYS if key in record}}


def _states(record: dict[str, Any], state: dict[str, Any]) -> dict[str, Any]:
    states: dict[str, Any] = {}
    for name, (keys, covariance) in STATES.items():
        states[name] = {"values": {key: state[key] for key in keys if key in state}}
        if record.get(covariance) is not None:
            states[name]["covariance"] = record[covariance]
    return states
