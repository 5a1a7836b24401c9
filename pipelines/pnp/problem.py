"""A Perspective-n-Point problem: matched points with their weights."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models.arrays import Floats, Mask
from models.camera import Camera
from pipelines.pnp.projection_jacobian import jacobian_by_turn, project_normalised

DISTORTION_STEP = 1e-6  # normalised coordinates; central differences then err by about 1e-11


def undistortion_gain(camera: Camera, normalised: Floats) -> Floats:
    """Return d(undistorted normalised) / d(pixel), (n, 2, 2), at undistorted coordinates."""
    steps = DISTORTION_STEP * np.eye(2)
    columns = [
        (camera.distort(normalised + step) - camera.distort(normalised - step))
        / (2.0 * DISTORTION_STEP)
        for step in steps
    ]
    pixels_by_normalised = np.stack(columns, axis=-1) * np.array([[camera.fx], [camera.fy]])
    return np.linalg.inv(pixels_by_normalised)


@dataclass(frozen=True, eq=False)
class PnpProblem:
    """Matched points, undistorted, and what each is worth.

    Attributes
    ----------
    points_in_target : (n, 3) array, m
    observed : (n, 2) array
        Undistorted normalised image coordinates.
    whitening : (n, 2, 2) array
        ``W`` with ``W^T W`` the inverse covariance of an observation; identity where all are
        worth the same, as in the paper.
    common : (n, 2, k) array, optional
        What k errors that all observations share, 1 sigma of each, do to them, whitened.
    """

    points_in_target: Floats
    observed: Floats
    whitening: Floats
    common: Floats | None = None

    def __len__(self) -> int:
        return len(self.observed)

    @classmethod
    def unweighted(cls, camera: Camera, points_in_target: Floats, pixels: Floats) -> PnpProblem:
        """Take all points alike; chi2 is then in squared normalised units (equation 9).

        Parameters
        ----------
        camera : Camera
        points_in_target : (n, 3) array, m
        pixels : (n, 2) array, px
        """
        identity = np.broadcast_to(np.eye(2), (len(pixels), 2, 2))
        return cls(points_in_target, camera.normalise(pixels), identity)

    @classmethod
    def weighted(
        cls,
        camera: Camera,
        points_in_target: Floats,
        pixels: Floats,
        covariance_px: Floats,
        common_px: Floats | None = None,
    ) -> PnpProblem:
        """Weigh points by their covariances; chi2 then follows chi-square.

        Parameters
        ----------
        camera : Camera
        points_in_target : (n, 3) array, m
        pixels : (n, 2) array, px
        covariance_px : (n, 2, 2) array, px^2
            Of what each errs by alone.
        common_px : (n, 2, k) array, px, optional
            What k errors that all share, 1 sigma of each, do to them.
        """
        observed = camera.normalise(pixels)
        gain = undistortion_gain(camera, observed)
        covariance = gain @ covariance_px @ gain.transpose(0, 2, 1)
        whitening = np.linalg.inv(np.linalg.cholesky(covariance))
        common = None if common_px is None else whitening @ gain @ common_px
        return cls(points_in_target, observed, whitening, common)

    def subset(self, keep: Mask) -> PnpProblem:
        """Return the problem of some of the matches.

        Parameters
        ----------
        keep : (n,) array of bool
        """
        return PnpProblem(
            self.points_in_target[keep],
            self.observed[keep],
            self.whitening[keep],
            None if self.common is None else self.common[keep],
        )

    @cached_property
    def decorrelating(self) -> Floats:
        """(2n, 2n) array: takes out what observations, whitened one by one, still share."""
        count = 2 * len(self)
        if self.common is None:
            return np.eye(count)
        shared = self.common.reshape(count, -1)
        root = np.linalg.cholesky(np.eye(count) + shared @ shared.T)
        return np.asarray(np.linalg.inv(root))

    def residuals(self, rotation: Floats, translation: Floats) -> Floats:
        """Return whitened observed minus predicted, (n, 2); NaN behind the camera."""
        predicted = project_normalised(rotation, translation, self.points_in_target)
        each = np.einsum("nij,nj->ni", self.whitening, self.observed - predicted)
        if self.common is None:
            return each
        return np.asarray((self.decorrelating @ each.reshape(-1)).reshape(-1, 2))

    def jacobian(self, rotation: Floats, translation: Floats) -> Floats:
        """Return the whitened Jacobian of the prediction, (2n, 6), by turn and translation."""
        plain = jacobian_by_turn(rotation, translation, self.points_in_target)
        each = (self.whitening @ plain).reshape(-1, 6)
        return each if self.common is None else np.asarray(self.decorrelating @ each)
