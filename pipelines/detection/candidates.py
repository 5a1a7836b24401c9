"""Blobs that may be markers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Mask


@dataclass(frozen=True, eq=False)
class Candidates:
    """What detection hands to identification.

    Attributes
    ----------
    points_px : (n, 2) array, px
        Centroids; pixel centres are integers.
    """

    points_px: Floats

    def __len__(self) -> int:
        return len(self.points_px)

    @classmethod
    def none(cls) -> Candidates:
        """Return no candidates."""
        return cls(np.zeros((0, 2)))

    def kept(self, keep: Mask) -> Candidates:
        """Return only those marked True.

        Parameters
        ----------
        keep : (n,) array of bool
        """
        return Candidates(self.points_px[keep])

    @classmethod
    def merged(cls, parts: Iterable[Candidates], same_px: float) -> Candidates:
        """Join candidates of overlapping regions; nearer than ``same_px`` they are the same."""
        gathered = list(parts)
        if not gathered:
            return cls.none()
        points = np.concatenate([part.points_px for part in gathered])
        gaps = np.linalg.norm(points[:, None] - points[None, :], axis=-1)
        first = np.argmax(gaps < same_px, axis=1) if len(points) else np.zeros(0)
        return cls(points).kept(first == np.arange(len(points)))
