"""Render a case, exposure by exposure; stop it anywhere, and the same command goes on.

For each exposure: light from the store where it is there, else traced and put there; pixel truth
likewise; then the detector, the sealed truth, and the image last. An exposure whose image is whole
is done.
"""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace
from importlib.metadata import version

from rich.console import Console

from models.atomic_file import write_text
from models.dataset.frame_table import FrameEntry
from models.dataset.image_file import read_image
from models.errors import DatasetError
from models.plain_console import plain_console
from models.pose import RigidTransform
from renders.batches.dataset_writer import (
    DatasetWriter,
    check_folder,
    image_path,
    recorded_entries,
)
from renders.batches.public_half import dataset_info, public_files
from renders.batches.render_progress import render_progress
from renders.batches.replay import light_record, lit_otherwise, needed_keys, read_depth
from renders.batches.studio import Studio, start_renderer
from renders.detector.compose import compose
from renders.detector.exposure_control import ExposureControl
from renders.scenario.scenario import RenderRequest, resolve
from renders.store.claims import Claim
from renders.store.kept_light import checked_budget, keeping
from renders.store.light_keys import LightKeys
from renders.store.radiance_store import RadianceStore, default_store
from renders.variant.choice import choose_variant
from renders.world.build import world_of
from renders.world.exposure import Exposure
from renders.world.sun_paths import told
from renders.world.told import markers_are_told_otherwise
from renders.world.world import World


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
    info = dataset_info(world)
    check_folder(request.out, info)
    kept, limit_bytes = keeping(request), checked_budget(request, world)
    known = public_files(world)
    world.check_poses()
    control = ExposureControl(world, world.onboard(0).prior)
    control.resume(recorded_entries(request.out))
    variant = choose_variant(request.variant)
    info = replace(info, provenance=provenance(world, variant))
    store = RadianceStore(request.store or default_store(), limit_bytes, request.threads)
    keys = LightKeys(world, "scalar" if variant.startswith("scalar") else "jit")
    studio = Studio(world, store, keys, world.target.markers, kept=kept)
    from renders.truth.part_names import CHASER_LABEL, MARKER_LABEL

    labels = (*world.target.part_names, MARKER_LABEL, CHASER_LABEL)
    writer = DatasetWriter(
        request.out,
        info,
        known,
        control.entries,
        labels,
        world.scenario.to_toml(),
        world.bands,
        world.clock(0),
        world.target.markers if markers_are_told_otherwise(world.scenario.told) else None,
    )
    poses = {e: world.trajectory.cam_from_target(e.time_s) for e in world.exposures}
    is_there = {e: writer.has_exposure(e.frame, e.band) for e in world.exposures}
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
    start_renderer(variant, request.threads)
    console = console or plain_console(stderr=True)
    frames = "image pairs" if len(world.bands) > 1 else "images"
    console.print(
        f"{world.scenario.name}, Sun {world.scenario.sun.default}: {info.frames} {frames} at "
        f"{world.camera.width} x {world.camera.height}, {variant}; "
        f"{len(there)} of {len(world.exposures)} exposures are there already; "
        f"{told(keys.sun_paths, len(world.suns))}",
        soft_wrap=True,
        markup=False,
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
    if studio.kept.keeps(exposure.frame):
        studio.store.take(key, writer.geometry_path(*place))
