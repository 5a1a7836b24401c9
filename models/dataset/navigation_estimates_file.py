"""Estimates of a relative state as JSON lines, one frame a line, in frame order.

The pose of the image alone is written as in ``models.dataset.estimates_file``; beside it stands
the state after the filters. The same estimates give the same bytes.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any, get_args

import numpy as np

from models.arrays import Floats
from models.atomic_file import write_text
from models.dataset.estimates_file import estimate_from_json, estimate_to_json
from models.errors import DatasetError, cause
from models.motion.relative_state import RelativeState
from models.uncooperative import Mode, NavigationEstimate

STATE_KEYS = {
    "rho_in_lvlh": "rho_in_lvlh_m",
    "rho_dot_in_lvlh": "rho_dot_in_lvlh_m_s",
    "R_lvlh_from_target": "R_lvlh_from_target",
    "omega_target_wrt_lvlh_in_target": "omega_target_wrt_lvlh_in_target_rad_s",
}
"""Name in a file, by name in ``RelativeState``."""


def state_to_json(state: RelativeState) -> dict[str, Any]:
    """Return a relative state as a JSON object."""
    arrays = {key: getattr(state, name).tolist() for name, key in STATE_KEYS.items()}
    return {"time_s": state.time_s, **arrays}


def state_from_json(record: dict[str, Any]) -> RelativeState:
    """Read a relative state back; a bad field raises KeyError, TypeError or ValueError."""
    shapes = {name: (3, 3) if name.startswith("R_") else (3,) for name in STATE_KEYS}
    arrays = {
        name: np.array(record[key], dtype=np.float64).reshape(shapes[name])
        for name, key in STATE_KEYS.items()
    }
    return RelativeState(float(record["time_s"]), **arrays)


def navigation_estimate_to_json(estimate: NavigationEstimate) -> dict[str, Any]:
    """Return one estimate as the JSON object of its line."""

    def rows(covariance: Floats | None) -> list[list[float]] | None:
        return None if covariance is None else covariance.tolist()

    return {
        "frame": estimate.frame,
        "time_s": estimate.time_s,
        "mode": estimate.mode,
        "pose": estimate_to_json(estimate.pose),
        "state": None if estimate.state is None else state_to_json(estimate.state),
        "translation_covariance": rows(estimate.translation_covariance),
        "rotation_covariance": rows(estimate.rotation_covariance),
    }


def navigation_estimate_from_json(record: dict[str, Any]) -> NavigationEstimate:
    """Read one estimate back; a bad field raises KeyError, TypeError or ValueError."""

    def covariance(key: str) -> Floats | None:
        rows = record[key]
        return None if rows is None else np.array(rows, dtype=np.float64).reshape(6, 6)

    if record["mode"] not in get_args(Mode):
        raise ValueError(f"expected a mode among {', '.join(get_args(Mode))}: {record['mode']!r}")
    return NavigationEstimate(
        frame=int(record["frame"]),
        time_s=float(record["time_s"]),
        mode=record["mode"],
        pose=estimate_from_json(record["pose"]),
        state=None if record["state"] is None else state_from_json(record["state"]),
        translation_covariance=covariance("translation_covariance"),
        rotation_covariance=covariance("rotation_covariance"),
    )


def write_navigation_estimates(path: Path, estimates: Iterable[NavigationEstimate]) -> None:
    """Write all estimates at once, whole or not at all."""
    lines = [json.dumps(navigation_estimate_to_json(estimate)) for estimate in estimates]
    write_text(path, "".join(line + "\n" for line in lines))


def read_navigation_estimates(path: Path) -> list[NavigationEstimate]:
    """Read an estimates file.

    Raises
    ------
    DatasetError
        If the file is missing or a line cannot be read; the message names the line.
    """
    try:
        lines = path.read_text().splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise DatasetError(
            f"expected an estimates file at {path}, got: {cause(error)}; run the estimate"
        ) from error
    estimates = []
    for number, line in enumerate(lines, start=1):
        try:
            estimates.append(navigation_estimate_from_json(json.loads(line)))
        except (KeyError, TypeError, ValueError) as error:
            raise DatasetError(
                f"{path}:{number}: expected one navigation estimate as JSON, "
                f"got: {cause(error)}; delete the file and estimate again"
            ) from error
    return estimates
