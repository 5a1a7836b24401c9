"""What shapes an exposure's light, as store keys: the same light is never rendered twice."""

from __future__ import annotations

import hashlib
from dataclasses import asdict
from typing import Any

import numpy as np

from models.pose import RigidTransform
from models.spacecraft.part import Spacecraft
from renders.store.radiance_store import entry_key
from renders.tracing.light_groups import LightGroup, SunGroup
from renders.world.exposure import Exposure
from renders.world.noise_limits import noise_limits
from renders.world.shutter import OpenShutter
from renders.world.sun_paths import sun_paths
from renders.world.world import World

PHYSICS_VERSION = 10  # raise it when the same scenario gives other light


def spacecraft_hash(spacecraft: Spacecraft) -> str:
    """Return a hash of a spacecraft's meshes, materials and markers."""
    digest = hashlib.sha256()
    for part in spacecraft.parts:
        what = (part.name, part.smooth, spacecraft.material_of(part))
        digest.update(repr((*what, part.frame) if part.frame else what).encode())
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
        for name in ("seed", "noise", "paths"):
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
        self.sun_paths = sun_paths(world) if family == "jit" else None
        self.prior = world.onboard(0).prior

    def _placed(self, exposure: Exposure, cam_from_target: RigidTransform) -> dict[str, Any]:
        placed = {
            **self.common,
            "pose": cam_from_target.matrix().tolist(),
            "seed": self.world.render_seed(exposure.frame),
        }
        frames = self.world.stance(exposure.time_s).cam_from_frames
        if len(frames) > 1:
            placed["frames"] = [frame.matrix().tolist() for frame in frames]
        return placed

    def group(
        self,
        exposure: Exposure,
        cam_from_target: RigidTransform,
        group: LightGroup,
        shutter: OpenShutter | None = None,
    ) -> str:
        """Return the key of one light group in one exposure.

        Parameters
        ----------
        exposure : Exposure
        cam_from_target : RigidTransform
            The true pose at that exposure.
        group : LightGroup
        shutter : OpenShutter, optional
            Where the camera moves in it.
        """
        kind = {"kind": type(group).__name__, "group": asdict(group)}
        limits = noise_limits(self.world, exposure, [group], self.prior)
        noise = None if limits is None else asdict(limits[group.name])
        made = {"noise": noise, "found": self._found(group)}
        if shutter is not None:
            made["shutter"] = shutter.key
        return entry_key({**self._placed(exposure, cam_from_target), **kind, **made})

    def _found(self, group: LightGroup) -> Any:
        """Return what shapes the light that is found from the Sun, if any."""
        if self.sun_paths is None or not isinstance(group, SunGroup):
            return None
        return self.bounced(group) if self.sun_paths.once else asdict(self.sun_paths)

    def bounced(self, group: SunGroup) -> str:
        """Return the key of a Sun's bounced light, followed once for all exposures."""
        assert self.sun_paths is not None
        render = self.world.scenario.render
        return entry_key(
            {
                **{name: self.common[name] for name in ("physics", "family", "target", "optics")},
                "kind": "bounced",
                "paths": asdict(self.sun_paths),
                "max_depth": render.max_depth,
                "seed": render.seed,
                "group": asdict(group),
            }
        )

    def geometry(self, exposure: Exposure, cam_from_target: RigidTransform) -> str:
        """Return the key of labels, depth and normals in one exposure."""
        return entry_key({**self._placed(exposure, cam_from_target), "kind": "geometry"})
