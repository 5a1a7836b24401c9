"""Estimates as JSON lines, one frame a line, in frame order; runtimes lie beside, in a CSV.

The same estimates give the same bytes: nothing that changes from run to run is in the file.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from models.atomic_file import write_text
from models.errors import DatasetError, cause
from models.estimate import Detections, Estimate, NoPose, PoseEstimate
from models.pose import RigidTransform


def _detections_to_json(detections: Detections) -> dict[str, Any]:
    return {
        "points_px": detections.points_px.tolist(),
        "sigma_px": detections.sigma_px.tolist(),
        "marker": list(detections.marker),
        "used": list(detections.used),
    }


def estimate_to_json(estimate: Estimate) -> dict[str, Any]:
    """Return one estimate as the JSON object of its line."""
    if isinstance(estimate, NoPose):
        return {
            "frame": estimate.frame,
            "time_s": estimate.time_s,
            "status": estimate.status,
            "reason": estimate.reason,
            "detections": _detections_to_json(estimate.detections),
        }
    return {
        "frame": estimate.frame,
        "time_s": estimate.time_s,
        "status": estimate.status,
        "R_cam_from_target": estimate.cam_from_target.rotation.tolist(),
        "t_cam_from_target_m": estimate.cam_from_target.translation.tolist(),
        "covariance_rad_m": estimate.covariance.tolist(),
        "residual_rms_px": estimate.residual_rms_px,
        "detections": _detections_to_json(estimate.detections),
    }


def estimate_from_json(record: dict[str, Any]) -> Estimate:
    """Read one estimate back; a bad field raises KeyError, TypeError or ValueError."""
    found = record["detections"]
    detections = Detections(
        points_px=np.array(found["points_px"], dtype=np.float64).reshape(-1, 2),
        sigma_px=np.array(found["sigma_px"], dtype=np.float64).reshape(-1, 2),
        marker=tuple(int(index) for index in found["marker"]),
        used=tuple(bool(kept) for kept in found["used"]),
    )
    frame, time_s = int(record["frame"]), float(record["time_s"])
    if record["status"] == "no pose":
        return NoPose(frame, time_s, str(record["reason"]), detections)
    if record["status"] != "pose":
        raise ValueError(f"expected status 'pose' or 'no pose', got {record['status']!r}")
    return PoseEstimate(
        frame=frame,
        time_s=time_s,
        cam_from_target=RigidTransform(
            np.array(record["R_cam_from_target"]), np.array(record["t_cam_from_target_m"])
        ),
        covariance=np.array(record["covariance_rad_m"], dtype=np.float64).reshape(6, 6),
        detections=detections,
        residual_rms_px=float(record["residual_rms_px"]),
    )


def _read_lines(path: Path) -> list[str]:
    try:
        return path.read_text().splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise DatasetError(
            f"expected text at {path}, got: {cause(error)}; estimate again"
        ) from error


def write_estimates(path: Path, estimates: Iterable[Estimate]) -> None:
    """Write all estimates at once, whole or not at all."""
    lines = [json.dumps(estimate_to_json(estimate)) for estimate in estimates]
    write_text(path, "".join(line + "\n" for line in lines))


def read_estimates(path: Path) -> list[Estimate]:
    """Read an estimates file.

    Raises
    ------
    DatasetError
        If the file is missing or a line cannot be read; the message names the line.
    """
    if not path.is_file():
        raise DatasetError(f"expected an estimates file at {path}, found none; run the estimate")
    estimates = []
    for number, line in enumerate(_read_lines(path), start=1):
        try:
            estimates.append(estimate_from_json(json.loads(line)))
        except (KeyError, TypeError, ValueError) as error:
            raise DatasetError(
                f"{path}:{number}: expected one estimate as JSON, got: {cause(error)}; "
                "delete the file and estimate again"
            ) from error
    return estimates


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
    if not path.is_file():
        return {}
    rows = (line.split(",") for line in _read_lines(path)[1:])
    try:
        return {int(frame): float(spent) for frame, spent in rows}
    except ValueError as error:
        raise DatasetError(
            f"{path}: expected rows of frame,runtime_ms, got: {error}; delete it"
        ) from error
