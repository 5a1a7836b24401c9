"""The shape of a target, as measures of whole poses need it: points, mesh, symmetries."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull, KDTree, QhullError
from scipy.spatial.distance import pdist

from models.arrays import AnyArray, Floats
from models.dataset.dataset import Dataset
from models.spacecraft.catalogue import SPACECRAFT, spacecraft_by_name
from models.wireframe.wireframe import Wireframe

SPREAD_POINTS = (
    4096  # spread over the surface; ADD of a turn is then within 1 % of the surface's own
)
PLASTIC = 1.32471795724474602596  # Roberts 2018: the plane's least discrepant steps


@dataclass(frozen=True, eq=False)
class TargetShape:
    """A target in its own frame.

    Attributes
    ----------
    source : str
        Where the shape is from.
    vertices : (n, 3) array, m
    faces : (f, 3) array of int
    symmetries : tuple of (3, 3) arrays
        Turns about the frame's origin that look alike, no turn left out; none unless declared.
    """

    source: str
    vertices: Floats
    faces: AnyArray
    symmetries: tuple[Floats, ...] = ()

    @cached_property
    def corners(self) -> Floats:
        """(k, 3) array, m: the corners of the convex hull; nothing of the target lies farther."""
        try:
            return self.vertices[ConvexHull(self.vertices).vertices]
        except QhullError:  # flat, or a line
            return np.unique(self.vertices, axis=0)

    @cached_property
    def spread(self) -> Floats:
        """(4096, 3) array, m: points spread evenly over the surface."""
        return spread_points(self.vertices[self.faces], SPREAD_POINTS)

    @cached_property
    def points(self) -> Floats:
        """(m, 3) array, m: those spread and the corners together."""
        return np.concatenate([self.spread, self.corners])

    @cached_property
    def tree(self) -> KDTree:
        """The points that are spread, to be searched."""
        return KDTree(self.spread)

    @cached_property
    def diameter_m(self) -> float:
        """The largest distance between two of its points, m."""
        return float(pdist(self.corners).max())


def spread_points(triangles: Floats, count: int) -> Floats:
    """Return points spread evenly over triangles by their area, always the same ones.

    Parameters
    ----------
    triangles : (f, 3, 3) array, m
    count : int

    Returns
    -------
    (count, 3) array, m
    """
    sides = triangles[:, 1:] - triangles[:, :1]
    ends = np.cumsum(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1))
    order = np.arange(count)
    chosen = np.searchsorted(ends, (order + 0.5) / count * ends[-1])
    first, second = np.modf(np.outer([1.0 / PLASTIC, 1.0 / PLASTIC**2], order + 0.5))[0]
    over = first + second > 1.0  # in the other half of the parallelogram: turned back
    first, second = np.where(over, 1.0 - first, first), np.where(over, 1.0 - second, second)
    corner, own = triangles[chosen, 0], sides[chosen]
    return np.asarray(corner + first[:, None] * own[:, 0] + second[:, None] * own[:, 1])


def target_shape(dataset: Dataset) -> TargetShape | None:
    """Return the shape of a dataset's target; None where only its name is known.

    It is the mesh that was rendered; of a target that is not ours the surface of the wireframe on
    board. Symmetries are those that the wireframe on board declares.
    """
    wireframe = dataset.onboard.wireframe
    declared = () if wireframe is None else wireframe.symmetries
    name = dataset.info.target
    if name in SPACECRAFT:
        parts = spacecraft_by_name(name).parts
        starts = np.cumsum([0, *(len(part.mesh.vertices) for part in parts[:-1])])
        return TargetShape(
            f"the mesh of {name}",
            np.concatenate([np.asarray(part.mesh.vertices) for part in parts]),
            np.concatenate(
                [part.mesh.faces + start for part, start in zip(parts, starts, strict=True)]
            ),
            declared,
        )
    return None if wireframe is None else shape_of_wireframe(wireframe, dataset.folder)


def shape_of_wireframe(wireframe: Wireframe, folder: Path) -> TargetShape | None:
    """Return the shape that a wireframe's triangles have; None where it has none."""
    triangles = wireframe.triangles_in_target
    if not len(triangles):
        return None
    vertices = triangles.reshape(-1, 3)
    faces = np.arange(len(vertices)).reshape(-1, 3)
    return TargetShape(f"{folder.name}/wireframe.json", vertices, faces, wireframe.symmetries)
