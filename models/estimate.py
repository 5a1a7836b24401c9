"""What a pipeline must say of a frame: a pose, or a reason for none. Never identity, never NaN."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from models.arrays import Floats
from models.pose import RigidTransform


@dataclass(frozen=True)
class Detections:
    """What the image processing found in one frame.

    Attributes
    ----------
    points_px : (n, 2) array, px
        Blob centroids; pixel centres are integers.
    sigma_px : (n, 2) array, px
        Their 1-sigma as the pipeline believes it.
    marker : (n,) tuple of int
        Index of the matched marker, or -1.
    used : (n,) tuple of bool
        Whether the solver kept the match.
    """

    points_px: Floats
    sigma_px: Floats
    marker: tuple[int, ...]
    used: tuple[bool, ...]


@dataclass(frozen=True)
class PoseEstimate:
    """A pose found.

    Attributes
    ----------
    frame : int
    time_s : float, s
    cam_from_target : RigidTransform
    covariance : (6, 6) array, rad and m
        Rotation first, in the camera's axes: see ``RigidTransform.perturbed``.
    detections : Detections
    residual_rms_px : float, px
        Root mean square of the reprojection error per axis, over the matches used.
    """

    frame: int
    time_s: float
    cam_from_target: RigidTransform
    covariance: Floats
    detections: Detections
    residual_rms_px: float
    status: Literal["pose"] = "pose"

    def __bool__(self) -> bool:
        return True


@dataclass(frozen=True)
class NoPose:
    """No pose, and why. Falsy."""

    frame: int
    time_s: float
    reason: str
    detections: Detections
    status: Literal["no pose"] = "no pose"

    def __bool__(self) -> bool:
        return False


Estimate: TypeAlias = PoseEstimate | NoPose
