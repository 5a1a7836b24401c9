"""Which edges of the target an image at a given pose shows, and where.

Two kinds of edge: the wireframe's own, and the outlines of its hiding faces, where one of the two
faces that meet looks at the camera and the other away (the side of a tube has no other edges).
Both are cut into samples once; at a pose the samples are projected and those behind a face are
left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from models.arrays import Floats, Indices, Mask
from models.camera import Camera
from models.pose import RigidTransform
from models.wireframe.visibility import visible_points
from models.wireframe.wireframe import Wireframe

MOST_SAMPLES = 900
WELD_M = 1e-4  # corners of faces nearer than this are one
ON_EDGE_M = 0.02  # an outline this near to an edge of the wireframe is that edge,
ON_EDGE_SHARE = 0.01  # or, of a small target, this near in its radii


@dataclass(frozen=True, eq=False)
class EdgeSamples:
    """Points of edges that an image shows.

    Attributes
    ----------
    points_in_target : (n, 3) array, m
    points_px : (n, 2) array, px
    normals_px : (n, 2) array
        Unit normals to the edges in the image; of an outline, away from the target.
    edge : (n,) array of int
        Which edge a sample is of.
    outline : (n,) array of bool
        Whether there is nothing of the target beyond.
    """

    points_in_target: Floats
    points_px: Floats
    normals_px: Floats
    edge: Indices
    outline: Mask

    def __len__(self) -> int:
        return len(self.edge)

    def subset(self, keep: Mask | Indices) -> EdgeSamples:
        """Return some of the samples.

        Parameters
        ----------
        keep : (n,) array of bool, or (k,) array of int
        """
        return EdgeSamples(
            self.points_in_target[keep],
            self.points_px[keep],
            self.normals_px[keep],
            self.edge[keep],
            self.outline[keep],
        )


class ModelEdges:
    """A wireframe's edges and outlines, cut into samples.

    Parameters
    ----------
    wireframe : Wireframe
    samples : int
        How many there are about, spread evenly over all edges.
    """

    def __init__(self, wireframe: Wireframe, samples: int = MOST_SAMPLES) -> None:
        self.wireframe = wireframe
        self.radius_m = wireframe.radius_m
        ends = wireframe.points_in_target[wireframe.edges]
        mesh_ends, self._sides = _mesh_edges(wireframe.triangles_in_target)
        near_m = min(ON_EDGE_M, ON_EDGE_SHARE * wireframe.radius_m)
        new = ~_on_segments(mesh_ends, ends, near_m)
        mesh_ends, self._sides = mesh_ends[new], self._sides[new]
        self._ends = np.concatenate([ends, mesh_ends])
        self._wires = len(ends)
        lengths = np.linalg.norm(self._ends[:, 1] - self._ends[:, 0], axis=1)
        spacing = lengths.sum() / samples
        counts = np.maximum(np.rint(lengths / spacing).astype(int), 1)
        self.edge: Indices = np.repeat(np.arange(len(counts)), counts)
        first = np.concatenate([[0], np.cumsum(counts)[:-1]])
        along = (np.arange(counts.sum()) - np.repeat(first, counts) + 0.5) / np.repeat(
            counts, counts
        )
        start, stop = self._ends[self.edge, 0], self._ends[self.edge, 1]
        self.points = start + along[:, None] * (stop - start)
        self.directions = (stop - start) / np.maximum(lengths[self.edge], 1e-9)[:, None]

    @cached_property
    def _face_planes(self) -> tuple[Floats, Floats]:
        """Normals of the faces and their distance from the origin; (f, 3) and (f,)."""
        a, b, c = np.moveaxis(self.wireframe.triangles_in_target, 1, 0)
        normals = np.cross(b - a, c - a)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        return normals, np.einsum("fi,fi->f", normals, a)

    def shown(self, camera: Camera, cam_from_target: RigidTransform) -> EdgeSamples:
        """Return the samples that an image at a pose shows.

        Parameters
        ----------
        camera : Camera
        cam_from_target : RigidTransform
        """
        eye = cam_from_target.inverse().translation
        candidates = self._facing(eye)
        points = self.points[candidates]
        in_cam = cam_from_target @ points
        front = in_cam[:, 2] > 0.1 * self.radius_m
        candidates, points, in_cam = candidates[front], points[front], in_cam[front]
        pixels = camera.project(in_cam)
        inside = camera.contains(pixels, 2.0)
        seen = inside & visible_points(self.wireframe, points, cam_from_target)
        candidates, points, pixels = candidates[seen], points[seen], pixels[seen]
        step = 1e-3 * self.radius_m
        ahead = camera.project(cam_from_target @ (points + step * self.directions[candidates]))
        tangent = ahead - pixels
        length = np.linalg.norm(tangent, axis=1)
        # An edge seen nearly end on has no direction in the image.
        along = length > 0.15 * step * camera.fx / np.maximum(in_cam[seen][:, 2], 1e-6)
        normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
        normal /= np.maximum(length, 1e-12)[:, None]
        samples = EdgeSamples(
            points, pixels, normal, self.edge[candidates], np.zeros(len(points), dtype=bool)
        ).subset(along)
        return _with_outline(samples, self.silhouette(camera, cam_from_target))

    def silhouette(self, camera: Camera, cam_from_target: RigidTransform) -> Mask:
        """Return where the target covers the image, (height, width)."""
        shape = (camera.height, camera.width)
        mask = np.zeros(shape, dtype=np.uint8)
        corners = cam_from_target @ self.wireframe.triangles_in_target.reshape(-1, 3)
        pixels = camera.project(corners)
        ahead = (corners[:, 2] > 0.1 * self.radius_m) & np.isfinite(pixels).all(axis=1)
        pixels = pixels.reshape(-1, 3, 2)[ahead.reshape(-1, 3).all(axis=1)]
        pixels = np.clip(pixels, -4.0 * camera.width, 5.0 * camera.width)
        for triangle in np.rint(16.0 * pixels).astype(np.int32):
            cv2.fillConvexPoly(mask, triangle, 1, shift=4)
        return mask.astype(bool)

    def _facing(self, eye: Floats) -> Indices:
        """Return the samples of the wireframe's edges, and of outlines as seen from ``eye``."""
        normals, offsets = self._face_planes
        faces_eye = normals @ eye > offsets
        is_outline = np.ones(len(self._ends), dtype=bool)
        first, second = self._sides[:, 0], self._sides[:, 1]
        is_outline[self._wires :] = (second < 0) | (faces_eye[first] != faces_eye[second])
        return np.flatnonzero(is_outline[self.edge])


def _mesh_edges(triangles: Floats) -> tuple[Floats, Indices]:
    """Return the edges of faces, (e, 2, 3), and the one or two faces on each, -1 for none."""
    if len(triangles) == 0:
        return np.zeros((0, 2, 3)), np.zeros((0, 2), dtype=np.int64)
    corners = np.rint(triangles.reshape(-1, 3) / WELD_M).astype(np.int64)
    _, number = np.unique(corners, axis=0, return_inverse=True)
    faces = number.reshape(-1, 3)
    where = {int(n): triangles.reshape(-1, 3)[k] for k, n in enumerate(faces.ravel())}
    owners: dict[tuple[int, int], list[int]] = {}
    for face, (a, b, c) in enumerate(faces.tolist()):
        for pair in ((a, b), (b, c), (c, a)):
            if pair[0] != pair[1]:
                owners.setdefault((min(pair), max(pair)), []).append(face)
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    ends, sides = [], []
    for (a, b), of in owners.items():
        if len(of) == 2 and abs(normals[of[0]] @ normals[of[1]]) > 1.0 - 1e-6:
            continue  # the diagonal of a flat face
        ends.append([where[a], where[b]])
        sides.append([of[0], of[1] if len(of) == 2 else -1])
    return np.array(ends).reshape(-1, 2, 3), np.array(sides, dtype=np.int64).reshape(-1, 2)


def _on_segments(segments: Floats, others: Floats, near_m: float) -> Mask:
    """Tell which segments (n, 2, 3) lie within ``near_m`` of one of the others, (m, 2, 3)."""
    if len(segments) == 0 or len(others) == 0:
        return np.zeros(len(segments), dtype=bool)
    start, along = others[:, 0], others[:, 1] - others[:, 0]
    length2 = np.maximum(np.einsum("mi,mi->m", along, along), 1e-12)
    near = np.ones((len(segments), len(others)), dtype=bool)
    for end in (segments[:, 0], segments[:, 1]):
        share = np.einsum("nmi,mi->nm", end[:, None] - start, along) / length2
        foot = start + np.clip(share, 0.0, 1.0)[..., None] * along
        near &= np.linalg.norm(end[:, None] - foot, axis=2) < near_m
    return np.asarray(near.any(axis=1))


def _with_outline(samples: EdgeSamples, silhouette: Mask) -> EdgeSamples:
    """Mark samples with empty space on one side, and turn their normals towards it."""
    height, width = silhouette.shape

    def covered(points: Floats) -> Mask:
        column = np.clip(np.rint(points[:, 0]).astype(int), 0, width - 1)
        row = np.clip(np.rint(points[:, 1]).astype(int), 0, height - 1)
        return silhouette[row, column]

    step = 2.5 * samples.normals_px
    ahead, behind = covered(samples.points_px + step), covered(samples.points_px - step)
    normals = np.where((ahead & ~behind)[:, None], -samples.normals_px, samples.normals_px)
    return EdgeSamples(
        samples.points_in_target, samples.points_px, normals, samples.edge, ~(ahead & behind)
    )
