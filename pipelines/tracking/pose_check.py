"""Whether a pose fits an image: edges where they should be, and no light where none can be.

A right pose finds a step in brightness at nearly all of its visible edges that lie in any light,
leaves no light outside the silhouette, and little of the silhouette without light. A wrong one
fails at one of them. What the wireframe leaves out (antennas, foil) costs a right pose a little of
each, so the bounds stand off from 1, as measured.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from models.pose import RigidTransform
from pipelines.tracking.edge_fit import EdgeImage, search_steps
from pipelines.tracking.model_edges import ModelEdges

NEAR_SHARE = 0.0025  # of the image's width: an edge this near to its step is supported
LEAST_NEAR_PX = 1.5
FEWEST_LIT = 20
DARK_COUNTS = 0.3  # for little: faces that neither Sun nor Earth lights are dark at a right pose


@dataclass(frozen=True)
class PoseCheck:
    """How a pose fits an image; each share from 0 to 1.

    Attributes
    ----------
    supported : float
        Of the visible edges in any light, those with a step where it should be.
    outside : float
        Of the light, that beyond the silhouette.
    dark : float
        Of the silhouette, that without light.
    unseen : float
        Of the visible edges, those without light on either side.
    """

    supported: float
    outside: float
    dark: float
    unseen: float

    @property
    def score(self) -> float:
        """All in one number, 1 for a perfect fit."""
        return self.supported * ((1.0 - self.outside) * (1.0 - DARK_COUNTS * self.dark)) ** 2


NO_FIT = PoseCheck(0.0, 1.0, 1.0, 1.0)


def check_pose(image: EdgeImage, edges: ModelEdges, pose: RigidTransform) -> PoseCheck:
    """Hold a pose against an image.

    Parameters
    ----------
    image : EdgeImage
    edges : ModelEdges
    pose : RigidTransform
        ``cam_from_target``.
    """
    shown = edges.shown(image.camera, pose)
    if len(shown) == 0 or not image.target:
        return NO_FIT
    near_px = max(NEAR_SHARE * image.camera.width, LEAST_NEAR_PX)
    steps = search_steps(image, shown, near_px)
    in_light = ~steps.dark
    if in_light.sum() < FEWEST_LIT:
        return NO_FIT
    supported = float((steps.found & in_light).sum() / in_light.sum())
    silhouette = edges.silhouette(image.camera, pose)
    lit = image.target.lit
    reach = 2 * round(near_px) + 1
    widened = cv2.dilate(silhouette.astype(np.uint8), np.ones((reach, reach), np.uint8)) > 0
    narrowed = cv2.erode(silhouette.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    return PoseCheck(
        supported=supported,
        outside=float((lit & ~widened).sum() / lit.sum()),
        dark=float((narrowed & ~lit).sum() / max(narrowed.sum(), 1)),
        unseen=1.0 - float(in_light.mean()),
    )
