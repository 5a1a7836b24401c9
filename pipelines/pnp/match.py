"""Detected points matched with markers, and the pose they give."""

from __future__ import annotations

from dataclasses import dataclass, replace

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
    common_px : (n, 2, k) array, px, optional
        What k errors that all points share (a calibration's), 1 sigma of each, do to them; the
        covariances are of the rest.
    """

    points_px: Floats
    covariance_px2: Floats
    marker: Indices
    common_px: Floats | None = None

    def __len__(self) -> int:
        return len(self.marker)

    @property
    def sigma_px(self) -> Floats:
        """(n, 2) array, px: 1-sigma in u and v."""
        return np.sqrt(np.diagonal(self.covariance_px2, axis1=1, axis2=2))

    def kept(self, keep: Mask) -> Match:
        """Return only the pairs marked True, of (n,)."""
        return Match(
            self.points_px[keep],
            self.covariance_px2[keep],
            self.marker[keep],
            None if self.common_px is None else self.common_px[keep],
        )

    def widened(self, variance_px2: float) -> Match:
        """Add a variance, the same to every axis of every point."""
        return replace(self, covariance_px2=self.covariance_px2 + variance_px2 * np.eye(2))


@dataclass(frozen=True, eq=False)
class Solution:
    """A pose from a match.

    Attributes
    ----------
    pose : RigidTransform
        ``cam_from_target``.
    covariance : (6, 6) array, rad and m
        Rotation first, as in ``RigidTransform.perturbed``.
    scatter : (6, 6) array, rad and m
        The part of it that is not common to the poses of one camera.
    match : Match
        All pairs offered, with the covariances that the solver believed in the end.
    used : (n,) array of bool
        Those the solver kept.
    residual_rms_px : float, px
        Of the kept pairs, per axis.
    """

    pose: RigidTransform
    covariance: Floats
    scatter: Floats
    match: Match
    used: Mask
    residual_rms_px: float
