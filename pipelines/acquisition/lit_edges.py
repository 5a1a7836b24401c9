"""Edges at which an image must show a step in brightness, by what a pose says of the light.

An edge inside a shadow, or between two faces that are equally dark, shows nothing: a fit that looks
for it there takes the step of another.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats, Mask
from models.camera import Camera
from models.pose import RigidTransform
from pipelines.acquisition.light_likelihood import ImageLight, ToldLight, regime_of, told_light
from pipelines.acquisition.surface_cloud import SurfaceCloud
from pipelines.tracking.model_edges import EdgeSamples, ModelEdges

SHADE_LEVELS = (0.005, 0.08, 0.02, 0.25, 0.4)  # by ``light_likelihood.OF_SHADE``
OUTSIDE_LEVEL, GRAZED_LEVEL, LIT_LEVEL = 0.0, 0.4, 0.55
LEAST_LEVEL = 0.01  # below it all is dark
DUE_STEP = 0.9  # of the levels' logarithms, across an edge
STEP_CELLS = 1.5  # from an edge, either way, at which its brightness is told
FEWEST_LAID = 60  # samples due, with which a pose is laid on them alone,
MOST_LAID = 0.6  # if they are less of all that show: in full light texture is seen at most others


@dataclass(frozen=True, eq=False)
class LitEdges:
    """A target's edges in one image.

    Attributes
    ----------
    edges : ModelEdges
    cloud : SurfaceCloud
    light : ImageLight
        Of the image.
    sun_in_cam : (3,) array
        Unit vector towards the Sun.
    """

    edges: ModelEdges
    cloud: SurfaceCloud
    light: ImageLight
    sun_in_cam: Floats

    @property
    def radius_m(self) -> float:
        """Of the target, m."""
        return self.edges.radius_m

    def told(self, camera: Camera, cam_from_target: RigidTransform) -> ToldLight:
        """Return what a pose says of the light."""
        return told_light(self.light, self.cloud, camera, cam_from_target, self.sun_in_cam)

    def shown(self, camera: Camera, cam_from_target: RigidTransform) -> EdgeSamples:
        """Return the samples at which a step is due; all that show if these are few, or most.

        Parameters
        ----------
        camera : Camera
        cam_from_target : RigidTransform
        """
        samples = self.edges.shown(camera, cam_from_target)
        due = self.due(samples, self.told(camera, cam_from_target))
        return due if FEWEST_LAID <= len(due) < MOST_LAID * len(samples) else samples

    def due(self, samples: EdgeSamples, told: ToldLight) -> EdgeSamples:
        """Return those of some samples at which a step is due.

        Parameters
        ----------
        samples : EdgeSamples
        told : ToldLight
            Of the same pose.
        """
        if not len(samples):
            return samples
        shade = SHADE_LEVELS[regime_of(self.light, told)]
        levels = np.array([OUTSIDE_LEVEL, shade, GRAZED_LEVEL, LIT_LEVEL])
        level = np.log(np.maximum(levels, LEAST_LEVEL))[told.said]
        size = np.array(level.shape[::-1])

        def beside(way: float) -> Floats:
            places = samples.points_px + way * STEP_CELLS * self.light.cell_px * samples.normals_px
            cell = np.floor((places - self.light.corner_px) / self.light.cell_px).astype(int)
            cell -= told.corner
            inside = np.asarray(((cell >= 0) & (cell < size)).all(axis=1))
            column, row = np.where(inside[:, None], cell, 0).T
            return np.where(inside, level[row, column], np.log(LEAST_LEVEL))

        is_due: Mask = np.abs(beside(1.0) - beside(-1.0)) > DUE_STEP
        return samples.subset(is_due)
