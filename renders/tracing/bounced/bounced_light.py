"""The target's own bounced sunlight, for one Sun after another, and the chaser's share in it.

The target and its Sun stand still while it is approached, so what foil, ring and nozzle throw onto
each other is traced once for all exposures that see it. The chaser moves: what it throws onto the
target, and what the target throws back by way of it, is traced for each exposure, with fewer paths,
as it changes over a length of metres. What the chaser takes out of the target's own bounced light
by standing in its way is left in it; its shadow on direct light is exact.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mitsuba as mi
import numpy as np

from models.arrays import AnyArray, Floats
from models.camera import Camera
from models.pose import RigidTransform
from renders.tracing.bounced.field import BouncedField, BouncedFields, LandedLight
from renders.tracing.bounced.photons import Landed, PhotonTracer, SunPicture
from renders.tracing.bounced.surface_cells import NONE, Bricks, CellFinder, SurfaceCells
from renders.tracing.light_groups import SunGroup
from renders.tracing.scene import SceneGeometry, jit_number

RAYS_ACROSS = 128  # the image, for that
CHASER_SHARE = 16  # fewer paths than for a Sun on the target alone
CELL_SEED, CHASER_SEED = 0xCE11, 0xC4A5


def seen_places(
    scene: Any, camera: Camera, poses: Sequence[RigidTransform], across: int = RAYS_ACROSS
) -> Floats:
    """Return places of a scene that a camera sees from some poses, (n, 3) m, target frame.

    Parameters
    ----------
    scene : mitsuba.Scene
    camera : Camera
    poses : sequence of RigidTransform
        ``cam_from_target``.
    across : int
        Rays along the image's longer side.
    """
    step = max(camera.width, camera.height) / across
    v, u = np.mgrid[0 : camera.height - 1 : step, 0 : camera.width - 1 : step]
    rays = camera.rays(np.stack([u.ravel(), v.ravel()], axis=1))
    rays = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    places = [np.empty((0, 3))]
    for pose in poses:
        target_from_cam = pose.inverse()
        lens, towards = target_from_cam.translation, target_from_cam.rotate(rays)
        origin = mi.Point3f(*(float(x) for x in lens))
        ray = mi.Ray3f(origin, mi.Vector3f(*towards.T.astype(np.float32)))
        distance = np.array(scene.ray_intersect_preliminary(ray).t, dtype=np.float64)
        met = np.isfinite(distance)
        places.append(lens + towards[met] * distance[met, None])
    return np.concatenate(places)


def triangles_of(shape: Any) -> Floats:
    """Return the corners of a Mitsuba mesh's triangles, (n, 3, 3) m."""
    params = mi.traverse(shape)
    corners = np.array(params["vertex_positions"], dtype=np.float64).reshape(-1, 3)
    return np.asarray(corners[np.array(params["faces"]).reshape(-1, 3)])


@dataclass(frozen=True, eq=False)
class BouncedLight:
    """Where bounced light is looked up, and what traces it.

    Attributes
    ----------
    geometry : SceneGeometry
    target : mitsuba.Scene
        Of the target alone.
    cells : SurfaceCells
    finder : CellFinder
    corners : (n, 3) array, m
        Of the target's meshes.
    max_depth : int
        Surfaces that light meets on its way to the lens.
    """

    geometry: SceneGeometry
    target: Any
    cells: SurfaceCells
    finder: CellFinder
    corners: Floats
    max_depth: int

    @classmethod
    def around(
        cls,
        geometry: SceneGeometry,
        camera: Camera,
        poses: Sequence[RigidTransform],
        max_depth: int,
    ) -> BouncedLight:
        """Return the light on what is seen from some poses.

        Parameters
        ----------
        geometry : SceneGeometry
        camera : Camera
        poses : sequence of RigidTransform
            ``cam_from_target``.
        max_depth : int
        """
        own = {key: s for key, s in geometry.shapes.items() if key not in geometry.chaser_in_cam}
        target = mi.load_dict({"type": "scene", **own}, optimize=False)
        meshes = [triangles_of(shape) for shape in own.values()]
        corners = np.concatenate([mesh.reshape(-1, 3) for mesh in meshes])
        places = seen_places(target, camera, poses)
        bricks = Bricks.around(places, corners.min(axis=0) - 1e-3, corners.max(axis=0) + 1e-3)
        cells = SurfaceCells.build(target, meshes, bricks, CELL_SEED)
        numbers = [jit_number(shape) for shape in geometry.shapes.values()]
        mesh_of_shape = np.full(max(numbers) + 1, NONE, dtype=np.uint32)
        for number, shape in enumerate(own.values()):
            mesh_of_shape[jit_number(shape)] = number
        finder = CellFinder(cells, mesh_of_shape)
        return cls(geometry, target, cells, finder, corners, max_depth)

    def landed(self, group: SunGroup, paths: int, seed: int) -> Landed:
        """Trace a Sun's bounced light on the target alone.

        Parameters
        ----------
        group : SunGroup
        paths : int
        seed : int
        """
        tracer = PhotonTracer(self.target, self.geometry.surfaces, self.max_depth)
        return tracer.arriving(group, SunPicture.of(group, self.corners), self.finder, paths, seed)

    def loaded(self, landed: Landed) -> LandedLight:
        """Return what was traced, ready to be looked up."""
        return LandedLight.load(landed, self.cells.nodes)

    def with_chaser(
        self,
        lights: Mapping[str, LandedLight],
        scene: Any,
        cam_from_target: RigidTransform,
        groups: Sequence[SunGroup],
        paths: int,
        seed: int,
    ) -> BouncedFields:
        """Add what comes by way of the chaser at one exposure.

        Parameters
        ----------
        lights : mapping of LandedLight
            By the name of a group, what lands on the target alone.
        scene : mitsuba.Scene
            With the chaser in its place.
        cam_from_target : RigidTransform
        groups : sequence of SunGroup
            The same.
        paths : int
            As for ``landed``.
        seed : int
        """
        still = BouncedField(self.finder, dict(lights))
        if not self.geometry.chaser_in_cam:
            return BouncedFields(still)
        target_from_cam = cam_from_target.inverse()
        placed = [target_from_cam @ each for each in self.geometry.chaser_in_cam.values()]
        corners = np.concatenate([self.corners, *placed])
        tracer = PhotonTracer(
            scene, self.geometry.surfaces, self.max_depth, mi.Bool(self._is_chaser()), grid=48
        )
        beside = {}
        for group in groups:
            picture = SunPicture.of(group, corners)
            few = max(1, paths // CHASER_SHARE)
            landed = tracer.arriving(group, picture, self.finder, few, seed ^ CHASER_SEED)
            beside[group.name] = self.loaded(landed)
        return BouncedFields(still, BouncedField(self.finder, beside))

    def _is_chaser(self) -> AnyArray:
        shapes = self.geometry.shapes
        is_chaser = np.zeros(max(jit_number(each) for each in shapes.values()) + 1, dtype=bool)
        for key in self.geometry.chaser_in_cam:
            is_chaser[jit_number(shapes[key])] = True
        return is_chaser
