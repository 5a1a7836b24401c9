"""What lights a target in an image, as a flight computer knows it, and what shines then at a pose.

The Sun's light and the Earth's fall on the faces that a wireframe hides with; finishes say what
leaves them towards the camera: a matt part and a lobe about the mirrored direction (GGX; Walter et
al. 2007, equations 33 and 34, with Schlick's approximation of Fresnel's law). What faces throw at
each other is not told, but how much of it there is at most.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from models.arrays import Floats, Indices, Mask, Radiance
from models.camera import Camera
from models.lights.earth import EARTH_RADIUS_KM, GEO_RADIUS_KM, facing_share
from models.pose import RigidTransform
from pipelines.acquisition.cell_grid import points_in_cells
from pipelines.acquisition.surface_cloud import (
    SurfaceCloud,
    nearest_in_cells,
    sunlight,
    sunlight_kept,
)

PARTS = 2  # of a cell's side, in which the target is seen: what covers part of a cell is dimmer
MOST_CELLS = 800  # of a side of any grid
GRAZING = 0.02  # cosine at which a face is seen, at least
EARTH_WIDENS = 0.25  # a lobe's square of roughness, times the square of the sine of its radius


@dataclass(frozen=True, eq=False)
class Daylight:
    """What lights a target.

    Attributes
    ----------
    sun_in_cam : (3,) array
        Unit vector towards the Sun.
    earth_in_cam : (3,) array, optional
        Unit vector towards the Earth's centre, where it shines on the target.
    white_dn : float, optional, DN
        What a white matt surface that faces the Sun gives in this exposure; without it brightness
        tells little.
    orbit_radius_km : float, km
        From the Earth's centre to the target.
    sunlit_share : float
        Of the Sun's disc, that the Earth leaves free.
    """

    sun_in_cam: Floats
    earth_in_cam: Floats | None = None
    white_dn: float | None = None
    orbit_radius_km: float = GEO_RADIUS_KM
    sunlit_share: float = 1.0


@dataclass(frozen=True, eq=False)
class PredictedLight:
    """What shines at a pose, cell by cell, 1 for a white matt face that the Sun meets squarely.

    Attributes
    ----------
    direct : (rows, columns) float32 array
        By the light of Sun and Earth.
    stray : (rows, columns) float32 array
        By what faces throw at each other, were it as bright as the mean of what is lit.
    covered : (rows, columns) array of bool
        Where the target is.
    corner : (2,) array of int
        Column and row of its first cell among the image's.
    """

    direct: Radiance
    stray: Radiance
    covered: Mask
    corner: Indices


def predicted_light(
    cloud: SurfaceCloud,
    finishes: Floats,
    camera: Camera,
    pose: RigidTransform,
    light: Daylight,
    cell_px: float,
    corner_px: Floats,
) -> PredictedLight:
    """Return what shines at a pose.

    Parameters
    ----------
    cloud : SurfaceCloud
    finishes : (f, 2, 4) array
        Of its faces; see ``models.wireframe.finish.Finish.table``.
    camera : Camera
    pose : RigidTransform
        ``cam_from_target``.
    light : Daylight
    cell_px : float, px
        Size of a cell of the image's grid,
    corner_px : (2,) array, px
        and its first cell's outer corner.
    """
    in_cam, depth, cell = points_in_cells(cloud.points, camera, pose, cell_px / PARTS, corner_px)
    corner = np.clip(cell.min(axis=0) // PARTS - 2, -MOST_CELLS, MOST_CELLS)
    last = cell.max(axis=0) // PARTS
    width, height = (PARTS * np.clip(last + 3 - corner, 1, MOST_CELLS)).tolist()
    first = PARTS * corner
    seen = nearest_in_cells(cell[:, 0] - first[0], cell[:, 1] - first[1], depth, width, height)
    there = seen >= 0
    point = seen[there]
    ways = -in_cam[point]
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    normals = cloud.normals[point] @ pose.rotation.T
    side = np.where(np.einsum("ni,ni->n", ways, normals) > 0.0, 1.0, -1.0)
    normals *= side[:, None]
    finish = finishes[cloud.face[point], (side < 0.0).astype(np.int64)]
    sun = light.sun_in_cam
    cosine = _cosine(cloud, pose, sun, point) * side
    direct = light.sunlit_share * _leaves(finish, normals, ways, sun, cosine, 0.0)
    if light.earth_in_cam is not None:
        earth = light.earth_in_cam
        by_earth = _cosine(cloud, pose, earth, point) * side
        share = facing_share(float(np.clip(-earth @ sun, -1.0, 1.0)), light.orbit_radius_km)
        widened = EARTH_WIDENS * (EARTH_RADIUS_KM / light.orbit_radius_km) ** 2
        direct += share * _leaves(finish, normals, ways, earth, by_earth, widened)
    lit = light.sunlit_share * float(np.maximum(cosine, 0.0).mean()) if len(point) else 0.0
    grids = np.zeros((3, height * width), dtype=np.float32)
    grids[0, there], grids[1, there] = direct, lit * (finish[:, 0] + finish[:, 1])
    grids[2, there] = 1.0
    return _closed(grids.reshape(3, height, width), corner)


def _cosine(
    cloud: SurfaceCloud, pose: RigidTransform, towards_in_cam: Floats, point: Indices
) -> Floats:
    towards = pose.rotation.T @ towards_in_cam
    kept = sunlight_kept(cloud, towards, point) if cloud.is_thin else None
    return sunlight(cloud, towards)[point] if kept is None else kept


def _leaves(
    finish: Floats, normals: Floats, ways: Floats, light: Floats, cosine: Floats, widened: float
) -> Floats:
    """Return what leaves towards the camera, over that of a white matt face lit squarely."""
    shines = cosine > 0.0
    cosine = np.maximum(cosine, 0.0)
    seen = np.maximum(np.einsum("ni,ni->n", ways, normals), GRAZING)
    half = ways + light
    half /= np.maximum(np.linalg.norm(half, axis=1), 1e-9)[:, None]
    upright = np.clip(np.einsum("ni,ni->n", half, normals), 0.0, 1.0)
    alpha2 = finish[:, 2] ** 2 + widened
    density = alpha2 / (np.pi * (upright**2 * (alpha2 - 1.0) + 1.0) ** 2)
    masked = _unmasked(seen, alpha2) * _unmasked(np.maximum(cosine, 0.01), alpha2)
    steep = (1.0 - np.clip(np.einsum("ni,ni->n", half, ways), 0.0, 1.0)) ** 5
    mirror = finish[:, 1] + finish[:, 3] * (1.0 - finish[:, 1]) * steep
    lobe = np.pi * mirror * density * masked / (4.0 * np.maximum(seen, 0.05))
    return np.where(shines, cosine * finish[:, 0] + lobe, 0.0)


def _unmasked(cosine: Floats, alpha2: Floats) -> Floats:
    return 2.0 * cosine / (cosine + np.sqrt(alpha2 + (1.0 - alpha2) * cosine**2))


def _closed(grids: Radiance, corner: Indices) -> PredictedLight:
    """Close the holes of a cell's width that a cloud of points leaves."""
    covered = grids[2] > 0.0
    square = np.ones((3, 3), dtype=np.uint8)
    closed = cv2.morphologyEx(covered.astype(np.uint8), cv2.MORPH_CLOSE, square) > 0
    holes = closed & ~covered
    direct, stray = grids[0], grids[1]
    if holes.any():
        around = np.maximum(cv2.blur(grids[2], (3, 3)), 1e-6)
        direct = np.where(holes, cv2.blur(direct, (3, 3)) / around, direct)
        stray = np.where(holes, cv2.blur(stray, (3, 3)) / around, stray)
    size = (closed.shape[1] // PARTS, closed.shape[0] // PARTS)
    direct, stray, share = (
        cv2.resize(np.asarray(each, dtype=np.float32), size, interpolation=cv2.INTER_AREA)
        for each in (direct, stray, closed)
    )
    return PredictedLight(direct, stray, share > 0.0, corner)
