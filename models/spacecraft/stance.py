"""Where the pieces of a chaser stand in its camera's axes: its body, and what its joints carry."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.pose import RigidTransform
from models.spacecraft.part import Part


@dataclass(frozen=True, eq=False)
class Stance:
    """A chaser at an instant.

    Attributes
    ----------
    cam_from_frames : tuple of RigidTransform
        By the number of a part's frame: the body's, then those of the arm's links.
    """

    cam_from_frames: tuple[RigidTransform, ...]

    def corners(self, part: Part) -> Floats:
        """Return a part's vertices in the camera's axes, (n, 3), m."""
        vertices = np.asarray(part.mesh.vertices, dtype=np.float64)
        return self.cam_from_frames[part.frame] @ vertices


BODY_ALONE = Stance((RigidTransform.identity(),))
"""A chaser of one piece, whose frame is its camera's."""
