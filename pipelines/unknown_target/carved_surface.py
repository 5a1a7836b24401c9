"""The surface that silhouettes carve: what no outline leaves out, as triangles.

Each image tells of each place how far it lies inside of the outline, metres across the line of
sight; a place is as deep inside the hull as the image that has it least so (Laurentini 1994). Some
images may be wrong, by a shadow or by a pose, so a few of the least are let pass. Where that depth
is nought lies the surface (marching cubes, Lewiner et al. 2003, Journal of Graphics Tools 8).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from scipy import ndimage
from skimage.measure import marching_cubes

from models.arrays import Floats, Indices, Mask, Radiance
from models.camera import Camera
from pipelines.unknown_target.silhouettes import CARVED, FEWEST, WIDEST_GAP

COARSE = 56  # cells along the longest side, at first
FINE = 3  # of these in one of those, where the surface passes
MARGIN = 1.15  # of the points' reach, within which is carved
HALF_PIXEL = 0.5  # from a pixel's middle to its edge: distances are told from middle to middle
NEAREST_M = 0.1  # of a place to a camera
HALF_DIAGONAL = 0.9  # of a cell, and a little more
SPECK = 0.002  # of the largest part's volume


@dataclass(frozen=True, eq=False)
class View:
    """One silhouette and whence it was seen.

    Attributes
    ----------
    R_cam_from_target : (3, 3) array
    t_cam_from_target : (3,) array, m
    covered : (height, width) bool array
    """

    R_cam_from_target: Floats
    t_cam_from_target: Floats
    covered: Mask


@dataclass(frozen=True, eq=False)
class CarvedSurface:
    """The hull's surface.

    Attributes
    ----------
    vertices : (n, 3) array, m
        Target axes, from the centre of mass.
    faces : (f, 3) int array
        Outside seen counter-clockwise.
    step_m : float, m
        Between the places that were asked.
    views : int
        Silhouettes that carved.
    depth : (i, j, k) array, m
        How deep places lie inside, along x, y and z; outside it is negative.
    first : (3,) array, m
        The first of these places.
    """

    vertices: Floats
    faces: Indices
    step_m: float
    views: int
    depth: Floats
    first: Floats

    def depth_at(self, points: Floats) -> Floats:
        """Return how deep points lie inside of the hull, (n,) m; outside it is negative.

        Parameters
        ----------
        points : (n, 3) array, m
        """
        at = (points - self.first) / self.step_m
        return np.asarray(ndimage.map_coordinates(self.depth, at.T, order=1, mode="nearest"))


class NoSurface(ValueError):
    """Silhouettes carve no surface; the message says what is missing."""


def carve(
    camera: Camera,
    views: Sequence[View],
    points: Floats,
    went_on: Callable[[], None] = lambda: None,
) -> CarvedSurface:
    """Carve the hull about a cloud.

    Parameters
    ----------
    camera : Camera
    views : sequence of View
    points : (n, 3) array, m
        The target's, target axes: they tell how far is to be looked.
    went_on : callable
        Told after each silhouette that was asked; twice for each.

    Raises
    ------
    NoSurface
        If views are too few or do not go round the target, there are no points, or nothing is left.
    """
    if len(views) < FEWEST:
        raise NoSurface(
            f"expected {FEWEST} silhouettes or more, got {len(views)}; give "
            f"{FEWEST - len(views)} more images that show the target"
        )
    along = np.array([view.R_cam_from_target[2] for view in views])
    widest = float(np.rad2deg(np.arccos(np.clip((along @ along.T).min(), -1.0, 1.0))))
    if np.cos(np.deg2rad(widest)) >= -WIDEST_GAP:
        raise NoSurface(
            f"expected views 102 deg apart or more, got {widest:.0f} deg by {len(views)} images; "
            f"give {_images_missing(len(views), widest)} more, or let the target turn on"
        )
    if not len(points):
        raise NoSurface("expected points of the target, got none")
    reach = MARGIN * np.abs(points).max(axis=0) + 0.05 * np.abs(points).max()
    coarse_m = 2.0 * float(reach.max()) / COARSE
    passed = int(CARVED * len(views))
    grids = [np.arange(-half, half + coarse_m, coarse_m) for half in reach]
    places = np.stack(np.meshgrid(*grids, indexing="ij"), axis=-1)
    shape = places.shape[:3]
    depth = _depths(camera, views, places.reshape(-1, 3), passed, went_on)
    rough = depth.reshape(shape)
    near = _cells_near(rough, coarse_m)
    finer, step_m = _finer(rough), coarse_m / FINE
    fine_near = np.argwhere(_finer_mask(near, finer.shape))
    origin = np.array([grid[0] for grid in grids])
    told = _depths(
        camera,
        views,
        origin + step_m * fine_near,
        passed,
        went_on,
    )
    finer[tuple(fine_near.T)] = told
    if not ((finer > 0.0).any() and (finer < 0.0).any()):
        raise NoSurface("expected silhouettes that leave some of the target, they leave nothing")
    whole = _large_parts(finer)
    vertices, faces, _, _ = marching_cubes(
        np.pad(whole, 1, constant_values=-step_m),
        0.0,
        spacing=(step_m,) * 3,
        gradient_direction="ascent",
        allow_degenerate=False,
    )
    return CarvedSurface(
        np.asarray(vertices, dtype=np.float64) + (origin - step_m),
        np.asarray(faces, dtype=np.int64),
        step_m,
        len(views),
        whole,
        origin,
    )


def _images_missing(views: int, widest_deg: float) -> int:
    """Return how many more images go round far enough, if they go on turning as they did."""
    enough_deg = float(np.rad2deg(np.arccos(-WIDEST_GAP)))
    return max(1, int(np.ceil(views * (enough_deg / max(widest_deg, 1.0) - 1.0))))


def _depths(
    camera: Camera,
    views: Sequence[View],
    places: Floats,
    passed: int,
    went_on: Callable[[], None],
) -> Floats:
    """Return how deep (n, 3) places lie inside of the hull, (n,) m; outside it is negative."""
    least = np.full((len(places), passed + 1), np.inf, dtype=np.float32)
    for view in views:
        least = _with(least, _depth(camera, view, places).astype(np.float32))
        went_on()
    depth = least.max(axis=1).astype(np.float64)
    return np.where(np.isfinite(depth), depth, -1.0)  # in no image: outside


def _with(least: Radiance, depth: Radiance) -> Radiance:
    """Return the least of each row and one more, as many as before, in no order."""
    largest = least.argmax(axis=1)
    rows = np.arange(len(least))
    least[rows, largest] = np.minimum(least[rows, largest], depth)
    return least


def _depth(camera: Camera, view: View, places: Floats) -> Floats:
    in_cam = places @ view.R_cam_from_target.T + view.t_cam_from_target
    pixels = camera.project(in_cam)
    inside = camera.contains(pixels) & (in_cam[:, 2] > NEAREST_M)
    covered = view.covered.astype(np.uint8)
    within, without = (
        cv2.distanceTransform(side, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        for side in (covered, 1 - covered)
    )
    signed = np.where(covered > 0, within - HALF_PIXEL, HALF_PIXEL - without)
    depth = np.full(len(places), np.inf)
    rows_columns = pixels[inside][:, ::-1].T
    read = ndimage.map_coordinates(signed, rows_columns, order=1, mode="nearest")
    depth[inside] = read * in_cam[inside, 2] / camera.fx
    return depth


def _cells_near(rough: Floats, coarse_m: float) -> Mask:
    """Return which of the coarse places may have the surface nearer to them than to others.

    Depth changes by no more than one goes, and half the diagonal of a cell is the farthest.
    """
    return np.asarray(np.abs(rough) < HALF_DIAGONAL * coarse_m)


def _large_parts(depth: Floats) -> Floats:
    """Return the same without specks that no view happened to leave out."""
    parts, count = ndimage.label(depth > 0.0)
    sizes = np.bincount(parts.ravel(), minlength=count + 1)[1:]
    specks = np.concatenate([[False], sizes < SPECK * sizes.max(initial=1)])
    return np.where(specks[parts], -np.abs(depth), depth)


def _finer(rough: Floats) -> Floats:
    counts = [FINE * (count - 1) + 1 for count in rough.shape]
    at = np.meshgrid(*(np.arange(count) / FINE for count in counts), indexing="ij")
    return np.asarray(ndimage.map_coordinates(rough, at, order=1))


def _finer_mask(near: Mask, shape: tuple[int, ...]) -> Mask:
    at = np.meshgrid(*((np.arange(count) + FINE // 2) // FINE for count in shape), indexing="ij")
    return np.asarray(near[tuple(at)])
