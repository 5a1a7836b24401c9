"""Detected points matched with markers, and the pose they give."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Indices, Mask
from models.pose import RigidTransform


@dataclass(frozen=True, eq=False)
class Match:
    """Points that are believed to be markers.

    Attributes
    ----------
    points_px : (n, 2) array, px
    covariance_px2 : (n, 2, 2) array, px^2
    marker : (n,) int array
        Index of each point's marker; no marker occurs twice.
    """

    points_px: Floats
    covariance_px2: Floats
    marker: Indices

    def __len__(self) -> int:
        return len(self.marker)

    @property
    def sigma_px(self) -> Floats:
        """(n, 2) array, px: 1-sigma in u and v."""
        return np.sqrt(np.diagonal(self.covariance_px2, axis1=1, axis2=2))

    def kept(self, keep: Mask) -> Match:
        """Return only the pairs marked True, of (n,)."""
        return Match(self.points_px[keep], self.covariance_px2[keep], self.marker[keep])

    def widened(self, variance_px2: float) -> Match:
        """Add a variance, the same to every axis of every point."""
        wider = self.covariance_px2 + variance_px2 * np.eye(2)
        return Match(self.points_px, wider, self.marker)


@dataclass(frozen=True, eq=False)
class Solution:
    """A pose from a match.

    Attributes
    ----------
    pose : RigidTransform
        ``cam_from_target``.
    covariance : (6, 6) array, rad and m
        Rotation first, as in ``RigidTransform.perturbed``.
    match : Match
        All pairs offered, with the covariances that the solver believed in the end.
    used : (n,) array of bool
        Those the solver kept.
    residual_rms_px : float, px
        Of the kept pairs, per axis.
    """

    pose: RigidTransform
    covariance: Floats
    match: Match
    used: Mask
    residual_rms_px: float
