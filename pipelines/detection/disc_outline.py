"""Where and how large a marker's disc should appear: its projected outline, from a pose.

A circle seen in perspective is an ellipse whose centre is not the projection of the circle's
centre: 0.004 px apart at 6.7 m, but 0.035 px at 1.8 m and 20 deg of tilt. The outline is traced
through the camera, distortion and all, so its moments carry that offset.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Mask
from models.camera import Camera
from models.markers import MarkerPattern
from models.pose import RigidTransform

OUTLINE_POINTS = 48
MIN_COSINE = 0.05  # a disc seen from more than 87 deg aside is a line


@dataclass(frozen=True, eq=False)
class DiscOutlines:
    """Projected discs, one row a marker.

    Attributes
    ----------
    centres_px : (n, 2) array, px
        Projections of the discs' centres; NaN where the disc does not face the camera.
    area_centres_px : (n, 2) array, px
        Centres of area of the outlines: where an unbiased blob centroid falls.
    shapes_px2 : (n, 2, 2) array, px^2
        ``S`` of the ellipses ``d^T S^-1 d = 1``.
    facing : (n,) array of bool
        Whether the disc faces the camera, in front of it and within the lens's fold.
    """

    centres_px: Floats
    area_centres_px: Floats
    shapes_px2: Floats
    facing: Mask

    @property
    def radii_px(self) -> Floats:
        """(n,) array, px: radii of the circles of equal area."""
        return np.asarray(np.linalg.det(self.shapes_px2) ** 0.25)

    @property
    def half_extents_px(self) -> Floats:
        """(n, 2) array, px: half width and half height of the bounding boxes."""
        return np.sqrt(np.stack([self.shapes_px2[:, 0, 0], self.shapes_px2[:, 1, 1]], axis=-1))


def _plane_axes(normals: Floats) -> tuple[Floats, Floats]:
    """Return two unit vectors across each normal."""
    helper = np.where(np.abs(normals[:, :1]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    first = np.cross(normals, helper)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return first, np.cross(normals, first)


def _polygon_moments(vertices: Floats) -> tuple[Floats, Floats]:
    """Return the centres of area (n, 2) and second central moments (n, 2, 2) of polygons."""
    mean = vertices.mean(axis=1, keepdims=True)
    here = vertices - mean
    there = np.roll(here, -1, axis=1)
    cross = here[..., 0] * there[..., 1] - there[..., 0] * here[..., 1]
    area = 0.5 * cross.sum(axis=1)
    centre = ((here + there) * cross[..., None]).sum(axis=1) / (6.0 * area[:, None])
    outer = (
        2.0 * np.einsum("nki,nkj->nkij", here, here)
        + 2.0 * np.einsum("nki,nkj->nkij", there, there)
        + np.einsum("nki,nkj->nkij", here, there)
        + np.einsum("nki,nkj->nkij", there, here)
    )
    second = (outer * cross[..., None, None]).sum(axis=1) / (24.0 * area[:, None, None])
    return centre + mean[:, 0], second - np.einsum("ni,nj->nij", centre, centre)


def disc_outlines(
    camera: Camera, cam_from_target: RigidTransform, markers: MarkerPattern
) -> DiscOutlines:
    """Project every marker's disc.

    Parameters
    ----------
    camera : Camera
    cam_from_target : RigidTransform
    markers : MarkerPattern
    """
    count = len(markers)
    centres = cam_from_target @ markers.points_in_target
    normals = cam_from_target.rotate(markers.normals_in_target)
    distance = np.linalg.norm(centres, axis=1)
    cosine = -(normals * centres).sum(axis=1) / distance
    facing = (cosine > MIN_COSINE) & (centres[:, 2] > 2.0 * markers.radius_m)

    angles = 2.0 * np.pi * np.arange(OUTLINE_POINTS) / OUTLINE_POINTS
    # A polygon with the circle's area, not one inscribed in it.
    step = angles[1]
    radius = markers.radius_m * np.sqrt(step / np.sin(step))
    first, second = _plane_axes(normals)
    rim = centres[:, None] + radius * (
        np.cos(angles)[:, None] * first[:, None] + np.sin(angles)[:, None] * second[:, None]
    )
    nowhere = np.full((count, 2), np.nan)
    if not facing.any():
        return DiscOutlines(nowhere, nowhere, np.full((count, 2, 2), np.nan), facing)
    rim[~facing] = np.nan
    rim_px = camera.project(rim)
    facing = np.asarray(np.isfinite(rim_px).all(axis=(1, 2)))
    centres = np.where(facing[:, None], centres, np.nan)
    area_centres, moments = _polygon_moments(rim_px)
    return DiscOutlines(camera.project(centres), area_centres, 4.0 * moments, facing)
