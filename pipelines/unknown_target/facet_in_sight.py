"""The piece of surface that the beam of a range finder meets: between points seen beside it.

The hull of all points is no surface of a body with wings: a beam between a wing and a tube would
meet it in empty space. What is certain is what the image shows: the points seen about the beam at
that moment, and the triangle of them in which it falls.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import Delaunay, QhullError

from models.arrays import Floats, Indices, Mask
from pipelines.unknown_target.observation_rows import NEAREST_M, Placed, Rows, cross
from pipelines.unknown_target.unknowns import PLACE, SHARED, TURN

NONE = -1


@dataclass(frozen=True, eq=False)
class Facets:
    """Triangles of points, one for each range.

    Attributes
    ----------
    corners : (m, 3) int array
        Places among the points; -1 where the beam fell in none.
    share : (m, 3) array
        Barycentric coordinates of the beam in the image.
    """

    corners: Indices
    share: Floats

    @classmethod
    def none(cls, count: int) -> Facets:
        """Return so many that are none."""
        return cls(np.full((count, 3), NONE, dtype=np.int64), np.zeros((count, 3)))

    def take(self, which: Mask | slice) -> Facets:
        """Return some of them.

        Parameters
        ----------
        which : (m,) bool array or slice
        """
        return Facets(self.corners[which], self.share[which])

    def followed_by(self, other: Facets) -> Facets:
        """Return both, one after the other."""
        return Facets(
            np.concatenate([self.corners, other.corners]),
            np.concatenate([self.share, other.share]),
        )


def facet_in_sight(seen: Floats, who: Indices) -> Facets:
    """Return the triangle of points about the boresight in an image, one or none.

    Parameters
    ----------
    seen : (n, 2) array
        Undistorted, in units of the focal length: the boresight is at zero.
    who : (n,) int array
        Places of these among the points.
    """
    try:
        mesh = Delaunay(seen)
    except (QhullError, ValueError):  # fewer than three, or all in a line
        return Facets.none(1)
    found = int(mesh.find_simplex(np.zeros((1, 2)))[0])
    if found < 0:
        return Facets.none(1)
    corners = mesh.simplices[found]
    a, b, c = seen[corners]
    two = np.linalg.solve(np.column_stack([b - a, c - a]), -a)
    share = np.array([1.0 - two.sum(), *two])
    return Facets(who[corners][None].astype(np.int64), share[None])


def facet_rows(
    where: Placed,
    points: Floats,
    used: Mask,
    facets: Facets,
    frame: Indices,
    range_m: Floats,
    sigma_m: Floats,
    relief_share: float,
) -> Rows:
    """Return the rows of distances to the surface between points seen about the beam.

    A row tells of the corner nearest to the beam: the step from it along the beam is taken from
    the shape as it is now, so that the equations remain an arrow.

    Parameters
    ----------
    where : Placed
    points : (n, 3) array, m
    used : (n,) bool array
        Points that are believed in.
    facets : Facets
        One for each range.
    frame : (m,) int array
        A place in ``where``.
    range_m, sigma_m : (m,) array, m
    relief_share : float
        1 sigma by which the surface lies off a facet, as a share of its longest side.
    """
    corners = np.maximum(facets.corners, 0)
    there = (facets.corners >= 0).all(axis=1) & used[corners].all(axis=1)
    turn = where.R_cam_from_target[frame]
    places = points[corners]
    origin = where.t_cam_from_target[frame]
    depth = np.einsum("mj,mkj->mk", turn[:, 2], places) + origin[:, 2, None]
    there &= (depth > NEAREST_M).all(axis=1)
    near = np.where(there[:, None], depth, np.nan)
    met = 1.0 / np.sum(facets.share / near, axis=1)
    sides = np.linalg.norm(places - np.roll(places, 1, axis=1), axis=2).max(axis=1, initial=0.0)
    sigma = np.hypot(sigma_m, relief_share * sides)
    nearest = corners[np.arange(len(frame)), facets.share.argmax(axis=1)]
    by_cam = np.zeros((len(frame), 1, 3))
    by_cam[:, 0, 2] = 1.0 / sigma
    by_point = by_cam @ turn
    by_shared = np.empty((len(frame), 1, SHARED))
    by_shared[:, :, PLACE] = by_cam @ where.origin_by_place[frame]
    by_shared[:, :, TURN] = cross(points[nearest][:, None], by_point) @ where.turn_by_rest[frame]
    return Rows(by_shared, by_point, ((range_m - met) / sigma)[:, None], nearest)
