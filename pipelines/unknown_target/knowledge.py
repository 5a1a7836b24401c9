"""What the pipeline for an unknown target must know before the first image."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.camera import Camera
from models.errors import DatasetError
from models.frame import CHASER_ORBIT, Frame
from models.motion.clohessy_wiltshire import EARTH_MU_M3_S2
from models.motion.relative_state import CHASER_ORBIT_COLUMNS
from models.onboard import OnboardKnowledge, needed
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector

NAME = "unknown_target"


@dataclass(frozen=True, eq=False)
class UnknownTargetKnowledge:
    """The parts of what is on board that this pipeline cannot do without; none is of the target.

    Attributes
    ----------
    camera : Camera
        As calibrated.
    cam_from_lvlh : RigidTransform
        How the camera is mounted: the chaser's body frame is its local frame, which at tens of
        metres is the target's.
    detector : Detector or None
        As calibrated.
    range_m : (float, float) or None, m
        Nearest and farthest, where a coarse range is known.
    """

    camera: Camera
    cam_from_lvlh: RigidTransform
    detector: Detector | None = None
    range_m: tuple[float, float] | None = None

    @classmethod
    def of(cls, onboard: OnboardKnowledge) -> UnknownTargetKnowledge:
        """Take the parts that are needed.

        Raises
        ------
        DatasetError
            If the camera or its mount is not on board.
        """
        expected = needed(onboard.expectations, "knowledge.toml", NAME)
        return cls(
            needed(onboard.camera, "camera.toml", NAME),
            expected.cam_from_lvlh,
            onboard.detector,
            expected.range_m,
        )


def mean_motion_of(frame: Frame) -> float:
    """Return the mean motion of the chaser's orbit, rad/s, as its navigation has it in a frame.

    Raises
    ------
    DatasetError
        If the frame tells no orbit, or one that is not closed.
    """
    table = frame.table(CHASER_ORBIT)
    if not len(table.time_s):
        raise DatasetError(f"frame {frame.index}: expected a row of {CHASER_ORBIT}, got none")
    row = np.array([table.column(name)[-1] for name in CHASER_ORBIT_COLUMNS])
    inverse = 2.0 / float(np.linalg.norm(row[:3])) - float(row[3:] @ row[3:]) / EARTH_MU_M3_S2
    if not inverse > 0.0:
        raise DatasetError(
            f"frame {frame.index}: expected the chaser on a closed orbit, got {row.tolist()}; "
            f"mend the stream {CHASER_ORBIT!r}"
        )
    return float(np.sqrt(EARTH_MU_M3_S2 * inverse**3))
