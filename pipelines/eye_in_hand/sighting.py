"""What one look at a frame came to: a pose or why none, what was seen, what else would fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from models.estimate import NO_STATES, Detections, NamedState, PoseEstimate

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


def blind(reason: str) -> Sighting:
    """Return a look that saw nothing."""
    return Sighting(None, reason, Detections.none())
