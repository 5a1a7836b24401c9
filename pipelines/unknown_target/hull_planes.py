"""Rows of ranges to the hull that outlines carve: each by the outline that its beam crosses there.

Where a beam enters the hull, the edge of one silhouette passes: the plane through that camera and
that edge touches the target or leaves it behind. So a range says that its end lies on that plane,
which depends on how the target stood in both frames. A pose that errs is an unknown of the row and
no error of it, and a beam that grazes the plane tells little of the distance by itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Indices, Mask
from pipelines.unknown_target.observation_rows import FACING, NEAREST_M, Placed, Rows, cross
from pipelines.unknown_target.unknowns import PLACE, SHARED, TURN

NONE = -1


@dataclass(frozen=True, eq=False)
class HullPlanes:
    """A plane for each range.

    Attributes
    ----------
    view : (m,) int array
        The frame of the silhouette, a place among the epochs; -1 where the hull is not known.
    normal : (m, 3) array
        Of the plane through that camera, in its axes, outwards; of unit length across the
        boresight: its product with a ray of depth 1 is the angle by which that passes the edge.
    behind_m : (m,) array, m
        How far behind the plane the surface is thought to be, along the beam.
    spread_m : (m,) array, m
        1 sigma of that.
    """

    view: Indices
    normal: Floats
    behind_m: Floats
    spread_m: Floats

    @classmethod
    def none(cls, count: int) -> HullPlanes:
        """Return so many that are none."""
        return cls(
            np.full(count, NONE, dtype=np.int64), np.zeros((count, 3)), *np.zeros((2, count))
        )

    @property
    def known(self) -> Mask:
        """(m,) bool array."""
        return self.view >= 0

    def take(self, which: Mask | slice) -> HullPlanes:
        """Return some of them.

        Parameters
        ----------
        which : (m,) bool array or slice
        """
        return HullPlanes(*(part[which] for part in vars(self).values()))

    def followed_by(self, other: HullPlanes) -> HullPlanes:
        """Return both, one after the other."""
        both = zip(vars(self).values(), vars(other).values(), strict=True)
        return HullPlanes(*(np.concatenate(pair) for pair in both))


def hull_rows(
    views: Placed,
    beams: Placed,
    planes: HullPlanes,
    range_m: Floats,
    sigma_m: Floats,
    sigma_rad: float,
) -> tuple[Rows, Floats]:
    """Return the rows of ranges to the hull, and the sigma of each along its beam, (m,) m.

    That sigma is infinite where the hull is not known, and so is the row's error.

    Parameters
    ----------
    views, beams : Placed
        The frames of the silhouettes and of the ranges, one each a range; any where the hull is
        not known.
    planes : HullPlanes
    range_m, sigma_m : (m,) array, m
    sigma_rad : float, rad
        By which a silhouette's edge errs.
    """
    turn, origin = beams.R_cam_from_target, beams.t_cam_from_target
    along = turn[:, 2]
    met = (range_m - planes.behind_m)[:, None] * along - np.einsum(
        "mji,mj->mi", turn, origin
    )  # body axes
    in_view = np.einsum("mij,mj->mi", views.R_cam_from_target, met) + views.t_cam_from_target
    depth = np.where(planes.known & (in_view[:, 2] > NEAREST_M), in_view[:, 2], np.nan)
    normal = np.einsum("mji,mj->mi", views.R_cam_from_target, planes.normal) / depth[:, None]
    steep = np.maximum(np.abs(np.sum(normal * along, axis=1)), FACING / depth)
    sigma = np.sqrt(sigma_rad**2 + steep**2 * (sigma_m**2 + planes.spread_m**2))
    passes = np.sum(planes.normal * in_view, axis=1) / depth
    turned = cross(met, normal)[:, None]
    by_beam = -np.einsum("mij,mj->mi", turn, normal)[:, None]
    by_view = (planes.normal / depth[:, None])[:, None]
    by_shared = np.empty((len(range_m), 1, SHARED))
    by_shared[:, :, TURN] = turned @ (views.turn_by_rest - beams.turn_by_rest)
    by_shared[:, :, PLACE] = by_view @ views.origin_by_place + by_beam @ beams.origin_by_place
    rows = Rows(
        by_shared / sigma[:, None, None],
        np.zeros((len(range_m), 1, 3)),
        -(passes / sigma)[:, None],
        np.zeros(len(range_m), dtype=np.int64),
    )
    told = sigma / steep
    return rows, np.where(np.isfinite(told), told, np.inf)
