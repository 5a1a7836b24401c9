"""What one look at a frame came to: a pose or why none, what was seen, what else would fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from models.arrays import Floats
from models.estimate import NO_STATES, Detections, NamedState, PoseEstimate
from models.pose import RigidTransform

FARTHEST_M = 1e4  # beyond it no dot is a pixel, in any camera


@dataclass(frozen=True, eq=False)
class Sighting:
    """A look.

    Attributes
    ----------
    pose : PoseEstimate or None
    reason : str or None
        Why there is none.
    detections : Detections
    mode : str
        ``dots`` or ``outline``, whichever made the pose.
    states : mapping of str to NamedState
    """

    pose: PoseEstimate | None
    reason: str | None
    detections: Detections
    mode: str = ""
    states: Mapping[str, NamedState] = field(default_factory=lambda: NO_STATES)

    @classmethod
    def blind(cls, reason: str) -> Sighting:
        """Return a look that saw nothing."""
        return cls(None, reason, Detections.none())

    @classmethod
    def without_pose(cls, reason: str, detections: Detections) -> Sighting:
        """Return a look that saw something, of which no pose follows."""
        return cls(None, reason, detections)

    @classmethod
    def with_pose(
        cls,
        pose: RigidTransform,
        covariance: Floats,
        residual_rms_px: float,
        detections: Detections,
        mode: str,
        states: Mapping[str, NamedState] = NO_STATES,
    ) -> Sighting:
        """Return a look that found ``cam_from_target``."""
        estimate = PoseEstimate(pose, covariance, residual_rms_px)
        return cls(estimate, None, detections, mode, states)
