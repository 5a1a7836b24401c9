"""Estimates as JSON lines, one frame a line, in frame order; runtimes lie beside, in a CSV.

The first line says ``{"format": "rvbench-estimates", "version": 2}``. The others hold ``frame`` and
``time_s``, and of the rest what the pipeline has to say::

    {"frame": 3, "time_s": 0.6, "mode": "tracked",
     "pose": {"R_cam_from_target": [[...]], "t_cam_from_target_m": [...],
              "covariance_rad_m": [[...]], "residual_rms_px": 0.02,
              "wrong_probability": 0.001},
     "detections": {"points_px": [[...]], "sigma_px": [[...]], "marker": [...], "used": [...]},
     "states": {"relative_translation": {"values": {"rho_in_lvlh_m": [...]},
                                         "covariance": [[...]]}}}

Where there is no pose, ``reason`` says why. Covariance, residual, the probability that the pose is
another than the true one, detections and states may be left out. The same estimates give the same
bytes: nothing that changes from run to run is in the file.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from models.atomic_file import write_text
from models.dataset import estimates_version1
from models.dataset.named_states import read_states, state_to_json
from models.errors import DatasetError, UnreadableError, cause
from models.estimate import Detections, Estimate, PoseEstimate
from models.pose import RigidTransform
from models.reading.bounds import FRAME, LENGTH_M, MOST_PROSE, POINT_PX, SIGMA_PX, TIME_S, UNIT
from models.reading.csv_table import read_csv
from models.reading.fields import Fields
from models.reading.json_file import read_json_lines
from models.reading.shown import shown

FORMAT, VERSION = "rvbench-estimates", 2
MOST_BYTES = 4_000_000_000
MOST_DETECTIONS = 100_000
LARGEST_RUNTIME_MS = 1e12


def estimate_to_json(estimate: Estimate) -> dict[str, Any]:
    """Return one estimate as the JSON object of its line."""
    record: dict[str, Any] = {"frame": int(estimate.frame), "time_s": float(estimate.time_s)}
    if estimate.mode:
        record["mode"] = estimate.mode
    if estimate.pose is not None:
        record["pose"] = _pose_to_json(estimate.pose)
    if estimate.reason is not None:
        record["reason"] = estimate.reason
    if estimate.states:
        record["states"] = {name: state_to_json(own) for name, own in estimate.states.items()}
    if estimate.detections is not None:
        found = estimate.detections
        record["detections"] = {
            "points_px": found.points_px.tolist(),
            "sigma_px": found.sigma_px.tolist(),
            "marker": [int(each) for each in found.marker],
            "used": [bool(each) for each in found.used],
        }
    return record


def estimate_from_json(record: dict[str, Any], where: Path | str) -> Estimate:
    """Read one estimate back, checked for being possible.

    Parameters
    ----------
    record : dict
    where : Path or str
        The file with its line, for messages.

    Raises
    ------
    DatasetError
        If a key is missing or unknown, or a value cannot be.
    """
    fields = Fields(record, where)
    fields.only(("frame", "time_s"), ("mode", "pose", "reason", "states", "detections"))
    try:
        return Estimate(
            frame=fields.whole("frame", *FRAME),
            time_s=fields.number("time_s", *TIME_S),
            pose=_pose(fields.table("pose")) if "pose" in fields else None,
            reason=fields.text("reason", MOST_PROSE, lines=True) if "reason" in fields else None,
            detections=_detections(fields.table("detections")) if "detections" in fields else None,
            mode=fields.text("mode") if "mode" in fields else "",
            states=read_states(fields.table("states")) if "states" in fields else {},
        )
    except ValueError as error:
        raise DatasetError(f"{where}: {error}") from error


def write_estimates(path: Path, estimates: Iterable[Estimate]) -> None:
    """Write all estimates at once, whole or not at all."""
    head = json.dumps({"format": FORMAT, "version": VERSION})
    lines = [json.dumps(estimate_to_json(estimate)) for estimate in estimates]
    write_text(path, "".join(line + "\n" for line in (head, *lines)))


def read_estimates(path: Path) -> list[Estimate]:
    """Read an estimates file, of version 2 or 1.

    Raises
    ------
    DatasetError
        If the file is missing, a line cannot be read or says what cannot be, frames do not rise
        or times run back; the message names the line.
    """
    try:
        records = read_json_lines(path, MOST_BYTES, MOST_BYTES)
    except UnreadableError as error:
        raise DatasetError(
            f"expected an estimates file at {path}, got: {error.told}; estimate again"
        ) from error
    if records and records[0][1].get("format") == FORMAT:
        if records[0][1].get("version") != VERSION:
            raise DatasetError(
                f"{path}: expected {FORMAT} version {VERSION}, "
                f"got version {shown(records[0][1].get('version'))}; estimate again"
            )
        records = records[1:]
    elif records and not estimates_version1.is_version_1(records[0][1]):
        raise DatasetError(
            f"{path}:1: expected a head of format {FORMAT!r} and version {VERSION}, "
            f"got {shown(records[0][1].get('format', 'none'))}; estimate again"
        )
    estimates: list[Estimate] = []
    for number, record in records:
        where = f"{path}:{number}"
        try:
            estimate = estimate_from_json(estimates_version1.converted(record), where)
        except DatasetError as error:
            raise DatasetError(f"{error}; estimate again") from error
        if estimates and estimate.frame <= estimates[-1].frame:
            raise DatasetError(
                f"{where}: expected each frame once and in order, got {estimate.frame} after "
                f"{estimates[-1].frame}; estimate again"
            )
        if estimates and estimate.time_s < estimates[-1].time_s:
            raise DatasetError(
                f"{where}: expected times that do not run back, got {estimate.time_s} s after "
                f"{estimates[-1].time_s} s; estimate again"
            )
        estimates.append(estimate)
    return estimates


def impossible(estimate: Estimate) -> str | None:
    """Say what keeps an estimate just made from being possible; None if nothing does."""
    try:
        estimate_from_json(json.loads(json.dumps(estimate_to_json(estimate))), "the estimate")
    except DatasetError as error:
        return str(error)
    except Exception as error:  # anybody's pipeline, which may say anything
        return f"expected an Estimate, got one that cannot be written: {cause(error)}"
    return None


def write_runtimes(path: Path, runtime_ms: dict[int, float]) -> None:
    """Write how long each frame took, ms, as CSV."""
    rows = "".join(f"{frame},{spent:.3f}\n" for frame, spent in sorted(runtime_ms.items()))
    write_text(path, "frame,runtime_ms\n" + rows)


def read_runtimes(path: Path) -> dict[int, float]:
    """Read runtimes back, ms by frame; an absent file gives an empty dict.

    Raises
    ------
    DatasetError
        If a row is not a frame and a number.
    """
    if not path.exists():
        return {}
    return {
        row.whole("frame", *FRAME): row.number("runtime_ms", 0.0, LARGEST_RUNTIME_MS)
        for row in read_csv(path, ("frame", "runtime_ms"))
    }


def _pose_to_json(pose: PoseEstimate) -> dict[str, Any]:
    record: dict[str, Any] = {
        "R_cam_from_target": pose.cam_from_target.rotation.tolist(),
        "t_cam_from_target_m": pose.cam_from_target.translation.tolist(),
    }
    if pose.covariance is not None:
        record["covariance_rad_m"] = np.asarray(pose.covariance).tolist()
    if pose.residual_rms_px is not None:
        record["residual_rms_px"] = float(pose.residual_rms_px)
    if pose.wrong_probability is not None:
        record["wrong_probability"] = float(pose.wrong_probability)
    return record


def _pose(fields: Fields) -> PoseEstimate:
    fields.only(
        ("R_cam_from_target", "t_cam_from_target_m"),
        ("covariance_rad_m", "residual_rms_px", "wrong_probability"),
    )
    covariance = fields.covariance("covariance_rad_m", 6) if "covariance_rad_m" in fields else None
    residual = (
        fields.number("residual_rms_px", 0.0, POINT_PX[1]) if "residual_rms_px" in fields else None
    )
    doubt = fields.number("wrong_probability", *UNIT) if "wrong_probability" in fields else None
    pose: RigidTransform = fields.pose("R_cam_from_target", "t_cam_from_target_m", *LENGTH_M)
    return PoseEstimate(pose, covariance, residual, doubt)


def _detections(fields: Fields) -> Detections:
    fields.only(("points_px", "sigma_px", "marker", "used"))
    found = Detections(
        points_px=fields.numbers("points_px", (None, 2), *POINT_PX, MOST_DETECTIONS),
        sigma_px=fields.numbers("sigma_px", (None, 2), *SIGMA_PX, MOST_DETECTIONS),
        marker=fields.wholes("marker", -1, MOST_DETECTIONS, MOST_DETECTIONS),
        used=fields.flags("used", MOST_DETECTIONS),
    )
    counts = {len(found.points_px), len(found.sigma_px), len(found.marker), len(found.used)}
    if len(counts) > 1:
        raise fields.refusal(
            "points_px", "as many as sigma_px, marker and used", f"lists of {sorted(counts)}"
        )
    return found
