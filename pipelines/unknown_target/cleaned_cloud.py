"""The points of a shape with their sigmas, without those that the silhouettes leave out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.estimate import Estimate
from pipelines.unknown_target.carved_surface import CarvedSurface
from pipelines.unknown_target.pipeline import SHAPE

SIGMAS = 3.0  # by which a point may lie outside of the hull, and by a step of it


@dataclass(frozen=True, eq=False)
class Cloud:
    """Points.

    Attributes
    ----------
    points : (n, 3) array, m
        Target axes, from the centre of mass.
    sigma_m : (n,) array, m
        The root of the trace of each one's covariance; NaN where it is not told.
    """

    points: Floats
    sigma_m: Floats

    @classmethod
    def of(cls, said: Estimate) -> Cloud:
        """Return that of an estimate; empty where it tells of none."""
        values = said.states[SHAPE].values if SHAPE in said.states else {}
        points = np.asarray(values.get("points_in_target_m", np.zeros((0, 3)))).reshape(-1, 3)
        return cls(points, np.asarray(values.get("sigma_m", np.full(len(points), np.nan))))


def cleaned_cloud(cloud: Cloud, surface: CarvedSurface) -> Cloud:
    """Return the points that may lie on the target: none beyond its hull by more than they err.

    Inside of the hull nothing is said: of a hollow no outline tells.

    Parameters
    ----------
    cloud : Cloud
    surface : CarvedSurface
    """
    outside_m = -surface.depth_at(cloud.points)
    kept = outside_m < SIGMAS * np.nan_to_num(cloud.sigma_m) + surface.step_m
    return Cloud(cloud.points[kept], cloud.sigma_m[kept])
