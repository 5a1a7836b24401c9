"""The sealed record of single images: what really was, for each of them.

It loads no renderer, so that scoring can read it; pipelines may not import it, and never need it.

::

    DIR/truth/exposures.jsonl        one ``ImageTruth`` a line, frame by frame
        parts.json                   names of the labels: label k + 1 is part k, 0 is space
        labels/000000.png            part labels at pixel centres, uint8
        geometry/000000.exr          Z (m), NX, NY, NZ (target frame) at pixel centres
        scenario.toml                the scenario with every default resolved
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from models.arrays import Floats, Mask
from models.motion.relative_state import ChaserState, RelativeState
from models.pose import RigidTransform
from renders.truth.exposure_truth import read_records
from renders.world.exposure import FILTERED

STATE_KEYS = {
    "rho_in_lvlh": "rho_in_lvlh_m",
    "rho_dot_in_lvlh": "rho_dot_in_lvlh_m_s",
    "R_lvlh_from_target": "R_lvlh_from_target",
    "omega_target_wrt_lvlh_in_target": "omega_target_wrt_lvlh_in_target_rad_s",
}
"""Fields of a relative state, and what they are called in the record."""


@dataclass(frozen=True, eq=False)
class ImageTruth:
    """One image as it was.

    Attributes
    ----------
    frame : int
    time_s : float, s
        Middle of the exposure.
    cam_from_target : RigidTransform
    state : RelativeState
        Of the target, in the chaser's local frame.
    chaser : ChaserState
    sun_dir_in_target, earth_dir_in_target : (3,) arrays
        Unit vectors towards the Sun's and the Earth's centre.
    landmarks_px : (m, 2) array, px
        Projection of each landmark of the wireframe with the true camera; NaN behind it.
    landmarks_visible : (m,) array of bool
        Whether the image holds it and nothing of the whole mesh stands before it.
    """

    frame: int
    time_s: float
    cam_from_target: RigidTransform
    state: RelativeState
    chaser: ChaserState
    sun_dir_in_target: Floats
    earth_dir_in_target: Floats
    landmarks_px: Floats
    landmarks_visible: Mask

    @property
    def band(self) -> int:
        """All that the camera's filter passes."""
        return FILTERED

    def to_json(self) -> dict[str, Any]:
        """Return the JSON object of its line."""
        pixels = [[None if np.isnan(x) else float(x) for x in row] for row in self.landmarks_px]
        return {
            "frame": self.frame,
            "time_s": self.time_s,
            "R_cam_from_target": self.cam_from_target.rotation.tolist(),
            "t_cam_from_target_m": self.cam_from_target.translation.tolist(),
            "state": _state_to_json(self.state),
            "chaser_position_in_inertial_m": self.chaser.position_in_inertial.tolist(),
            "chaser_velocity_in_inertial_m_s": self.chaser.velocity_in_inertial.tolist(),
            "sun_dir_in_target": self.sun_dir_in_target.tolist(),
            "earth_dir_in_target": self.earth_dir_in_target.tolist(),
            "landmarks_px": pixels,
            "landmarks_visible": self.landmarks_visible.tolist(),
        }

    @classmethod
    def from_json(cls, record: dict[str, Any]) -> ImageTruth:
        """Read it back."""

        def floats(key: str) -> Floats:
            return np.array(record[key], dtype=np.float64)

        time_s = float(record["time_s"])
        return cls(
            frame=int(record["frame"]),
            time_s=time_s,
            cam_from_target=RigidTransform(
                floats("R_cam_from_target"), floats("t_cam_from_target_m")
            ),
            state=_state_from_json(record["state"]),
            chaser=ChaserState(
                time_s,
                floats("chaser_position_in_inertial_m"),
                floats("chaser_velocity_in_inertial_m_s"),
            ),
            sun_dir_in_target=floats("sun_dir_in_target"),
            earth_dir_in_target=floats("earth_dir_in_target"),
            landmarks_px=floats("landmarks_px").reshape(-1, 2),
            landmarks_visible=np.array(record["landmarks_visible"], dtype=np.bool_),
        )


def _state_to_json(state: RelativeState) -> dict[str, Any]:
    arrays = {key: getattr(state, name).tolist() for name, key in STATE_KEYS.items()}
    return {"time_s": state.time_s, **arrays}


def _state_from_json(record: dict[str, Any]) -> RelativeState:
    shapes = {name: (3, 3) if name.startswith("R_") else (3,) for name in STATE_KEYS}
    arrays = {
        name: np.array(record[key], dtype=np.float64).reshape(shapes[name])
        for name, key in STATE_KEYS.items()
    }
    return RelativeState(float(record["time_s"]), **arrays)


def read_image_truths(folder: Path) -> dict[int, ImageTruth]:
    """Read the truth of a dataset of single images, by frame; see ``read_records``."""
    return {truth.frame: truth for truth in read_records(folder, ImageTruth.from_json)}
