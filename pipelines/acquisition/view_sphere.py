"""A target seen from all around, once, before the first image: a library of its silhouettes.

Each view is reduced to two small pictures about the silhouette's centroid, scaled by its radius of
gyration: what is covered, and where edges of each direction are. The same reduction of an image,
turned by every roll, can then be compared with all views by two matrix products.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats, Mask, Radiance
from models.camera import Camera
from models.pose import RigidTransform
from models.wireframe.wireframe import Wireframe
from pipelines.tracking.model_edges import EdgeSamples, ModelEdges

CELLS = 36  # of a side of the small pictures,
REACH = 2.6  # which end this many radii of gyration from the centroid
EDGE_DIRECTIONS = 4
VIEW_PX = 128
MODEL_SAMPLES = 400
SAMPLES = 90  # kept of a view's edges


@dataclass(frozen=True, eq=False)
class View:
    """The target from one side.

    Attributes
    ----------
    cam_from_target : RigidTransform
        With the target's origin on the boresight.
    centroid : (2,) array
        Of the silhouette, normalised image coordinates.
    gyration : float
        Its radius of gyration, likewise.
    samples : EdgeSamples
        What is seen of the edges.
    """

    cam_from_target: RigidTransform
    centroid: Floats
    gyration: float
    samples: EdgeSamples


@dataclass(frozen=True, eq=False)
class ViewSphere:
    """All views from one range.

    Attributes
    ----------
    range_m : float, m
    views : tuple of View
    covered : (v, cells * cells) float32 array
        Small silhouettes, each of mean 0 and length 1.
    edges : (v, directions * cells * cells) float32 array
        Small pictures of edges, each of length 1.
    """

    range_m: float
    views: tuple[View, ...]
    covered: Radiance
    edges: Radiance


def directions_all_around(count: int) -> Floats:
    """Return unit vectors spread evenly over a sphere, (count, 3), by Fibonacci's spiral."""
    k = np.arange(count) + 0.5
    z = 1.0 - 2.0 * k / count
    angle = np.pi * (1.0 + np.sqrt(5.0)) * k
    radius = np.sqrt(1.0 - z**2)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)


def look_from(direction: Floats, range_m: float) -> RigidTransform:
    """Return ``cam_from_target`` of a camera that stands out along ``direction``, looking back.

    Parameters
    ----------
    direction : (3,) array
        Unit, target frame.
    range_m : float, m
        From the target's origin.
    """
    forward = -direction
    helper = np.eye(3)[int(np.argmin(np.abs(forward)))]
    right = np.cross(helper, forward)
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(forward, right), forward])
    return RigidTransform(rotation, np.array([0.0, 0.0, range_m]))


def shape_of(mask: Mask) -> tuple[Floats, float]:
    """Return the centroid (x, y) of a mask and its radius of gyration, px."""
    row, column = np.nonzero(mask)
    centroid = np.array([column.mean(), row.mean()])
    return centroid, float(np.sqrt(column.var() + row.var()))


def cell_of(points: Floats, centroid: Floats, gyration: float) -> Floats:
    """Return where points fall in a small picture, in cells, (n, 2).

    Parameters
    ----------
    points : (n, 2) array, px
    centroid : (2,) array, px
        Of the silhouette, as ``shape_of`` finds it.
    gyration : float, px
        Its radius of gyration.
    """
    return (points - centroid) / gyration * (0.5 * CELLS / REACH) + 0.5 * (CELLS - 1)


def edge_pictures(cells: Floats, angles: Floats) -> Radiance:
    """Draw edge points by their direction, once for each of r rolls.

    Parameters
    ----------
    cells : (r, n, 2) array, cells
        Where the points are.
    angles : (r, n) array, rad
        Of their normals.

    Returns
    -------
    (r, directions * cells * cells) float32 array, each row of length 1.
    """
    count, area = len(cells), CELLS * CELLS
    share, lower = np.modf(angles % np.pi * (EDGE_DIRECTIONS / np.pi))
    first = lower.astype(np.int64) % EDGE_DIRECTIONS
    column, row = np.moveaxis(np.rint(cells).astype(np.int64), -1, 0)
    inside = (column >= 0) & (column < CELLS) & (row >= 0) & (row < CELLS)
    place = np.arange(count)[:, None] * (EDGE_DIRECTIONS * area) + row * CELLS + column
    total = np.zeros(count * EDGE_DIRECTIONS * area)
    for direction, weight in ((first, 1.0 - share), ((first + 1) % EDGE_DIRECTIONS, share)):
        at = (place + direction * area)[inside]
        total += np.bincount(at, weight[inside], minlength=len(total))
    pictures = np.sqrt(total).astype(np.float32).reshape(-1, CELLS, CELLS)
    for picture in pictures:
        cv2.GaussianBlur(picture, (5, 5), 0.8, dst=picture)
    flat = pictures.reshape(count, -1)
    return np.asarray(flat / np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-9))


def centred(picture: Radiance) -> Radiance:
    """Return pictures (n, pixels) with mean 0 and length 1."""
    flat = picture - picture.mean(axis=1, keepdims=True)
    return np.asarray(flat / np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-9))


def view_sphere(wireframe: Wireframe, range_m: float, count: int) -> ViewSphere:
    """Look at a target from all around; kept in memory for every wireframe that is the same.

    Parameters
    ----------
    wireframe : Wireframe
    range_m : float, m
        How far off; it matters for the perspective alone.
    count : int
        From how many directions; 800 are about 8 deg apart.
    """
    return _looked_at(_Same(wireframe), range_m, count)


@dataclass(frozen=True, eq=False)
class _Same:
    """A wireframe that equals another if its edges and faces do: one is read for each run."""

    wireframe: Wireframe

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and self._shape == other._shape

    def __hash__(self) -> int:
        return hash(self._shape)

    @property
    def _shape(self) -> tuple[bytes, ...]:
        own = self.wireframe
        arrays = (own.points_in_target, own.edges, own.triangles_in_target)
        return tuple(np.ascontiguousarray(each).tobytes() for each in arrays)


@lru_cache(maxsize=8)
def _looked_at(target: _Same, range_m: float, count: int) -> ViewSphere:
    wireframe = target.wireframe
    edges = ModelEdges(wireframe, MODEL_SAMPLES)
    half = 1.02 * wireframe.radius_m / np.sqrt(range_m**2 - wireframe.radius_m**2)
    focal = 0.5 * VIEW_PX / half
    camera = Camera(VIEW_PX, VIEW_PX, focal, focal, 0.5 * (VIEW_PX - 1), 0.5 * (VIEW_PX - 1))
    centre = np.array([camera.cx, camera.cy])
    views, covered, drawn = [], [], []
    side = np.arange(CELLS) - 0.5 * (CELLS - 1)
    for direction in directions_all_around(count):
        pose = look_from(direction, range_m)
        mask = edges.silhouette(camera, pose)
        centroid, gyration = shape_of(mask)
        samples = edges.shown(camera, pose)
        cells = cell_of(samples.points_px, centroid, gyration)
        angle = np.arctan2(samples.normals_px[:, 1], samples.normals_px[:, 0])
        drawn.append(edge_pictures(cells[None], angle[None])[0])
        step = gyration * REACH / (0.5 * CELLS)
        x, y = np.meshgrid(centroid[0] + step * side, centroid[1] + step * side)
        soft = cv2.GaussianBlur(mask.astype(np.float32), (0, 0), 0.5 * step)
        covered.append(
            cv2.remap(soft, x.astype(np.float32), y.astype(np.float32), cv2.INTER_LINEAR).ravel()
        )
        kept = np.unique(np.linspace(0, len(samples) - 1, SAMPLES).astype(int))
        views.append(
            View(pose, (centroid - centre) / focal, gyration / focal, samples.subset(kept))
        )
    return ViewSphere(
        range_m, tuple(views), centred(np.array(covered)), np.array(drawn, dtype=np.float32)
    )


def pose_from_view(
    view: View,
    roll_rad: float,
    centroid: Floats,
    gyration: float,
) -> RigidTransform:
    """Return the pose at which a view, rolled, has a given centroid and size in the image.

    Parameters
    ----------
    view : View
    roll_rad : float, rad
        Turn of the view about the boresight: x towards y.
    centroid : (2,) array
        In normalised image coordinates.
    gyration : float
        Radius of gyration, likewise.
    """
    roll = Rotation.from_rotvec([0.0, 0.0, roll_rad]).as_matrix()
    scale = gyration / view.gyration
    origin = centroid - scale * (roll[:2, :2] @ view.centroid)
    ray = np.array([origin[0], origin[1], 1.0])
    ray /= np.linalg.norm(ray)
    aside = np.cross([0.0, 0.0, 1.0], ray)
    sine = float(np.linalg.norm(aside))
    turn = np.zeros(3) if sine < 1e-12 else aside / sine * np.arcsin(min(sine, 1.0))
    towards = Rotation.from_rotvec(turn).as_matrix()
    range_m = view.cam_from_target.translation[2] / scale
    return RigidTransform(towards @ roll @ view.cam_from_target.rotation, range_m * ray)
