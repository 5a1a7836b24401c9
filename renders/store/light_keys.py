"""What shapes an exposure's light, as store keys: the same light is never rendered twice."""

from __future__ import annotations

import hashlib
from dataclasses import asdict
from typing import Any

import numpy as np

from models.pose import RigidTransform
from models.spacecraft.part import Spacecraft
from renders.store.radiance_store import entry_key
from renders.tracing.light_groups import LightGroup
from renders.world.exposure import Exposure
from renders.world.world import World

PHYSICS_VERSION = 6  # raise it when the same scenario gives other light


def spacecraft_hash(spacecraft: Spacecraft) -> str:
    """Return a hash of a spacecraft's meshes, materials and markers."""
    digest = hashlib.sha256()
    for part in spacecraft.parts:
        digest.update(repr((part.name, part.smooth, spacecraft.material_of(part))).encode())
        digest.update(np.ascontiguousarray(part.mesh.vertices, dtype=np.float32).data)
        digest.update(np.ascontiguousarray(part.mesh.faces, dtype=np.int64).data)
    if spacecraft.markers is not None:
        digest.update(repr(spacecraft.markers.names).encode())
        digest.update(np.ascontiguousarray(spacecraft.markers.points_in_target).data)
        digest.update(np.ascontiguousarray(spacecraft.markers.normals_in_target).data)
        digest.update(repr(spacecraft.markers.radius_m).encode())
    return digest.hexdigest()


class LightKeys:
    """Keys of one world's light, for one family of variants.

    Parameters
    ----------
    world : World
    family : str
        ``jit`` or ``scalar``: the two draw other samples.
    """

    def __init__(self, world: World, family: str) -> None:
        self.world = world
        render = world.scenario.render.model_dump()
        render.pop("seed")
        self.common: dict[str, Any] = {
            "physics": PHYSICS_VERSION,
            "family": family,
            "target": spacecraft_hash(world.target),
            "chaser": None if world.chaser is None else spacecraft_hash(world.chaser),
            "optics": asdict(world.optics),
            "camera": asdict(world.camera),
            "render": render,
        }

    def _placed(self, exposure: Exposure, cam_from_target: RigidTransform) -> dict[str, Any]:
        return {
            **self.common,
            "pose": cam_from_target.matrix().tolist(),
            "seed": self.world.render_seed(exposure.frame),
        }

    def group(self, exposure: Exposure, cam_from_target: RigidTransform, group: LightGroup) -> str:
        """Return the key of one light group in one exposure.

        Parameters
        ----------
        exposure : Exposure
        cam_from_target : RigidTransform
            The true pose at that exposure.
        group : LightGroup
        """
        kind = {"kind": type(group).__name__, "group": asdict(group)}
        return entry_key({**self._placed(exposure, cam_from_target), **kind})

    def geometry(self, exposure: Exposure, cam_from_target: RigidTransform) -> str:
        """Return the key of labels, depth and normals in one exposure."""
        return entry_key({**self._placed(exposure, cam_from_target), "kind": "geometry"})
