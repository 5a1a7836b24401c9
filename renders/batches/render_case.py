"""Render a case, exposure by exposure; stop it anywhere, and the same command goes on.

For each exposure: light from the store where it is there, else traced and put there; pixel truth
likewise; then the detector, the sealed truth, and the image last. An exposure whose image is whole
is done.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console

from models.arrays import AnyArray, Radiance
from models.atomic_file import write_text
from models.dataset.dataset import DatasetInfo, FrameEntry, image_path, read_image
from models.errors import DatasetError, ScenarioError, StorageError
from models.frame import MarkerPattern
from models.pose import RigidTransform
from renders.batches.dataset_writer import DatasetWriter, check_folder, recorded_entries
from renders.batches.public_half import dataset_format, public_files
from renders.batches.render_progress import render_progress
from renders.batches.replay import (
    exposed_frames,
    light_record,
    lit_otherwise,
    needed_keys,
    read_depth,
    read_groups,
)
from renders.detector.compose import compose
from renders.detector.exposure_control import ExposureControl
from renders.scenario.scenario import RenderRequest, resolve
from renders.store.claims import Claim
from renders.store.kept_light import ALL_LIGHT, LightKeeping, checked_budget, keeping
from renders.store.kept_windows import windows_by_marker, write_windows
from renders.store.light_keys import LightKeys
from renders.store.radiance_store import RadianceStore, as_half, default_store
from renders.tracing.light_groups import LightGroup
from renders.truth.exposure_truth import ExposureTruth
from renders.truth.image_truth import ImageTruth
from renders.variant.choice import activate, choose_variant
from renders.world.tumble_world import TumbleWorld, world_of
from renders.world.world import Exposure, World

if TYPE_CHECKING:  # it loads Mitsuba, which must wait until a variant is known to render
    from renders.truth.pixel_truth import PixelTruth

__all__ = ["exposed_frames", "render_case"]


@dataclass(eq=False)
class Studio:
    """One world with its store, and a renderer that is loaded when first needed."""

    world: World
    store: RadianceStore
    keys: LightKeys
    markers: MarkerPattern | None
    scene: Any = None
    geometry: Any = None
    placed_cam_from_target: RigidTransform | None = None
    kept: LightKeeping = ALL_LIGHT

    def build(self, cam_from_target: RigidTransform) -> None:
        """Load the scene once, and put the chaser in its place unless it stands there."""
        from renders.tracing.scene import build_geometry, place_chaser

        if self.scene is None:
            self.geometry = build_geometry(self.world.target, self.world.chaser, self.world.optics)
            self.scene = self.geometry.scene()
        if self.placed_cam_from_target is not cam_from_target:
            place_chaser(self.scene, self.geometry, cam_from_target)
            self.placed_cam_from_target = cam_from_target

    def group_keys(self, exposure: Exposure, cam_from_target: RigidTransform) -> dict[str, str]:
        """Return the store keys of everything that can light an exposure, by group name."""
        groups = self.world.groups(exposure)
        return {group.name: self.keys.group(exposure, cam_from_target, group) for group in groups}

    def light(
        self, exposure: Exposure, cam_from_target: RigidTransform
    ) -> dict[LightGroup, Radiance]:
        """Return what lights an exposure's frame, from the store or traced now."""
        keys = self.group_keys(exposure, cam_from_target)
        there = read_groups(self.store, self.world, exposure, keys)
        if there is not None:
            return there
        images = self._traced_and_kept(exposure, cam_from_target, keys)
        return {group: images[group.name] for group in self.world.lit_by(exposure)}

    def every_group(
        self, exposure: Exposure, cam_from_target: RigidTransform
    ) -> dict[str, Radiance]:
        """Return all groups of an exposure by name, from the store or traced now."""
        keys = self.group_keys(exposure, cam_from_target)
        there = {name: self.store.read(key) for name, key in keys.items()}
        images = {name: image for name, image in there.items() if image is not None}
        if len(images) == len(keys):
            return images
        return self._traced_and_kept(exposure, cam_from_target, keys)

    def _traced_and_kept(
        self, exposure: Exposure, cam_from_target: RigidTransform, keys: dict[str, str]
    ) -> dict[str, Radiance]:
        """Trace all groups; rounded as in the store, so that frames are the same to the bit."""
        traced = self.trace(exposure, cam_from_target, self.world.groups(exposure))
        halves = {name: as_half(image) for name, image in traced.items()}
        if self.kept.keeps_whole(exposure.frame):
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
    ) -> dict[str, Radiance]:
        """Trace groups in one pass; nothing is stored."""
        from renders.tracing.radiance import Sampling, render_radiance

        self.build(cam_from_target)
        render = self.world.scenario.render
        return render_radiance(
            self.scene,
            self.geometry,
            self.world.camera,
            cam_from_target,
            groups,
            self.markers,
            Sampling(
                samples=render.samples,
                marker_samples=render.marker_samples,
                max_depth=render.max_depth,
                seed=self.world.render_seed(exposure.frame),
            ),
            self.world.in_view(exposure),
        )

    def sealed(
        self, exposure: Exposure, cam_from_target: RigidTransform
    ) -> ExposureTruth | ImageTruth:
        """Return the sealed record of an exposure, of whatever kind the world is."""
        if not isinstance(self.world, TumbleWorld):
            return self.truth(exposure, cam_from_target)
        from renders.truth.landmark_truth import image_truth

        self.build(cam_from_target)
        return image_truth(self.scene, self.world, exposure, cam_from_target)

    def truth(self, exposure: Exposure, cam_from_target: RigidTransform) -> ExposureTruth:
        """Return the sealed record of one exposure of a pair."""
        from renders.truth.pixel_truth import marker_light, outline_centres_px

        if self.markers is None:
            raise ScenarioError(
                f"expected a target with markers, {self.world.target.name} has none"
            )
        self.build(cam_from_target)
        camera, sun = self.world.camera, self.world.sun
        light = marker_light(
            self.scene,
            self.markers,
            camera,
            cam_from_target,
            self.world.lamps(exposure.band).ring,
            {sun.name: sun.direction_in_target},
        )
        return ExposureTruth(
            frame=exposure.frame,
            band=exposure.band,
            time_s=exposure.time_s,
            cam_from_target=cam_from_target,
            sun_dir_in_target=np.array(sun.direction_in_target),
            markers_px=camera.project(cam_from_target @ self.markers.points_in_target),
            marker_outlines_px=outline_centres_px(self.markers, camera, cam_from_target),
            visible=light.visible,
            lamp_lit=light.lamp_lit,
            sun_lit=light.sun_lit[sun.name],
        )

    def pixel_truth(self, cam_from_target: RigidTransform) -> PixelTruth:
        """Trace labels, depth and normals."""
        from renders.truth.pixel_truth import pixel_truth

        self.build(cam_from_target)
        return pixel_truth(
            self.scene,
            self.geometry,
            self.world.camera,
            cam_from_target,
            self.world.silhouette(cam_from_target),
        )


def provenance(world: World, variant: str) -> dict[str, str]:
    """Return what made a dataset: versions, variant and the scenario's hash."""
    return {
        "scenario": world.scenario.fingerprint(),
        "variant": variant,
        **{name: version(name) for name in ("rvbench", "mitsuba", "drjit", "numpy")},
    }


def render_case(request: RenderRequest, console: Console | None = None) -> None:
    """Render what a request asks for and is not there yet.

    Raises
    ------
    ScenarioError, DatasetError, VariantError, StorageError
        Each says what to do; nothing already rendered is lost.
    """
    world = world_of(resolve(request))
    info = DatasetInfo(
        case=world.scenario.name,
        sun=world.scenario.sun.default,
        frames=len(world.scenario.times_s),
        target=world.target.name,
        provenance={"scenario": world.scenario.fingerprint()},
        format=dataset_format(world),
    )
    check_folder(request.out, info)
    kept, limit_bytes = keeping(request), checked_budget(request, world)
    _check_kind(request, world)
    known = public_files(world)
    world.check_poses()
    control = ExposureControl(world, world.prior(run=0))
    control.resume(recorded_entries(request.out))
    variant = choose_variant(request.variant)
    info = replace(info, provenance=provenance(world, variant))
    store = RadianceStore(request.store or default_store(), limit_bytes, request.threads)
    keys = LightKeys(world, "scalar" if variant.startswith("scalar") else "jit")
    studio = Studio(world, store, keys, world.target.markers, kept=kept)
    from renders.tracing.scene import CHASER_LABEL, MARKER_LABEL

    labels = (*world.target.part_names, MARKER_LABEL, CHASER_LABEL)
    writer = DatasetWriter(
        request.out, info, known, control.entries, labels, world.scenario.to_toml(), world.bands
    )
    poses = {e: world.trajectory.cam_from_target(e.time_s) for e in world.exposures}
    windows = kept.keeps_windows
    is_there = {e: writer.has_exposure(e.frame, e.band, windows) for e in world.exposures}
    there = [e for e in world.exposures if is_there[e]]
    left = [e for e in world.exposures if not is_there[e]]
    light = {(e.frame, e.band): studio.group_keys(e, poses[e]) for e in world.exposures}
    foreign = lit_otherwise(request.out, light, [(e.frame, e.band) for e in there])
    if foreign and (left or request.seeds > 1):
        raise DatasetError(
            f"expected the {len(there)} exposures that are in {request.out} to be of the light "
            f"that {variant} gives with this rvbench; {len(foreign)} are of another variant or "
            "version. They are kept: go on with what rendered them, or choose another --out"
        )
    if not foreign:
        writer.begin()
        write_text(request.out / "truth" / "light.json", light_record(store, light, kept))
    uses_store = kept.uses_store and bool(left or request.seeds > 1)
    if uses_store:
        store.open_for_writing()
    _activate(variant, request.threads)
    console = console or Console(stderr=True)
    frames = "image pairs" if len(world.bands) > 1 else "images"
    console.print(
        f"{world.scenario.name}, Sun {world.scenario.sun.default}: {info.frames} {frames} at "
        f"{world.camera.width} x {world.camera.height}, {variant}; "
        f"{len(there)} of {len(world.exposures)} exposures are there already",
        soft_wrap=True,
    )
    shaping = {
        e: frozenset(light[e.frame, e.band].values()) | {keys.geometry(e, poses[e])}
        for e in world.exposures
    }
    needed = needed_keys(world, light) if request.seeds > 1 else frozenset[str]()
    every = frozenset[str]().union(*shaping.values())
    claim = Claim(info.case, info.sun, request.out, needed, every - needed)
    to_come = frozenset[str]().union(*(shaping[e] for e in left))
    claimed = store.claimed(claim, to_come) if uses_store else nullcontext()
    with render_progress(console) as track, claimed:
        for exposure in track(left, "render"):
            store.room.take_in_hand(shaping[exposure])
            entry = _entry(control, writer, exposure.frame)
            _render_exposure(studio, writer, exposure, poses[exposure], entry.exposure_ms)
        if request.seeds > 1:  # other runs want the light of every frame, not only its image
            for exposure in track(there, "light"):
                store.room.take_in_hand(shaping[exposure])
                studio.light(exposure, poses[exposure])
    _entry(control, writer, info.frames - 1)
    writer.finish()


def _check_kind(request: RenderRequest, world: World) -> None:
    """Refuse what single images of a target without markers cannot give."""
    if not isinstance(world, TumbleWorld):
        return
    if request.keep_light == "markers":
        raise ScenarioError(
            f"expected --keep-light all or none: {world.target.name} is seen without markers, "
            "got markers"
        )
    if request.seeds > 1:
        raise ScenarioError(
            f"expected --seeds 1 for {world.scenario.name}, a dataset of single images, "
            f"got {request.seeds}"
        )


def _entry(control: ExposureControl, writer: DatasetWriter, frame: int) -> FrameEntry:
    """Return a frame's row; what is metered on the way is written down before it is used."""
    known, band = len(control.entries), writer.bands[-1]
    entry = control.entry(frame, lambda index: read_image(image_path(writer.folder, index, band)))
    if len(control.entries) > known:
        writer.write_frames()
    return entry


def _render_exposure(
    studio: Studio,
    writer: DatasetWriter,
    exposure: Exposure,
    cam_from_target: RigidTransform,
    exposure_ms: float,
) -> None:
    if studio.kept.keeps_windows:
        by_name = studio.every_group(exposure, cam_from_target)
        assert studio.markers is not None
        windows = windows_by_marker(studio.markers, studio.world.camera, cam_from_target)
        write_windows(writer.windows_path(exposure.frame, exposure.band), windows, by_name)
        groups = {group: by_name[group.name] for group in studio.world.lit_by(exposure)}
    else:
        groups = studio.light(exposure, cam_from_target)
    _put_pixel_truth(studio, writer, exposure, cam_from_target)
    depth_m = read_depth(studio.world, writer.folder, exposure)
    image = compose(studio.world, groups, exposure, exposure_ms, 0, depth_m)
    writer.write_exposure(image, studio.sealed(exposure, cam_from_target))


def _put_pixel_truth(
    studio: Studio, writer: DatasetWriter, exposure: Exposure, cam_from_target: RigidTransform
) -> None:
    """Take it from the store, or trace it; the dataset's file is the store's entry, too."""
    place, key = (exposure.frame, exposure.band), studio.keys.geometry(exposure, cam_from_target)
    if writer.take_pixel_truth(*place, studio.store, key):
        return
    writer.write_pixel_truth(*place, studio.pixel_truth(cam_from_target), key)
    if studio.kept.keeps_whole(exposure.frame):
        studio.store.take(key, writer.geometry_path(*place))


def _activate(variant: str, threads: int | None) -> None:
    activate(variant)
    if threads is not None:
        import drjit

        drjit.set_thread_count(threads)
