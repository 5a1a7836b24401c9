"""A cloud of points held against the mesh that was rendered, and against what of it was seen."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import trimesh
from scipy.spatial import KDTree

from bench.scoring.target_shape import spread_points, target_shape
from models.arrays import Floats
from models.camera import Camera
from models.dataset.dataset import Dataset
from models.onboard import needed
from renders.store.sealed_exr import read_exr
from renders.truth.image_truth import ImageTruth

SPREAD = 60_000  # points by which the triangles near a point are found
NEAR = 24  # of them, whose triangles are tried
LOOKED_AT = 60  # images of which what they show is put together
VOXEL_M = 0.05
NEAREST_M = 0.05  # of a point to a seen place that counts as found
COARSE_M = 0.5


@dataclass(frozen=True)
class CloudScore:
    """A cloud against the surface.

    Attributes
    ----------
    points : int
    rms_m, median_m, p90_m : float or None
        Distance of its points to the true surface.
    inlier_rms_m : float or None
        Of the nine tenths of them that are nearest.
    within_5cm : float or None
        Share of the points.
    completeness_5cm, completeness_50cm : float or None
        Share of the seen surface that has a point so near: a sparse cloud covers little.
    sigma_m : float or None
        Median of the sigmas stated.
    """

    points: int
    rms_m: float | None
    median_m: float | None
    p90_m: float | None
    inlier_rms_m: float | None
    within_5cm: float | None
    completeness_5cm: float | None
    completeness_50cm: float | None
    sigma_m: float | None


class Surface:
    """The true surface of a dataset's target.

    Parameters
    ----------
    triangles : (f, 3, 3) array, m
    """

    def __init__(self, triangles: Floats) -> None:
        self._triangles = triangles

    @classmethod
    def of(cls, dataset: Dataset) -> Surface | None:
        """Return that of a dataset; None where only the target's name is known."""
        shape = target_shape(dataset)
        return None if shape is None else cls(shape.vertices[shape.faces])

    def distances(self, points: Floats) -> Floats:
        """Return how far (n, 3) points are from it, (n,) m."""
        if not len(points):
            return np.zeros(0)
        _, near = self._tree.query(points, k=NEAR)
        faces = self._face_of[near]
        asked = np.repeat(points, NEAR, axis=0)
        closest = trimesh.triangles.closest_point(self._triangles[faces.ravel()], asked)
        away = np.linalg.norm(closest - asked, axis=1).reshape(len(points), NEAR)
        return np.asarray(away.min(axis=1))

    @cached_property
    def _tree(self) -> KDTree:
        return KDTree(spread_points(self._triangles, SPREAD))

    @cached_property
    def _face_of(self) -> Floats:
        sides = self._triangles[:, 1:] - self._triangles[:, :1]
        ends = np.cumsum(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1))
        middle = (np.arange(SPREAD) + 0.5) / SPREAD * ends[-1]
        return np.searchsorted(ends, middle)


def cloud_score(
    points: Floats, sigma_m: Floats | None, surface: Surface | None, seen: Floats
) -> CloudScore:
    """Hold a cloud against the surface.

    Parameters
    ----------
    points : (n, 3) array, m
        True axes.
    sigma_m : (n,) array or None, m
    surface : Surface or None
    seen : (k, 3) array, m
        Places of it that images showed.
    """
    told = None if sigma_m is None or not len(sigma_m) else float(np.median(sigma_m))
    if not len(points) or surface is None:
        return CloudScore(len(points), None, None, None, None, None, None, None, told)
    away = np.sort(surface.distances(points))
    best = away[: max(1, int(0.9 * len(away)))]
    near = coarse = None
    if len(seen):
        gap, _ = KDTree(points).query(seen)
        near, coarse = float(np.mean(gap < NEAREST_M)), float(np.mean(gap < COARSE_M))
    return CloudScore(
        len(points),
        float(np.sqrt(np.mean(away**2))),
        float(np.median(away)),
        float(np.quantile(away, 0.9)),
        float(np.sqrt(np.mean(best**2))),
        float(np.mean(away < NEAREST_M)),
        near,
        coarse,
        told,
    )


def seen_surface(dataset: Dataset, truths: dict[int, ImageTruth]) -> Floats:
    """Return places of the target that images showed, one in each 5 cm, (k, 3) m, true axes.

    What the images' truth has of depth counts, lit or not, of at most sixty images.

    Parameters
    ----------
    dataset : Dataset
    truths : dict of int to ImageTruth
    """
    camera = needed(dataset.onboard.camera, "camera.toml", "the score of a shape")
    indices = list(dataset.indices)
    chosen = indices[:: max(1, len(indices) // LOOKED_AT)]
    places = [
        _shown(dataset.folder, index, camera, truths[index]) for index in chosen if index in truths
    ]
    whole = np.concatenate([np.zeros((0, 3)), *places])
    if not len(whole):
        return whole
    _, first = np.unique(np.floor(whole / VOXEL_M).astype(np.int64), axis=0, return_index=True)
    return whole[first]


def _shown(folder: Path, index: int, camera: Camera, truth: ImageTruth) -> Floats:
    channels = read_exr(folder / "truth" / "geometry" / f"{index:06d}.exr")
    if channels is None:
        return np.zeros((0, 3))
    depth = np.asarray(channels["Z"], dtype=np.float64)
    rows, columns = np.nonzero(np.isfinite(depth) & (depth > 0.0))
    rays = camera.normalise(np.column_stack([columns, rows]).astype(np.float64))
    in_cam = np.column_stack([rays, np.ones(len(rays))]) * depth[rows, columns][:, None]
    return truth.cam_from_target.inverse() @ in_cam
