"""What the pipeline for an uncooperative, known target may see, and what it must say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from models.arrays import Floats, Image
from models.camera import Camera
from models.errors import DatasetError
from models.estimate import Estimate
from models.motion.relative_state import ChaserState, RelativeState
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector
from models.wireframe.wireframe import Wireframe

Mode = Literal["searching", "acquired", "tracked", "predicted"]


@dataclass(frozen=True, eq=False)
class PointFrame:
    """Corners found in one image by somebody else, in no order and without names.

    Attributes
    ----------
    index : int
    time_s : float, s
    points_px : (n, 2) array, px
        Pixel centres are integers.
    chaser : ChaserState
        As the chaser's absolute navigation has it, errors and all.
    """

    index: int
    time_s: float
    points_px: Floats
    chaser: ChaserState


@dataclass(frozen=True, eq=False)
class ImageFrame:
    """One image, as a flight computer gets it.

    Attributes
    ----------
    index : int
    time_s : float, s
        Middle of the exposure, to which an estimate is stamped.
    image : (height, width) uint16 array, DN
    exposure_ms : float, ms
    chaser : ChaserState
        As the chaser's absolute navigation has it, errors and all.
    """

    index: int
    time_s: float
    image: Image
    exposure_ms: float
    chaser: ChaserState

    def __post_init__(self) -> None:
        if self.image.ndim != 2 or self.image.dtype != np.uint16:
            raise DatasetError(
                f"frame {self.index}: expected a (height, width) uint16 image, "
                f"got shape {self.image.shape} of {self.image.dtype}"
            )


@dataclass(frozen=True, eq=False)
class UncooperativeKnowledge:
    """What is loaded on board before the first frame.

    Attributes
    ----------
    camera : Camera
        As calibrated, not as simulated.
    target : Wireframe
        As drawn, not as built.
    cam_from_lvlh : RigidTransform
        How the camera is mounted: the chaser's body frame is its local frame.
    sigma_px : float, px
        1-sigma of a corner, per axis, as expected before flight.
    chaser_sigma_m, chaser_sigma_m_s : float, m and m/s
        1-sigma per axis of the chaser's absolute navigation.
    range_m : (float, float), optional, m
        A coarse range, nearest and farthest, if the user gives one.
    detector : Detector, optional
        As calibrated; where frames are images.
    inertia_kg_m2 : (3, 3) array, optional
        Of the target about its centre of mass, target axes, as known before flight; any multiple
        serves. Without it the filters take the rate as constant.
    """

    camera: Camera
    target: Wireframe
    cam_from_lvlh: RigidTransform
    sigma_px: float
    chaser_sigma_m: float = 0.0
    chaser_sigma_m_s: float = 0.0
    range_m: tuple[float, float] | None = None
    detector: Detector | None = None
    inertia_kg_m2: Floats | None = None


@dataclass(frozen=True, eq=False)
class NavigationEstimate:
    """What the pipeline says of one frame.

    Attributes
    ----------
    frame : int
    time_s : float, s
    mode : str
        ``searching``: no state yet; ``acquired``: a pose from this image alone; ``tracked``: a
        pose near the predicted one; ``predicted``: no pose from this image, the filter goes on.
    pose : PoseEstimate or NoPose
        From this image, before any filter; ``detections.marker`` counts landmarks.
    state : RelativeState or None
        After the filters; None while searching.
    translation_covariance : (6, 6) array or None, m and m/s
        Of (rho, rho_dot) in the local frame. For an H-infinity filter a bound, not a covariance.
    rotation_covariance : (6, 6) array or None, rad and rad/s
        Of (small turn, omega) in the target frame: ``R_true = R exp([turn]x)``.
    """

    frame: int
    time_s: float
    mode: Mode
    pose: Estimate
    state: RelativeState | None
    translation_covariance: Floats | None
    rotation_covariance: Floats | None

    def __bool__(self) -> bool:
        return self.state is not None
