"""One world with its store and its renderer: where the light and the truth of a case are made."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import OpenEXR

from models.arrays import AnyArray, Mask, Radiance
from models.errors import StorageError
from models.markers import MarkerPattern
from models.pose import RigidTransform
from models.spacecraft.stance import Stance
from renders.batches.moving_light import seed_of, traced_open
from renders.batches.replay import read_groups
from renders.store.kept_light import ALL_LIGHT, LightKeeping
from renders.store.light_keys import LightKeys
from renders.store.radiance_store import RadianceStore, as_half
from renders.tracing.light_groups import LightGroup, SunGroup
from renders.tracing.noise_limit import NoiseLimit
from renders.truth.makers import SealedRecord
from renders.variant.choice import activate
from renders.world.exposure import Exposure
from renders.world.noise_limits import noise_limits
from renders.world.shutter import OpenShutter, open_shutter
from renders.world.world import World

if TYPE_CHECKING:  # it loads Mitsuba, which must wait until a variant is known to render
    from renders.tracing.light_paths.from_sun import FromSun
    from renders.tracing.light_paths.landed import Landed
    from renders.tracing.light_paths.sunlit import Sunlit
    from renders.tracing.light_paths.to_lens import Landings
    from renders.tracing.radiance import Sampling
    from renders.truth.pixel_truth import PixelTruth

SUN_SEED = 0xB0


@dataclass(eq=False)
class Studio:
    """One world with its store, and a renderer that is loaded when first needed."""

    world: World
    store: RadianceStore
    keys: LightKeys
    markers: MarkerPattern | None
    scene: Any = None
    geometry: Any = None
    placed: tuple[RigidTransform, Stance] | None = None
    kept: LightKeeping = ALL_LIGHT
    sunlit: Sunlit | None = None
    open_ms: float | None = None
    """How long exposures last, if not as planned."""
    _opened: tuple[World, float | None, Exposure, OpenShutter | None] | None = field(
        default=None, init=False
    )
    """What was last added up in an exposure, and under which terms."""
    _landed: dict[SunGroup, Landings] = field(default_factory=dict, init=False)
    """Bounced light that was followed or read, by its Sun."""
    _waiting: dict[int, dict[str, AnyArray]] = field(default_factory=dict, init=False)
    """Light of the pose last traced in each band, in half floats, by its keys."""
    _filled: tuple[RigidTransform, Stance, Mask | None] | None = field(default=None, init=False)
    """A pose with the chaser's stance, and the pixels that spacecraft can fill from there."""
    _met: tuple[RigidTransform, Stance, PixelTruth] | None = field(default=None, init=False)
    """A pose with the chaser's stance, and what each pixel meets from there."""

    def build(self, exposure: Exposure, cam_from_target: RigidTransform) -> None:
        """Load the scene once, and put the chaser in its place unless it stands there."""
        from renders.tracing.scene import build_geometry, place_chaser

        if self.scene is None:
            self.geometry = build_geometry(self.world.target, self.world.chaser, self.world.optics)
            self.scene = self.geometry.scene()
        stance = self.world.stance(exposure.time_s)
        if self.placed is None or (cam_from_target, stance) != self.placed:
            self.geometry.take(stance)
            place_chaser(self.scene, self.geometry, cam_from_target)
            self.placed = cam_from_target, stance

    def group_keys(self, exposure: Exposure, cam_from_target: RigidTransform) -> dict[str, str]:
        """Return the store keys of everything that can light an exposure, by group name."""
        groups = self.world.groups(exposure)
        return {group.name: self.group_key(exposure, cam_from_target, group) for group in groups}

    def group_key(
        self, exposure: Exposure, cam_from_target: RigidTransform, group: LightGroup
    ) -> str:
        """Return the store key of what one group is in an exposure.

        Parameters
        ----------
        exposure : Exposure
        cam_from_target : RigidTransform
        group : LightGroup
        """
        return self.keys.group(exposure, cam_from_target, group, self._shutter(exposure))

    def light(
        self,
        exposure: Exposure,
        cam_from_target: RigidTransform,
        company: Sequence[Exposure] = (),
    ) -> dict[LightGroup, Radiance]:
        """Return what lights an exposure's frame, from the store or traced now.

        Parameters
        ----------
        exposure : Exposure
        cam_from_target : RigidTransform
        company : sequence of Exposure
            Others at this pose that will be asked for next: their light is traced in the same pass
            and waits for them, and what they share is traced once. No bit of it is another.

        Returns
        -------
        dict of LightGroup to (height, width) float32 arrays, W m-2 sr-1
        """
        keys = self.group_keys(exposure, cam_from_target)
        there = read_groups(self.store, self.world, exposure, keys)
        if there is not None:
            return there
        if not set(keys.values()) <= set(self._waiting.get(exposure.band, {})):
            self._trace_together([exposure, *company], cam_from_target)
        images = self._kept(exposure, keys)
        return {group: images[group.name] for group in self.world.lit_by(exposure)}

    def _trace_together(
        self, exposures: Sequence[Exposure], cam_from_target: RigidTransform
    ) -> None:
        """Trace all groups of exposures in one pass; rounded as in the store, to the same bits."""
        first = exposures[0]
        anywhere = self.world.shows_earth(first, cam_from_target)
        wanted: dict[str, tuple[Exposure, LightGroup]] = {}
        for exposure in exposures:
            if self.world.shows_earth(exposure, cam_from_target) == anywhere:  # of the same pixels
                for group in self.world.groups(exposure):
                    key = self.group_key(exposure, cam_from_target, group)
                    wanted.setdefault(key, (exposure, group))
        named, limits = dict[str, LightGroup](), dict[str, NoiseLimit]()
        for exposure, group in wanted.values():
            own = noise_limits(self.world, exposure, [group], self.keys.prior)
            if group.name in named:  # another Sun of the same table
                group = replace(group, name=f"{group.name} {len(named)}")
            named[group.name] = group
            if own is not None:
                limits[group.name] = next(iter(own.values()))
        traced = self.trace(first, cam_from_target, list(named.values()), limits or None)
        self._waiting[first.band] = {
            key: as_half(image)
            for key, image in zip(wanted, (traced[name] for name in named), strict=True)
        }

    def _kept(self, exposure: Exposure, keys: dict[str, str]) -> dict[str, Radiance]:
        """Return an exposure's traced groups, by name; they go to the store if they are kept."""
        waiting = self._waiting[exposure.band]
        halves = {name: waiting[key] for name, key in keys.items()}
        if self.kept.keeps(exposure.frame):
            self.store.write_all({keys[name]: half for name, half in halves.items()})
            for group in self.world.lit_by(exposure):
                self._check_kept(keys[group.name], halves[group.name])
        return {name: half.astype(np.float32) for name, half in halves.items()}

    def _check_kept(self, key: str, half: AnyArray) -> None:
        """Refuse a store that gives back something else; another process may have pruned it."""
        back = self.store.read(key)
        if self.store.has(key) if back is None else not np.array_equal(back, half):
            raise StorageError(
                f"expected to read back what was just written to the store {self.store.folder}, "
                "got something else; choose another --store on a disk that keeps it"
            )

    def trace(
        self,
        exposure: Exposure,
        cam_from_target: RigidTransform,
        groups: Sequence[LightGroup],
        limits: Mapping[str, NoiseLimit] | None = None,
    ) -> dict[str, Radiance]:
        """Trace groups in one pass; nothing is stored.

        Parameters
        ----------
        exposure : Exposure
        cam_from_target : RigidTransform
        groups : sequence of LightGroup
        limits : mapping of NoiseLimit, optional
            By the name of a group; as the exposure has them unless given.

        Returns
        -------
        dict of (height, width) float32 arrays, W m-2 sr-1, by group name.
        """
        from renders.tracing.radiance import Sampling

        shutter = self._shutter(exposure)
        if shutter is not None:
            return self._trace_open(shutter, exposure, cam_from_target, groups)
        self.build(exposure, cam_from_target)
        render = self.world.scenario.render
        anywhere = self.world.shows_earth(exposure, cam_from_target)
        in_view = None if anywhere else self._silhouette(exposure, cam_from_target)
        sampling = Sampling(
            samples=render.samples,
            marker_samples=render.marker_samples,
            max_depth=render.max_depth,
            seed=self.world.render_seed(exposure.frame),
            noise=limits or noise_limits(self.world, exposure, groups, self.keys.prior),
            found=self._found(exposure, cam_from_target, groups),
        )
        return self._traced(cam_from_target, groups, sampling, in_view)

    def _trace_open(
        self,
        shutter: OpenShutter,
        exposure: Exposure,
        cam_from_target: RigidTransform,
        groups: Sequence[LightGroup],
    ) -> dict[str, Radiance]:
        """Trace groups at each instant that the shutter is open."""
        from renders.tracing.radiance import Sampling

        render = self.world.scenario.render
        seed = self.world.render_seed(exposure.frame)

        def at(
            instant: Exposure, pose: RigidTransform, rows: Mask, number: int
        ) -> dict[str, Radiance]:
            if self.world.arm is None:  # out of sight: where it stands by a hair tells nobody
                self.build(exposure, cam_from_target)
            else:
                self.build(instant, pose)
            if not self.world.shows_earth(instant, pose):
                filled = self.world.silhouette(pose, self.world.stance(instant.time_s))
                rows = rows if filled is None else rows & filled
            sampling = Sampling(
                samples=shutter.samples(render.samples),
                marker_samples=shutter.samples(render.marker_samples),
                max_depth=render.max_depth,
                seed=seed_of(seed, number),
            )
            return self._traced(pose, groups, sampling, rows)

        return traced_open(shutter, exposure, groups, self.world.camera.width, at)

    def _traced(
        self,
        cam_from_target: RigidTransform,
        groups: Sequence[LightGroup],
        sampling: Sampling,
        in_view: Mask | None,
    ) -> dict[str, Radiance]:
        """Trace groups from where the scene was built for."""
        from renders.tracing.radiance import render_radiance

        camera, markers = self.world.camera, self.markers
        return render_radiance(
            self.scene, self.geometry, camera, cam_from_target, groups, markers, sampling, in_view
        )

    def _shutter(self, exposure: Exposure) -> OpenShutter | None:
        """Return what is added up in an exposure; None if it is of one instant."""
        terms = (self.world, self.open_ms, exposure)
        last = self._opened
        if last is None or last[0] is not terms[0] or last[1:3] != terms[1:]:
            last = (*terms, open_shutter(self.world, exposure, self.keys.prior, self.open_ms))
            self._opened = last
        return last[3]

    def _found(
        self, exposure: Exposure, cam_from_target: RigidTransform, groups: Sequence[LightGroup]
    ) -> FromSun:
        """Return what of some groups' light is found from their Suns at an exposure."""
        from renders.tracing.light_paths.from_sun import NOTHING
        from renders.tracing.light_paths.sunlit import Sunlit
        from renders.tracing.light_paths.to_lens import Landings

        chosen = self.keys.sun_paths
        suns = [group for group in groups if isinstance(group, SunGroup)]
        if not suns or chosen is None:
            return NOTHING
        if self.sunlit is None:
            depth = self.world.scenario.render.max_depth
            self.sunlit = Sunlit(self.geometry, self.world.camera, depth, chosen.footprint_m2)
        seed = self.world.render_seed(exposure.frame)
        placed = (self.scene, cam_from_target, chosen.paths, seed)
        if not chosen.once:
            return self.sunlit.found_now(suns, *placed)
        for sun in suns:
            if sun not in self._landed:
                self._landed[sun] = Landings.load(self._bounced_light(sun, self.sunlit))
        return self.sunlit.found({sun: self._landed[sun] for sun in suns}, *placed)

    def _bounced_light(self, sun: SunGroup, sunlit: Sunlit) -> Landed:
        """Take a Sun's bounced light from the store, or follow it."""
        from renders.tracing.light_paths.landed import Landed

        key, render = self.keys.bounced(sun), self.world.scenario.render
        there = self.store.read_channels(key)
        if there is not None and set(there) == set(Landed.CHANNELS):
            return Landed.of_channels(there)
        assert self.keys.sun_paths is not None
        seed = int(np.random.SeedSequence([render.seed, SUN_SEED]).generate_state(1)[0])
        landed = sunlit.landed(sun, self.keys.sun_paths.paths, seed)
        if self.kept.uses_store:
            self.store.write_channels(key, landed.channels())
        return landed

    def sealed(self, exposure: Exposure, cam_from_target: RigidTransform) -> SealedRecord:
        """Return the sealed record of an exposure."""
        self.build(exposure, cam_from_target)
        return self.world.truth(self.scene, self.world, exposure, cam_from_target)

    def pixel_truth(self, exposure: Exposure, cam_from_target: RigidTransform) -> PixelTruth:
        """Trace labels, depth and normals."""
        from renders.truth.pixel_truth import pixel_truth

        self.build(exposure, cam_from_target)
        stance = self.world.stance(exposure.time_s)
        if self._met is None or self._met[:2] != (cam_from_target, stance):
            met = pixel_truth(
                self.scene,
                self.geometry,
                self.world.camera,
                cam_from_target,
                self._silhouette(exposure, cam_from_target),
            )
            self._met = (cam_from_target, stance, met)
        return self._met[2]

    def _silhouette(self, exposure: Exposure, cam_from_target: RigidTransform) -> Mask | None:
        """Return the pixels that spacecraft can fill; light and truth of a pose share them."""
        stance = self.world.stance(exposure.time_s)
        if self._filled is None or self._filled[:2] != (cam_from_target, stance):
            mask = self.world.silhouette(cam_from_target, stance)
            self._filled = (cam_from_target, stance, mask)
        return self._filled[2]


def start_renderer(variant: str, threads: int | None) -> None:
    """Choose Mitsuba's variant for this process, and how many threads work; None: all cores."""
    activate(variant)
    cores = len(os.sched_getaffinity(0))
    OpenEXR.set_global_thread_count(min(threads or cores, cores))
    if threads is not None:
        import drjit

        drjit.set_thread_count(min(threads, os.cpu_count() or 1))
