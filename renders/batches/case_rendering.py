"""A case on its way into a dataset: opened once, then rendered exposure by exposure.

For each exposure: light from the store where it is there, else traced and put there; pixel truth
likewise; then the detector, the sealed truth, and the image last. An exposure whose image is whole
is done. Several processes may each render some frames of one dataset, as long as no frame's
exposure is metered from the one before.
"""

from __future__ import annotations

from collections.abc import Set
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from importlib.metadata import version
from typing import Any

from models.atomic_file import write_text
from models.dataset.frame_table import FrameEntry
from models.dataset.image_file import read_image
from models.errors import DatasetError
from renders.batches.dataset_writer import (
    DatasetWriter,
    check_folder,
    image_path,
    recorded_entries,
)
from renders.batches.public_half import dataset_info, public_files
from renders.batches.replay import light_record, lit_otherwise, needed_keys, read_depth
from renders.batches.studio import Studio, start_renderer
from renders.detector.compose import compose
from renders.detector.exposure_control import ExposureControl
from renders.scenario.scenario import RenderRequest, resolve
from renders.store.claims import Claim
from renders.store.kept_light import checked_budget, keeping
from renders.store.light_keys import LightKeys
from renders.store.radiance_store import RadianceStore, default_store
from renders.truth.sealed_texts import sealed_texts
from renders.variant.choice import choose_variant
from renders.world.build import world_of
from renders.world.exposure import Exposure
from renders.world.told import markers_are_told_otherwise
from renders.world.world import World

MOST_TOGETHER = 16  # exposures of one pose in a pass: beyond it, what they share is little
GROUP_BYTES, PASS_BYTES = 24, 7.5e8  # of a pixel: its sums and their copies; of a pass, at most


def provenance(world: World, variant: str) -> dict[str, str]:
    """Return what made a dataset: versions, variant and the scenario's hash."""
    return {
        "scenario": world.scenario.fingerprint(),
        "variant": variant,
        **{name: version(name) for name in ("rvbench", "mitsuba", "drjit", "numpy")},
    }


class CaseRendering:
    """A case and the folder that its dataset is rendered into; nothing is written yet.

    Parameters
    ----------
    request : RenderRequest

    Attributes
    ----------
    world : World
    variant : str
        Of Mitsuba's, that renders.
    there, left : list of Exposure
        What was there when it was opened, and what was not.

    Raises
    ------
    ScenarioError, DatasetError, VariantError
        Each says what to do.
    """

    def __init__(self, request: RenderRequest) -> None:
        self.request = request
        self.world = world = world_of(resolve(request))
        info = dataset_info(world)
        check_folder(request.out, info, world.scenario.to_toml())
        self.kept, limit_bytes = keeping(request), checked_budget(request, world)
        known = public_files(world)
        world.check_poses()
        self.control = ExposureControl(world, world.onboard(0).prior)
        self.control.resume(recorded_entries(request.out))
        self.variant = choose_variant(request.variant)
        self.info = replace(info, provenance=provenance(world, self.variant))
        self.store = RadianceStore(request.store or default_store(), limit_bytes, request.threads)
        self.keys = LightKeys(world, "scalar" if self.variant.startswith("scalar") else "jit")
        self.studio = Studio(world, self.store, self.keys, world.target.markers, kept=self.kept)
        from renders.truth.part_names import CHASER_LABEL, MARKER_LABEL

        labels = (*world.target.part_names, MARKER_LABEL, CHASER_LABEL)
        self.writer = DatasetWriter(
            request.out,
            self.info,
            known,
            self.control.entries,
            labels,
            world.scenario.to_toml(),
            world.bands,
            world.clock(0),
            world.target.markers if markers_are_told_otherwise(world.scenario.told) else None,
            sealed_texts(world),
        )
        self._poses = {e: world.trajectory.cam_from_target(e.time_s) for e in world.exposures}
        for exposure in world.exposures:  # one pose, one object: what is of it is made once
            self._poses[exposure] = self._poses[world.company(exposure)[0]]
        is_there = {e: self.writer.has_exposure(e.frame, e.band) for e in world.exposures}
        self.there = [e for e in world.exposures if is_there[e]]
        self.left = [e for e in world.exposures if not is_there[e]]

    def begin(self) -> None:
        """Write all but the exposures; refuse to mix light of two variants or versions.

        Raises
        ------
        DatasetError
            If exposures that are there are of another light; they are kept.
        StorageError
            If the folder cannot be written.
        """
        needs_light = bool(self.left) or self.request.seeds > 1
        light = {
            (e.frame, e.band): self.studio.group_keys(e, self._poses[e])
            for e in self.world.exposures
        }
        foreign = lit_otherwise(self.request.out, light, [(e.frame, e.band) for e in self.there])
        if foreign and needs_light:
            raise DatasetError(
                f"expected the {len(self.there)} exposures that are in {self.request.out} to be of "
                f"the light that {self.variant} gives with this rvbench; {len(foreign)} are of "
                "another variant or version. They are kept: go on with what rendered them, or "
                "choose another --out"
            )
        if not foreign:
            self.writer.begin()
            text = light_record(self.store, light, self.kept)
            write_text(self.request.out / "truth" / "light.json", text)
        self._shaping = {
            e: frozenset(light[e.frame, e.band].values()) | {self.keys.geometry(e, self._poses[e])}
            for e in self.world.exposures
        }
        self._needed = (
            needed_keys(self.world, light) if self.request.seeds > 1 else frozenset[str]()
        )
        self._uses_store = self.kept.uses_store and needs_light
        if self._uses_store:
            self.store.open_for_writing()

    def start_renderer(self) -> None:
        """Choose Mitsuba's variant for this process."""
        start_renderer(self.variant, self.request.threads)

    def claimed(self) -> AbstractContextManager[Any]:
        """Return what keeps others from evicting this case's light while it lasts; begun first."""
        if not self._uses_store:
            return nullcontext()
        every = frozenset[str]().union(*self._shaping.values())
        to_come = frozenset[str]().union(*(self._shaping[e] for e in self.left))
        info, needed = self.info, self._needed
        claim = Claim(info.case, info.sun, self.request.out, needed, every - needed)
        return self.store.claimed(claim, to_come)

    def take_in_hand(self, exposure: Exposure) -> None:
        """Have the store keep what shapes an exposure; of a case that was begun here."""
        self.store.room.take_in_hand(self._shaping[exposure])

    def render(self, exposure: Exposure, wanted: Set[Exposure]) -> None:
        """Render an exposure into the dataset.

        Parameters
        ----------
        exposure : Exposure
        wanted : set of Exposure
            All that this process will render: those at the same pose are traced with it.
        """
        pose = self._poses[exposure]
        groups = self.studio.light(exposure, pose, self._next_at_the_pose(exposure, wanted))
        self._put_pixel_truth(exposure)
        depth_m = read_depth(self.world, self.request.out, exposure)
        exposure_ms = self.entry(exposure.frame).exposure_ms
        image = compose(self.world, groups, exposure, exposure_ms, 0, depth_m)
        self.writer.write_exposure(image, self.studio.sealed(exposure, pose))

    def bring_back_light(self, exposure: Exposure) -> None:
        """Trace an exposure's light into the store unless it is there."""
        self.studio.light(exposure, self._poses[exposure])

    def entry(self, frame: int) -> FrameEntry:
        """Return a frame's row; what is metered on the way is written down before it is used."""
        known, band = len(self.control.entries), self.writer.bands[-1]
        folder = self.writer.folder
        entry = self.control.entry(frame, lambda index: read_image(image_path(folder, index, band)))
        if len(self.control.entries) > known:
            self.writer.write_frames()
        return entry

    def finish(self) -> None:
        """Write what is made of all exposures; they must be there."""
        self.entry(self.info.frames - 1)
        self.writer.finish()

    def _next_at_the_pose(self, exposure: Exposure, wanted: Set[Exposure]) -> list[Exposure]:
        """Return those that are wanted after an exposure at its pose, as many as fit in a pass."""
        company = [e for e in self.world.company(exposure) if e.frame > exposure.frame]
        if not company:
            return []
        groups, camera = len(self.world.groups(exposure)), self.world.camera
        room = int(PASS_BYTES / (GROUP_BYTES * groups * camera.width * camera.height))
        return [e for e in company if e in wanted][: max(0, min(MOST_TOGETHER, room) - 1)]

    def _put_pixel_truth(self, exposure: Exposure) -> None:
        """Take it from the store, or trace it; the dataset's file is the store's entry, too."""
        place, pose = (exposure.frame, exposure.band), self._poses[exposure]
        key = self.keys.geometry(exposure, pose)
        if self.writer.take_pixel_truth(*place, self.store, key):
            return
        self.writer.write_pixel_truth(*place, self.studio.pixel_truth(exposure, pose), key)
        if self.kept.keeps(exposure.frame):
            self.store.take(key, self.writer.geometry_path(*place))
