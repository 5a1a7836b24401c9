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
from models.reading.bounds import FRAME, LENGTH_M, RATE_RAD_S, SPEED_M_S, TIME_S, UNIT
from models.reading.fields import Fields
from renders.truth.exposure_truth import FAR_PX, direction, read_records
from renders.world.exposure import FILTERED

ORBIT_M = (-1e10, 1e10)
ORBIT_M_S = (-1e5, 1e5)
STATE_KEYS = {
    "rho_in_lvlh": "rho_in_lvlh_m",
    "rho_dot_in_lvlh": "rho_dot_in_lvlh_m_s",
    "R_lvlh_from_target": "R_lvlh_from_target",
    "omega_target_wrt_lvlh_in_target": "omega_target_wrt_lvlh_in_target_rad_s",
}
"""Name in a file, by name in ``RelativeState``."""


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
    sunlit_share : float
        How much of the Sun's disc the Earth leaves free: 0 in its umbra, 1 in full light.
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
    sunlit_share: float = 1.0

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
            "state": {
                "time_s": self.state.time_s,
                **{key: getattr(self.state, name).tolist() for name, key in STATE_KEYS.items()},
            },
            "chaser_position_in_inertial_m": self.chaser.position_in_inertial.tolist(),
            "chaser_velocity_in_inertial_m_s": self.chaser.velocity_in_inertial.tolist(),
            "sun_dir_in_target": self.sun_dir_in_target.tolist(),
            "earth_dir_in_target": self.earth_dir_in_target.tolist(),
            "sunlit_share": self.sunlit_share,
            "landmarks_px": pixels,
            "landmarks_visible": self.landmarks_visible.tolist(),
        }

    @classmethod
    def from_fields(cls, record: Fields) -> ImageTruth:
        """Read it back.

        Raises
        ------
        DatasetError
            If a value is missing or cannot be.
        """
        time_s = record.number("time_s", *TIME_S)
        landmarks_px = record.numbers("landmarks_px", (None, 2), -FAR_PX, FAR_PX, holes=True)
        visible = record.flags("landmarks_visible")
        if len(visible) != len(landmarks_px):
            raise record.refusal(
                "landmarks_visible", f"for each of {len(landmarks_px)} landmarks", len(visible)
            )
        return cls(
            frame=record.whole("frame", *FRAME),
            time_s=time_s,
            cam_from_target=record.pose("R_cam_from_target", "t_cam_from_target_m", *LENGTH_M),
            state=_state(record.table("state")),
            chaser=ChaserState(
                time_s,
                record.vector("chaser_position_in_inertial_m", 3, *ORBIT_M),
                record.vector("chaser_velocity_in_inertial_m_s", 3, *ORBIT_M_S),
            ),
            sun_dir_in_target=direction(record, "sun_dir_in_target"),
            earth_dir_in_target=direction(record, "earth_dir_in_target"),
            landmarks_px=landmarks_px,
            landmarks_visible=np.array(visible, dtype=np.bool_),
            # Datasets of before lay in full light: a motion through the shadow was refused.
            sunlit_share=record.number("sunlit_share", *UNIT) if "sunlit_share" in record else 1.0,
        )


def _state(record: Fields) -> RelativeState:
    return RelativeState(
        record.number("time_s", *TIME_S),
        record.vector("rho_in_lvlh_m", 3, *LENGTH_M),
        record.vector("rho_dot_in_lvlh_m_s", 3, *SPEED_M_S),
        record.rotation("R_lvlh_from_target"),
        record.vector("omega_target_wrt_lvlh_in_target_rad_s", 3, *RATE_RAD_S),
    )


def read_image_truths(folder: Path) -> dict[int, ImageTruth]:
    """Read the truth of a dataset of single images, by frame; see ``read_records``."""
    return {truth.frame: truth for truth in read_records(folder, ImageTruth.from_fields)}
