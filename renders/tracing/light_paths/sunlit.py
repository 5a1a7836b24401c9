"""The bounced sunlight of a scene, for one Sun after another, and the chaser's share in it.

The target and its Sun stand still while it is approached, so the paths on it are followed once for
all exposures. The chaser moves: paths that meet it are followed for each exposure. What the chaser
takes out of the target's own light by standing in its way is left in it, but for the last segments,
to the lens; its shadow on direct light is exact.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import mitsuba as mi
import numpy as np

from models.arrays import AnyArray, Floats
from models.camera import Camera
from models.pose import RigidTransform
from renders.tracing.light_groups import SunGroup
from renders.tracing.light_paths.from_sun import FromSun
from renders.tracing.light_paths.landed import Landed
from renders.tracing.light_paths.sun_paths import SunPicture, SunTracer
from renders.tracing.light_paths.to_lens import Landings, image_of
from renders.tracing.scene import SceneGeometry, jit_number

CHASER_SHARE = 4  # fewer paths than for a Sun on the target alone
CHASER_GRID = 48
CHASER_SEED = 0xC4A5


def corners_of(shape: Any) -> Floats:
    """Return the corners of a Mitsuba mesh, (n, 3) m."""
    params = mi.traverse(shape)
    return np.array(params["vertex_positions"], dtype=np.float64).reshape(-1, 3)


@dataclass(frozen=True, eq=False)
class Sunlit:
    """What sunlight meets, and which lens sees it.

    Attributes
    ----------
    geometry : SceneGeometry
    camera : Camera
    max_depth : int
        Surfaces that light meets on its way to the lens.
    footprint_m2 : float, m2
        That a pixel covers of what it sees, about.
    """

    geometry: SceneGeometry
    camera: Camera
    max_depth: int
    footprint_m2: float

    @cached_property
    def own(self) -> dict[str, Any]:
        """The target's shapes."""
        shapes = self.geometry.shapes
        return {k: shape for k, shape in shapes.items() if k not in self.geometry.chaser_in_cam}

    @cached_property
    def target(self) -> Any:
        """The target alone, a Mitsuba scene."""
        return mi.load_dict({"type": "scene", **self.own}, optimize=False)

    @cached_property
    def corners(self) -> Floats:
        """The corners of its meshes, (n, 3) m."""
        return np.concatenate([corners_of(shape) for shape in self.own.values()])

    @cached_property
    def is_chaser(self) -> AnyArray:
        """By the number of a shape, whether it is the chaser's."""
        shapes = self.geometry.shapes
        is_chaser = np.zeros(max(jit_number(each) for each in shapes.values()) + 1, dtype=bool)
        for key in self.geometry.chaser_in_cam:
            is_chaser[jit_number(shapes[key])] = True
        return is_chaser

    def landed(self, group: SunGroup, paths: int, seed: int) -> Landed:
        """Follow a Sun's light on the target alone.

        Parameters
        ----------
        group : SunGroup
        paths : int
        seed : int
        """
        tracer = SunTracer(self.target, self.geometry.surfaces, self.max_depth)
        picture = SunPicture.of(group, self.corners)
        return tracer.landing(group, picture, self.footprint_m2, paths, seed)

    def found(
        self,
        once: Mapping[SunGroup, Landings],
        scene: Any,
        cam_from_target: RigidTransform,
        paths: int,
        seed: int,
    ) -> FromSun:
        """Return what is found from Suns whose light on the target was followed before.

        Parameters
        ----------
        once : mapping of SunGroup to Landings
        scene : mitsuba.Scene
            With the chaser in its place.
        cam_from_target : RigidTransform
        paths : int
            As for ``landed``.
        seed : int
        """
        images = {
            group.name: self._image(landings, scene, cam_from_target, group)
            for group, landings in once.items()
        }
        per_m2 = {g.name: paths / SunPicture.of(g, self.corners).area_m2 for g in once}
        if not self.geometry.chaser_in_cam:
            return FromSun(images, per_m2)
        is_chaser = mi.Bool(self.is_chaser)
        found, chaser_per_m2 = self._followed(
            list(once), scene, cam_from_target, paths // CHASER_SHARE, seed, is_chaser
        )
        for name, image in found.items():
            images[name] += image
        return FromSun(images, per_m2, chaser_per_m2, is_chaser)

    def found_now(
        self,
        groups: Sequence[SunGroup],
        scene: Any,
        cam_from_target: RigidTransform,
        paths: int,
        seed: int,
    ) -> FromSun:
        """Return what is found from Suns at one exposure, all of it followed for it alone.

        Parameters
        ----------
        groups : sequence of SunGroup
        scene : mitsuba.Scene
            With the chaser in its place.
        cam_from_target : RigidTransform
        paths : int
        seed : int
        """
        return FromSun(*self._followed(groups, scene, cam_from_target, paths, seed, None))

    def _followed(
        self,
        groups: Sequence[SunGroup],
        scene: Any,
        cam_from_target: RigidTransform,
        paths: int,
        seed: int,
        only_by: Any,
    ) -> tuple[dict[str, Any], dict[str, float]]:
        target_from_cam = cam_from_target.inverse()
        placed = [target_from_cam @ each for each in self.geometry.chaser_in_cam.values()]
        corners = np.concatenate([self.corners, *placed])
        surfaces, paths = self.geometry.surfaces, max(1, paths)
        tracer = SunTracer(scene, surfaces, self.max_depth, only_by, CHASER_GRID)
        images, per_m2 = {}, {}
        for group in groups:
            picture = SunPicture.of(group, corners)
            landed = tracer.landing(group, picture, self.footprint_m2, paths, seed ^ CHASER_SEED)
            images[group.name] = self._image(Landings.load(landed), scene, cam_from_target, group)
            per_m2[group.name] = paths / picture.area_m2
        return images, per_m2

    def _image(
        self, landings: Landings, scene: Any, cam_from_target: RigidTransform, group: SunGroup
    ) -> Any:
        surfaces = self.geometry.surfaces
        return image_of(landings, scene, surfaces, self.camera, cam_from_target, group.channel)
