"""The points of a target that a label tells of, and why each can or cannot be seen in an image.

States are told apart: ``visible``; ``shadow``, in view but with no light on it; ``hidden``, behind
the target or the chaser; ``outside`` the field of view.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Mask
from models.camera import Camera
from models.markers import MarkerPattern
from models.pose import RigidTransform
from models.wireframe.wireframe import Wireframe

VISIBLE, SHADOW, HIDDEN, OUTSIDE = "visible", "shadow", "hidden", "outside"
STATES = (VISIBLE, SHADOW, HIDDEN, OUTSIDE)
HALF = 0.5  # of a marker's face: a marker is seen, or lit, if most of it is
MIRROR_M = 0.02  # two landmarks nearer than this to each other's mirror image are a pair


@dataclass(frozen=True, eq=False)
class KeypointModel:
    """Named points of a target and the lines between them.

    Attributes
    ----------
    names : tuple of str
    points_in_target : (k, 3) array, m
    skeleton : tuple of (int, int)
        Pairs of points joined by a straight edge.
    markers : int
        How many of the points, at the end, are markers.
    """

    names: tuple[str, ...]
    points_in_target: Floats
    skeleton: tuple[tuple[int, int], ...] = ()
    markers: int = 0

    def __len__(self) -> int:
        return len(self.names)

    def mirrored(self) -> tuple[int, ...] | None:
        """Return for each point its partner on the other side of a plane of symmetry.

        Planes through the origin across one of the target's axes are tried.

        Returns
        -------
        tuple of int, or None
            None where no plane carries the points onto each other.
        """
        for axis in range(3):
            across = self.points_in_target * np.where(np.arange(3) == axis, -1.0, 1.0)
            apart = np.linalg.norm(across[:, None] - self.points_in_target[None], axis=-1)
            partner = apart.argmin(axis=1)
            paired = apart.min(axis=1, initial=np.inf) <= MIRROR_M
            if len(self) and paired.all() and len(set(partner.tolist())) == len(self):
                return tuple(int(each) for each in partner)
        return None


def keypoint_model(wireframe: Wireframe | None, markers: MarkerPattern | None) -> KeypointModel:
    """Return a target's landmarks, then its markers."""
    names: list[str] = []
    points: list[Floats] = [np.empty((0, 3))]
    skeleton: tuple[tuple[int, int], ...] = ()
    if wireframe is not None:
        names += wireframe.landmark_names
        points.append(wireframe.points_in_target)
        skeleton = tuple((int(a), int(b)) for a, b in wireframe.edges)
    if markers is not None:
        names += [f"marker_{name}" for name in markers.names]
        points.append(markers.points_in_target)
    count = 0 if markers is None else len(markers)
    return KeypointModel(tuple(names), np.concatenate(points), skeleton, count)


def projected(model: KeypointModel, camera: Camera, cam_from_target: RigidTransform) -> Floats:
    """Return where the points fall, (k, 2) px; NaN behind the lens or beyond its fold.

    Parameters
    ----------
    model : KeypointModel
    camera : Camera
        The true one.
    cam_from_target : RigidTransform
    """
    return camera.project(cam_from_target @ model.points_in_target)


def states_of(points_px: Floats, camera: Camera, seen: Mask, lit: Mask) -> tuple[str, ...]:
    """Return each point's state.

    Parameters
    ----------
    points_px : (k, 2) array, px
        NaN where a point has no projection.
    camera : Camera
    seen : (k,) array of bool
        Whether nothing stands before it.
    lit : (k,) array of bool
        Whether the Sun or a lamp reaches it.
    """
    inside = camera.contains(np.nan_to_num(points_px, nan=-1e9))
    return tuple(
        OUTSIDE if not held else HIDDEN if not clear else VISIBLE if bright else SHADOW
        for held, clear, bright in zip(inside, seen, lit, strict=True)
    )
