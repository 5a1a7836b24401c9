"""All that was seen: points in images, and ranges, in the order in which they came."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from models.arrays import Floats, Indices, Mask
from pipelines.unknown_target.facet_in_sight import Facets, facet_in_sight
from pipelines.unknown_target.hull_planes import HullPlanes


@dataclass(frozen=True, eq=False)
class Sightings:
    """Points seen in images.

    Attributes
    ----------
    frame : (m,) int array
        Place among the epochs.
    who : (m,) int array
        Place among the points.
    seen : (m, 2) array
        Undistorted, in units of the focal length.
    sigma : (m,) array
        Of each axis, in the same unit.
    """

    frame: Indices
    who: Indices
    seen: Floats
    sigma: Floats

    @classmethod
    def none(cls) -> Sightings:
        """Return none at all."""
        return cls.of([], [], [], [])

    @classmethod
    def of(
        cls,
        frame: Iterable[int],
        who: Iterable[int],
        seen: Iterable[Floats],
        sigma: Iterable[float],
    ) -> Sightings:
        """Return sightings of lists.

        Parameters
        ----------
        frame, who : iterable of int
        seen : iterable of (2,) arrays
        sigma : iterable of float
        """
        return cls(
            np.array(list(frame), dtype=np.int64),
            np.array(list(who), dtype=np.int64),
            np.array(list(seen), dtype=np.float64).reshape(-1, 2),
            np.array(list(sigma), dtype=np.float64),
        )

    def __len__(self) -> int:
        return len(self.frame)

    def take(self, which: Mask | slice) -> Sightings:
        """Return some of them.

        Parameters
        ----------
        which : (m,) bool array or slice
        """
        return Sightings(self.frame[which], self.who[which], self.seen[which], self.sigma[which])

    def followed_by(self, other: Sightings) -> Sightings:
        """Return both, one after the other."""
        return Sightings(
            np.concatenate([self.frame, other.frame]),
            np.concatenate([self.who, other.who]),
            np.concatenate([self.seen, other.seen]),
            np.concatenate([self.sigma, other.sigma]),
        )


@dataclass(frozen=True, eq=False)
class Ranges:
    """Distances along the boresight.

    Attributes
    ----------
    frame : (m,) int array
        Place among the epochs.
    range_m, sigma_m : (m,) array, m
    facets : Facets
        Between which points each beam fell, as that image showed them.
    planes : HullPlanes
        Where silhouettes tell where each beam ends.
    """

    frame: Indices
    range_m: Floats
    sigma_m: Floats
    facets: Facets
    planes: HullPlanes

    @classmethod
    def none(cls) -> Ranges:
        """Return none at all."""
        return cls(
            np.zeros(0, dtype=np.int64),
            np.zeros(0),
            np.zeros(0),
            Facets.none(0),
            HullPlanes.none(0),
        )

    def __len__(self) -> int:
        return len(self.frame)

    def take(self, which: Mask | slice) -> Ranges:
        """Return some of them.

        Parameters
        ----------
        which : (m,) bool array or slice
        """
        return Ranges(
            self.frame[which], self.range_m[which], self.sigma_m[which], self.facets.take(which),
            self.planes.take(which),
        )  # fmt: skip

    def with_one(
        self, frame: int, range_m: float, sigma_m: float, facet: Facets, plane: HullPlanes
    ) -> Ranges:
        """Return these and one more.

        Parameters
        ----------
        frame : int
        range_m, sigma_m : float, m
        facet : Facets
        plane : HullPlanes
            One each.
        """
        return Ranges(
            np.append(self.frame, frame),
            np.append(self.range_m, range_m),
            np.append(self.sigma_m, sigma_m),
            self.facets.followed_by(facet),
            self.planes.followed_by(plane),
        )


def facets_found(ranges: Ranges, seen: Sightings, used: Mask) -> Ranges:
    """Return ranges between the points that are believed in by now.

    Parameters
    ----------
    ranges : Ranges
    seen : Sightings
    used : (n,) bool array
        The points.
    """
    good = seen.take(used[seen.who]) if len(seen) else seen
    order = np.argsort(good.frame, kind="stable")
    frames = good.frame[order]
    first = np.searchsorted(frames, ranges.frame, "left")
    last = np.searchsorted(frames, ranges.frame, "right")
    facets = Facets.none(0)
    for start, end in zip(first.tolist(), last.tolist(), strict=True):
        own = order[start:end]
        facets = facets.followed_by(facet_in_sight(good.seen[own], good.who[own]))
    return replace(ranges, facets=facets)
