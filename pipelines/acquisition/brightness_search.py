"""Poses held against an image's brightness, and moved to where it is likelier.

A pose costs a millisecond against coarse cells, three against fine ones.
"""

from __future__ import annotations

import numpy as np

from models.camera import Camera
from models.pose import RigidTransform
from models.wireframe.wireframe import Wireframe
from pipelines.acquisition.daylight import Daylight, predicted_light
from pipelines.acquisition.photometry import ShownLight, likelihood, shown_light
from pipelines.acquisition.surface_cloud import SurfaceCloud, shape_of, surface_cloud
from pipelines.tracking.edge_fit import EdgeImage

THIN_POINTS, ROUGH_CELLS = 5_000, 24.0
TURN_RAD, ASIDE, AWAY = 0.09, 0.04, 0.04  # rad, radii, of the range: a step of size 1
POLISHING = (0.5, 0.25)  # sizes of steps
LOOK_WORK = 0.035  # of a coarse look, in fits
FULL_DN = 60_000.0  # above the sky, where no detector is known

Scored = tuple[RigidTransform, float]


class BrightnessSearch:
    """One image's brightness, and poses held against it.

    Parameters
    ----------
    cut : EdgeImage
    full_dn : float, DN
        Above the sky, that saturates.
    wireframe : Wireframe
        With finishes.
    cloud : SurfaceCloud
        Of it, for fine cells.
    light : Daylight
        With ``white_dn``.
    radius_px : float, px
        About how large the target is.
    """

    def __init__(
        self,
        cut: EdgeImage,
        full_dn: float,
        wireframe: Wireframe,
        cloud: SurfaceCloud,
        light: Daylight,
        radius_px: float,
    ) -> None:
        self._camera: Camera = cut.camera
        self._radius_m, self._light = wireframe.radius_m, light
        self._cloud, self._thin = cloud, surface_cloud(shape_of(wireframe), THIN_POINTS)
        if wireframe.finish is None:
            raise ValueError("expected a wireframe with finishes")
        self._finishes = wireframe.finish.table
        self._fine = shown_light(cut.target, radius_px, full_dn)
        self._rough = shown_light(cut.target, radius_px, full_dn, ROUGH_CELLS)
        self.work = 0.0

    def share(self, pose: RigidTransform) -> float:
        """Return the share of the best log-likelihood that there could be, in fine cells."""
        self.work += 3.0 * LOOK_WORK
        return self._share(self._fine, self._cloud, pose)

    def polished(self, start: RigidTransform) -> RigidTransform:
        """Return the likeliest pose near another.

        Parameters
        ----------
        start : RigidTransform
        """
        pose = start, self._share(self._rough, self._thin, start)
        for size in POLISHING:
            pose = self._moved(pose, size)
        return pose[0]

    def _moved(self, start: Scored, size: float) -> Scored:
        """Return a pose a step away that is likelier: a search along each axis, either way.

        Parameters
        ----------
        start : (RigidTransform, float)
        size : float
            Of the step; 1 is 5 deg, 4 % of the radius aside and 4 % of the range.
        """
        pose, best = start
        steps = size * np.diag(
            [TURN_RAD] * 3 + [ASIDE * self._radius_m] * 2 + [AWAY * float(pose.translation[2])]
        )
        for step in steps:
            for way in (1.0, -1.0):
                tried = pose.perturbed(way * step[:3], way * step[3:])
                if tried.translation[2] <= self._radius_m:
                    continue
                found = self._share(self._rough, self._thin, tried)
                self.work += LOOK_WORK
                if found > best:
                    pose, best = tried, found
                    break
        return pose, best

    def _share(self, shown: ShownLight, cloud: SurfaceCloud, pose: RigidTransform) -> float:
        told = predicted_light(
            cloud, self._finishes, self._camera, pose, self._light, shown.cell_px, shown.corner_px
        )
        return likelihood(shown, told, self._light.white_dn or 0.0) / shown.most
