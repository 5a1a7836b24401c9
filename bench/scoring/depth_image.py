"""How far a mesh is along each pixel's ray, by casting that ray: no renderer, no OpenGL.

A ray d through a pixel meets a triangle (a, b, c), all in the camera's axes, where the three
volumes ``d.(b x c)``, ``d.(c x a)`` and ``d.(a x b)`` have one sign (Olano and Greer 1997, section
3): each is linear in the pixel's undistorted place, and no triangle need be clipped. Rays are the
camera's own, distortion and all, so that pixels at an outline fall as they do in a rendered frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models.arrays import AnyArray, Floats
from models.camera import Camera
from models.pose import RigidTransform

NEAR_M = 1e-6  # a corner nearer than this to the camera's plane is not in front
AT_ONCE = 500_000  # candidate pixels that are held at a time: 60 MB
SIDES = ((1, 2), (2, 0), (0, 1))


@dataclass(frozen=True, eq=False)
class PixelGrid:
    """Every so many-th pixel of a camera, from the first on.

    Attributes
    ----------
    camera : Camera
    stride : int
        From one pixel to the next that is looked at, in both directions.
    """

    camera: Camera
    stride: int = 1

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        rows, columns = self.camera.height, self.camera.width
        return -(-rows // self.stride), -(-columns // self.stride)

    @cached_property
    def directions(self) -> Floats:
        """(height, width, 3) array: a point at depth 1 on each pixel's ray."""
        rows, columns = (self.stride * np.arange(count) for count in self.shape)
        pixels = np.stack(np.meshgrid(columns, rows), axis=-1).astype(np.float64)
        places = self.camera.normalise(pixels.reshape(-1, 2)).reshape(*self.shape, 2)
        return np.concatenate([places, np.ones((*self.shape, 1))], axis=-1)

    @cached_property
    def stretch(self) -> Floats:
        """(height, width) array: distance along the ray over depth."""
        return np.asarray(np.linalg.norm(self.directions, axis=-1))


def grid_within(camera: Camera, most_px: int) -> PixelGrid:
    """Return the finest grid of at most so many pixels along the image's longer side."""
    return PixelGrid(camera, -(-max(camera.width, camera.height) // most_px))


def depth_image(
    vertices_in_target: Floats, faces: AnyArray, grid: PixelGrid, cam_from_target: RigidTransform
) -> Floats:
    """Return the depth of the nearest triangle along each pixel's ray.

    Triangles are seen from both sides. One that reaches behind the camera is left out.

    Parameters
    ----------
    vertices_in_target : (n, 3) array, m
    faces : (f, 3) array of int
    grid : PixelGrid
    cam_from_target : RigidTransform

    Returns
    -------
    (height, width) array, m
        Z in the camera's axes; 0 where nothing is met.
    """
    vertices = cam_from_target @ vertices_in_target
    faces, low, size = _candidates(vertices, faces, grid)
    corners = vertices[faces]
    planes = np.stack([_cross(corners[:, i], corners[:, j]) for i, j in SIDES], axis=1)
    volume = np.einsum("ij,ij->i", corners[:, 0], planes[:, 0])
    planes *= np.sign(volume)[:, None, None]
    volume = np.abs(volume)

    nearest = np.full(grid.shape, np.inf).ravel()
    columns, directions = grid.shape[1], grid.directions.reshape(-1, 3)
    ends = np.cumsum(size.prod(axis=1))
    begin = 0
    while begin < len(faces):
        before = ends[begin - 1] if begin else 0
        end = max(begin + 1, int(np.searchsorted(ends, before + AT_ONCE, side="right")))
        counts = np.diff(ends[begin:end], prepend=before)
        triangle = np.repeat(np.arange(begin, end), counts)
        place = np.arange(len(triangle)) - np.repeat(ends[begin:end] - counts - before, counts)
        row, column = np.divmod(place, size[triangle, 0])
        pixel = (low[triangle, 1] + row) * columns + low[triangle, 0] + column
        sides = np.einsum("kij,kj->ki", planes[triangle], directions[pixel])
        met = (sides >= 0.0).all(axis=1) & (volume[triangle] > 0.0)
        depths = volume[triangle[met]] / sides[met].sum(axis=1)
        np.minimum.at(nearest, pixel[met], depths)
        begin = end
    return np.where(np.isfinite(nearest), nearest, 0.0).reshape(grid.shape)


def _candidates(
    vertices: Floats, faces: AnyArray, grid: PixelGrid
) -> tuple[AnyArray, AnyArray, AnyArray]:
    """Return the faces that may cover a pixel, and the first column, row and extent of each.

    An edge is straight, but not its distorted image: the box around a face's corners is widened by
    as much as the middles of its edges stray from the middles of their images' chords.
    """
    faces = faces[(vertices[faces][:, :, 2] > NEAR_M).all(axis=1)]
    pixels = grid.camera.project(vertices)
    at = pixels[faces]
    low, high = at.min(axis=1), at.max(axis=1)
    if grid.camera.distorted:
        rolled = np.roll(np.arange(3), -1)
        middles = 0.5 * (vertices[faces] + vertices[faces][:, rolled])
        strays = np.abs(grid.camera.project(middles) - 0.5 * (at + at[:, rolled])).max(axis=1)
        low, high = low - strays - 1.0, high + strays + 1.0
    last = np.array(grid.shape[::-1]) - 1
    with np.errstate(invalid="ignore"):
        low = np.maximum(np.ceil(low / grid.stride), 0.0)
        size = np.minimum(np.floor(high / grid.stride), last) - low + 1.0
        may = (size >= 1.0).all(axis=1)  # a corner beyond the lens's fold has none: NaN
    return faces[may], low[may].astype(np.int64), size[may].astype(np.int64)


def _cross(first: Floats, second: Floats) -> Floats:
    """Return cross products of (n, 3) arrays; written out it takes a third of NumPy's time."""
    a, b, c = first.T
    x, y, z = second.T
    return np.stack([b * z - c * y, c * x - a * z, a * y - b * x], axis=-1)
