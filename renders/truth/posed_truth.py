"""The sealed record of single images at given poses: what really was, for each of them.

It loads no renderer. The files are those of ``renders.truth.image_truth``; of the motion there is
the pose alone, for a table of poses need be no motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from models.arrays import Floats, Mask
from models.pose import RigidTransform
from models.reading.bounds import FRAME, LENGTH_M, TIME_S
from models.reading.fields import Fields
from renders.truth.exposure_truth import FAR_PX, direction, read_records
from renders.world.exposure import FILTERED


@dataclass(frozen=True, eq=False)
class PosedTruth:
    """One image as it was.

    Attributes
    ----------
    frame : int
    time_s : float, s
        Middle of the exposure.
    cam_from_target : RigidTransform
    sun_dir_in_target : (3,) array
        Unit vector towards the Sun.
    landmarks_px : (m, 2) array, px
        Projection of each landmark of the target's wireframe with the true camera, NaN behind it;
        none where the target has no wireframe.
    landmarks_visible : (m,) array of bool
        Whether the image holds it and nothing of the whole mesh stands before it.
    """

    frame: int
    time_s: float
    cam_from_target: RigidTransform
    sun_dir_in_target: Floats
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
            "sun_dir_in_target": self.sun_dir_in_target.tolist(),
            "landmarks_px": pixels,
            "landmarks_visible": self.landmarks_visible.tolist(),
        }

    @classmethod
    def from_fields(cls, record: Fields) -> PosedTruth:
        """Read it back.

        Raises
        ------
        DatasetError
            If a value is missing or cannot be.
        """
        landmarks_px = record.numbers("landmarks_px", (None, 2), -FAR_PX, FAR_PX, holes=True)
        visible = record.flags("landmarks_visible")
        if len(visible) != len(landmarks_px):
            raise record.refusal(
                "landmarks_visible", f"for each of {len(landmarks_px)} landmarks", len(visible)
            )
        return cls(
            frame=record.whole("frame", *FRAME),
            time_s=record.number("time_s", *TIME_S),
            cam_from_target=record.pose("R_cam_from_target", "t_cam_from_target_m", *LENGTH_M),
            sun_dir_in_target=direction(record, "sun_dir_in_target"),
            landmarks_px=landmarks_px.reshape(-1, 2),
            landmarks_visible=np.array(visible, dtype=np.bool_),
        )


def read_posed_truths(folder: Path) -> dict[int, PosedTruth]:
    """Read the truth of a dataset of posed images, by frame; see ``read_records``."""
    return {truth.frame: truth for truth in read_records(folder, PosedTruth.from_fields)}
