"""What two outlines say of how the target turned between them, without a point that is followed.

A plane through both cameras that touches the target touches both its outlines: seen about the line
between the cameras, both begin and end at the same angles (epipolar tangency; Cipolla, Astrom and
Giblin, Motion from the Frontier of Curved Surfaces, ICCV 1995). What touches is a place of the
target that both see, whatever its look, so that this holds a revolution later as it does at once,
where tracks have ended or slid. Only the outermost planes are asked for, so that an outline is as
good as its convex hull.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np

from models.arrays import Floats, Indices, Mask
from models.camera import Camera
from pipelines.unknown_target import robust_weights
from pipelines.unknown_target.observation_rows import Placed, Rows, cross
from pipelines.unknown_target.unknowns import PLACE, SHARED, TURN

LEAST_DEG, MOST_DEG = 10.0, 130.0  # between two views: beyond, one camera is seen behind the target
PARTNERS = 12  # earlier outlines with which each is compared
RIM_PX = 1  # of the image, where what is seen of a target may end
FEWEST_CORNERS = 3


@dataclass(eq=False)
class Outlines:
    """Convex hulls of what was covered in some frames.

    Attributes
    ----------
    camera : Camera
    frames : list of int
        Places among the epochs.
    corners : list of (k, 2) arrays
        Undistorted, in units of the focal length.
    inside : list of (k,) bool arrays
        Corners that are none of the image's border.
    """

    camera: Camera
    frames: list[int] = field(default_factory=list)
    corners: list[Floats] = field(default_factory=list)
    inside: list[Mask] = field(default_factory=list)

    def __len__(self) -> int:
        return len(self.frames)

    def add(self, frame: int, covered: Mask) -> None:
        """Keep one more, if it has an outline at all.

        Parameters
        ----------
        frame : int
        covered : (height, width) bool array
        """
        rows, columns = np.nonzero(covered)
        if len(rows) < FEWEST_CORNERS:
            return
        places = np.column_stack([columns, rows]).astype(np.int32)
        pixels = cv2.convexHull(places).reshape(-1, 2).astype(np.float64)
        if len(pixels) < FEWEST_CORNERS:
            return
        last = np.array(covered.shape[::-1]) - 1 - RIM_PX
        self.frames.append(frame)
        self.corners.append(self.camera.normalise(pixels))
        self.inside.append(((pixels > RIM_PX) & (pixels < last)).all(axis=1))

    def padded(self) -> tuple[Floats, Mask]:
        """Return rays of all corners, (n, k, 3) of depth 1, and which are of no border, (n, k)."""
        most = max(len(each) for each in self.corners)
        rays = np.ones((len(self), most, 3))
        inside = np.zeros((len(self), most), dtype=bool)
        for place, (corners, own) in enumerate(zip(self.corners, self.inside, strict=True)):
            which = np.minimum(np.arange(most), len(corners) - 1)
            rays[place, :, :2], inside[place] = corners[which], own[which]
        return rays, inside


def pairs_of(own: Placed) -> Indices:
    """Return which outlines are compared with which, (m, 2) int: each with some earlier ones.

    Parameters
    ----------
    own : Placed
        The frames of the outlines.
    """
    views = own.R_cam_from_target[:, 2]
    cosine = views @ views.T
    far_enough = (cosine < np.cos(np.deg2rad(LEAST_DEG))) & (cosine > np.cos(np.deg2rad(MOST_DEG)))
    found = [np.zeros((0, 2), dtype=np.int64)]
    for later in range(1, len(views)):
        earlier = np.flatnonzero(far_enough[later, :later])
        if len(earlier) > PARTNERS:
            spread = np.linspace(0, len(earlier) - 1, PARTNERS)
            earlier = earlier[np.round(spread).astype(np.int64)]
        found.append(np.column_stack([earlier, np.full(len(earlier), later)]))
    return np.concatenate(found)


def outline_rows(own: Placed, outlines: Outlines, pairs: Indices, sigma_rad: float) -> Rows:
    """Return the rows of pairs of outlines, two for each: of both outermost planes.

    The error of a pair is the angle by which both places that a plane touches miss a common plane
    through the cameras, shared between both images (Sampson's distance). No point has a part in it.

    Parameters
    ----------
    own : Placed
        The frames of the outlines.
    outlines : Outlines
    pairs : (m, 2) int array
        Places among the outlines.
    sigma_rad : float, rad
        By which an outline errs.
    """
    if not len(pairs):
        return Rows.none()
    rays, inside = outlines.padded()
    first, second = pairs.T
    turns = own.R_cam_from_target
    centres = -np.einsum("fji,fj->fi", turns, own.t_cam_from_target)
    base = centres[second] - centres[first]
    up = cross(base, -(centres[first] + centres[second]))
    ahead = cross(up, base)
    up /= np.linalg.norm(up, axis=1)[:, None]
    ahead /= np.linalg.norm(ahead, axis=1)[:, None]
    in_body = rays @ turns  # rows times a turn: turned back
    count = np.arange(len(pairs))
    about = [
        np.arctan2(
            np.einsum("mki,mi->mk", in_body[each], up),
            np.einsum("mki,mi->mk", in_body[each], ahead),
        )
        for each in (first, second)
    ]
    parts = []
    for side in (np.argmin, np.argmax):
        a, b = (side(angles, axis=1) for angles in about)
        rows = _coplanar(own, first, second, base, in_body[first, a], in_body[second, b], sigma_rad)
        whole = inside[first, a] & inside[second, b]
        whole &= np.abs(about[0][count, a] - about[1][count, b]) < np.pi / 2
        parts.append((rows, whole))
    whole = np.concatenate([each for _, each in parts])
    return Rows(
        np.concatenate([rows.by_shared for rows, _ in parts]) * whole[:, None, None],
        np.concatenate([rows.by_point for rows, _ in parts]),
        np.concatenate([rows.error for rows, _ in parts]) * whole[:, None],
        np.concatenate([rows.who for rows, _ in parts]),
    )


def doubted_outlines(
    outlines: Outlines, pairs: Indices, rows: Rows, gate_sigmas: float
) -> frozenset[int]:
    """Return the frames whose outlines disagree with most others: a part of them is in shadow.

    Parameters
    ----------
    outlines : Outlines
    pairs : (m, 2) int array
    rows : Rows
        Of these pairs.
    gate_sigmas : float
        The median error of an outline's rows, in what most rows err, above which it is doubted.
    """
    if not len(rows.who):
        return frozenset()
    sizes = rows.sizes
    gate = gate_sigmas * robust_weights.spread(sizes, 1) * robust_weights.MEDIANS[1]
    whose = np.concatenate([pairs, pairs])
    return frozenset(
        frame
        for place, frame in enumerate(outlines.frames)
        if (own := (whose == place).any(axis=1)).any() and np.median(sizes[own]) > gate
    )


def _coplanar(
    own: Placed,
    first: Indices,
    second: Indices,
    base: Floats,
    ray_a: Floats,
    ray_b: Floats,
    sigma_rad: float,
) -> Rows:
    """Return the rows of rays in body axes that ought to lie in a plane with the base."""
    turn_a, turn_b = own.R_cam_from_target[first], own.R_cam_from_target[second]
    centre_a = -np.einsum("mji,mj->mi", turn_a, own.t_cam_from_target[first])
    centre_b = -np.einsum("mji,mj->mi", turn_b, own.t_cam_from_target[second])
    normal = cross(ray_a, ray_b)
    by_a, by_b = cross(ray_b, base), cross(base, ray_a)
    in_image = [
        np.einsum("mij,mj->mi", turn, by)[:, :2] for turn, by in ((turn_a, by_a), (turn_b, by_b))
    ]
    scale = sigma_rad * np.sqrt(sum(np.sum(each**2, axis=1) for each in in_image))
    scale = np.maximum(scale, 1e-12)
    turned_a = cross(centre_a, normal) - cross(ray_a, by_a)
    turned_b = -cross(centre_b, normal) - cross(ray_b, by_b)
    by_shared = np.empty((len(first), 1, SHARED))
    by_shared[:, :, TURN] = (
        turned_a[:, None] @ own.turn_by_rest[first] + turned_b[:, None] @ own.turn_by_rest[second]
    )
    moved_a, moved_b = (np.einsum("mij,mj->mi", turn, normal) for turn in (turn_a, turn_b))
    by_shared[:, :, PLACE] = (
        moved_a[:, None] @ own.origin_by_place[first]
        - moved_b[:, None] @ own.origin_by_place[second]
    )
    error = -np.einsum("mi,mi->m", base, normal) / scale
    nobody = np.zeros(len(first), dtype=np.int64)
    return Rows(
        by_shared / scale[:, None, None],
        np.zeros((len(first), 1, 3)),
        error[:, None],
        nobody,
    )
