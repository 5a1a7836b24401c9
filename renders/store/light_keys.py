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
from renders.world.bounced_choice import seen_from
from renders.world.exposure import Exposure
from renders.world.noise_limits import noise_limits
from renders.world.world import World

PHYSICS_VERSION = 7  # raise it when the same scenario gives other light


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
        digest.update(spacecraft.markers.paint.encode())
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
        for name in ("seed", "noise", "bounced", "paths"):
            render.pop(name)  # what they make of a group's light is in its own key
        self.common: dict[str, Any] = {
            "physics": PHYSICS_VERSION,
            "family": family,
            "target": spacecraft_hash(world.target),
            "chaser": None if world.chaser is None else spacecraft_hash(world.chaser),
            "optics": asdict(world.optics),
            "camera": asdict(world.camera),
            "render": render,
        }
        self.seen_from = seen_from(world, family == "jit")
        self.prior = world.onboard(0).prior

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
        limits = noise_limits(self.world, exposure, [group], self.prior)
        noise = None if limits is None else asdict(limits[group.name])
        bounced = self.bounced(group) if self.looks_up(group) else None
        made = {"noise": noise, "bounced": bounced}
        return entry_key({**self._placed(exposure, cam_from_target), **kind, **made})

    def looks_up(self, group: LightGroup) -> bool:
        """Whether a group's bounced light is looked up: a Sun's that stands as it was typed."""
        return self.seen_from is not None and group in self.world.suns

    def bounced(self, group: LightGroup) -> str:
        """Return the key of a Sun's bounced light, traced once for all exposures."""
        render = self.world.scenario.render
        return entry_key(
            {
                **{name: self.common[name] for name in ("physics", "family", "target", "optics")},
                "kind": "bounced",
                "camera": self.common["camera"],
                "poses": [pose.matrix().tolist() for pose in self.seen_from or ()],
                "max_depth": render.max_depth,
                "paths": render.paths,
                "seed": render.seed,
                "group": asdict(group),
            }
        )

    def geometry(self, exposure: Exposure, cam_from_target: RigidTransform) -> str:
        """Return the key of labels, depth and normals in one exposure."""
        return entry_key({**self._placed(exposure, cam_from_target), "kind": "geometry"})
