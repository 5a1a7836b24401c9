"""What a range finder's beam meets of the target: the surface, never the centre of mass.

Truth keeps both: the distance to what is met, which the sensor gives with its noise, and that to
the centre of mass, which nobody on board can measure. The mesh is that which is rendered; no
renderer is loaded for it, so that later runs are given their readings without one.

::

    DIR/truth/ranges.csv    index, surface_m (empty where nothing is met), centre_m, met_share
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from models.arrays import Floats, Indices
from models.errors import DatasetError
from models.pose import RigidTransform
from models.reading.bounds import FRAME, LENGTH_M
from models.reading.csv_table import read_csv
from models.spacecraft.line_of_sight import distances
from models.spacecraft.part import Spacecraft

FOOTPRINT_RAYS = 61  # spread evenly over a beam that has a width
LEAST_SHARE = 0.5  # of them that must meet the target: else the echo is too weak
RANGE_TRUTH = "truth/ranges.csv"
COLUMNS = ("index", "surface_m", "centre_m", "met_share")


@dataclass(frozen=True)
class RangeTruth:
    """One reading without noise.

    Attributes
    ----------
    surface_m : float, m
        Along the boresight to what the beam meets; infinite where it meets nothing.
    centre_m : float, m
        From the camera to the target's centre of mass.
    met_share : float
        Of the beam that meets anything.
    """

    surface_m: float
    centre_m: float
    met_share: float


@dataclass(frozen=True, eq=False)
class Beam:
    """A beam along the boresight, and the target that it is to meet.

    Attributes
    ----------
    target : Spacecraft
    footprint_rad : float, rad
        Half the beam's full angle; with none it is a single ray. Of a beam with a width the median
        of what its rays meet is read: most of the light comes from there.
    """

    target: Spacecraft
    footprint_rad: float = 0.0

    def meets(self, cam_from_target: RigidTransform) -> RangeTruth:
        """Return what it meets from a pose."""
        eye = -cam_from_target.rotation.T @ cam_from_target.translation
        near = self._triangles[self._about(eye, cam_from_target.rotation[2])]
        rays = _cone(self.footprint_rad) @ cam_from_target.rotation
        far = np.array([distances(near, eye, ray).min(initial=np.inf) for ray in rays])
        met = np.isfinite(far)
        share = float(met.mean())
        read = float(np.median(far[met])) if share >= LEAST_SHARE else float(np.inf)
        centre = float(np.linalg.norm(cam_from_target @ self.target.centre_of_mass))
        return RangeTruth(read, centre, share)

    def _about(self, eye: Floats, beam: Floats) -> Indices:
        """Return which triangles the beam can meet: those whose spheres reach into its cone."""
        away = self._middles - eye
        along = away @ beam
        beside = np.sqrt(np.maximum(np.sum(away**2, axis=1) - along**2, 0.0))
        width = np.tan(self.footprint_rad) * np.maximum(along + self._radii, 0.0)
        return np.flatnonzero(beside <= self._radii + width)

    @cached_property
    def _triangles(self) -> Floats:
        return np.concatenate([np.asarray(part.mesh.triangles) for part in self.target.parts])

    @cached_property
    def _middles(self) -> Floats:
        return np.asarray(self._triangles.mean(axis=1))

    @cached_property
    def _radii(self) -> Floats:
        away = np.linalg.norm(self._triangles - self._middles[:, None], axis=2)
        return np.asarray(away.max(axis=1) * (1.0 + 1e-9) + 1e-9)


def range_truth_text(frames: Iterable[tuple[int, RangeTruth]]) -> str:
    """Return the text of ``truth/ranges.csv``, by frame."""
    lines = [",".join(COLUMNS)]
    for index, truth in frames:
        surface = repr(truth.surface_m) if np.isfinite(truth.surface_m) else ""
        lines.append(f"{index},{surface},{truth.centre_m!r},{truth.met_share!r}")
    return "\n".join(lines) + "\n"


def read_range_truths(folder: Path) -> dict[int, RangeTruth]:
    """Read what the beam met in a dataset, by frame; nothing where it has no range finder.

    Raises
    ------
    DatasetError
        If a row cannot be.
    """
    path = folder / RANGE_TRUTH
    if not path.is_file():
        return {}
    found: dict[int, RangeTruth] = {}
    for row in read_csv(path, COLUMNS):
        index = row.whole("index", *FRAME)
        if index in found:
            raise DatasetError(f"{row.where}: expected each frame once, got {index} again")
        missed = row.empty("surface_m")
        found[index] = RangeTruth(
            float(np.inf) if missed else row.number("surface_m", 0.0, LENGTH_M[1]),
            row.number("centre_m", 0.0, LENGTH_M[1]),
            row.number("met_share", 0.0, 1.0),
        )
    return found


def _cone(footprint_rad: float) -> Floats:
    """Return unit directions in camera axes, (n, 3): the boresight, or a cone about it."""
    if footprint_rad == 0.0:
        return np.array([[0.0, 0.0, 1.0]])
    number = np.arange(FOOTPRINT_RAYS)
    off = footprint_rad * np.sqrt((number + 0.5) / FOOTPRINT_RAYS)
    angle = number * np.pi * (3.0 - np.sqrt(5.0))
    return np.column_stack([np.sin(off) * np.cos(angle), np.sin(off) * np.sin(angle), np.cos(off)])
