"""The light of many Suns on one pose, traced in batches that fit in memory, kept in the store.

What ``rvbench run --sun`` would look for is what is put there, under the same keys: each Sun's own
frame is lit by the groups that ``World.lit_by`` names. What several Suns share, such as
the lamps, is traced once. A batch's groups go to the store as soon as they are traced, so a killed
sweep loses one batch.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models.arrays import Radiance
from models.camera import Camera
from models.errors import ScenarioError
from models.lights.sun_grid import NamedSun
from models.pose import RigidTransform
from renders.batches.studio import Studio
from renders.scenario.scenario import Scenario
from renders.store.budget import GB
from renders.store.kept_light import GROUP_BYTES
from renders.tracing.light_groups import LightGroup
from renders.truth.makers import SealedRecord
from renders.world.build import world_of
from renders.world.exposure import Exposure
from renders.world.world import World

MOST_SUNS = 48  # in one pass: beyond it, what Suns share of a pass is too little to be worth memory
BYTES_PER_SAMPLE_SUM = 4
COPIES = 6  # of each group's sums: two of lanes, in NumPy again, the image, its half floats
LEAST_GB, SCENE_GB = 1.0, 0.5  # the scene and the libraries take the second before any Sun does
GIBI = 2**30
LEAST_KEPT = 2.0  # pairs of exposures in half of a store's budget: the lamps' and one Sun's


@dataclass(frozen=True)
class GroupOfExposure:
    """One light group in one exposure, and where the store has it."""

    exposure: Exposure
    group: LightGroup
    key: str


@dataclass(frozen=True)
class Batch:
    """One step of a sweep.

    Attributes
    ----------
    suns : tuple of int
        Numbers of the Suns whose frames can be exposed once it is traced.
    groups : tuple of GroupOfExposure
        What is to be traced.
    """

    suns: tuple[int, ...]
    groups: tuple[GroupOfExposure, ...]


def scenario_at(scenario: Scenario, time_s: float, sun: str | None = None) -> Scenario:
    """Return a scenario of one frame.

    Parameters
    ----------
    scenario : Scenario
    time_s : float, s
        To which its frame is stamped: the 850 nm exposure of a pair.
    sun : str, optional
        Name of its Sun; the scenario's own unless given.
    """
    motion = scenario.motion.model_copy(update={"start_s": time_s, "end_s": time_s})
    shining = scenario.sun if sun is None else scenario.sun.model_copy(update={"default": sun})
    return scenario.model_copy(update={"motion": motion, "sun": shining})


def suns_in_a_batch(
    camera: Camera, bands: int, memory_gb: float, store_bytes: float = np.inf
) -> int:
    """Return how many Suns one pass may carry: their sums in memory, their light in the store.

    Parameters
    ----------
    camera : Camera
    bands : int
        Exposures of a frame.
    memory_gb : float, GiB
        For the whole process: scene, sums and copies.
    store_bytes : float
        The store's budget, half of which a batch may take.

    Raises
    ------
    ScenarioError
        If not even one Sun fits.
    """
    each = BYTES_PER_SAMPLE_SUM * COPIES * camera.width * camera.height
    room = (memory_gb - SCENE_GB) * GIBI
    least_gb = max(LEAST_GB, np.ceil(10.0 * (SCENE_GB + 2 * each / GIBI)) / 10.0)
    if not memory_gb >= least_gb:
        raise ScenarioError(
            f"expected --memory-gb of at least {least_gb:g} for {camera.width} x {camera.height} "
            f"pixels, got {memory_gb:g}; give more, or a smaller --width"
        )
    frame = bands * GROUP_BYTES * camera.width * camera.height
    most_kept, least_bytes = 0.5 * store_bytes / frame, 2.0 * LEAST_KEPT * frame
    if store_bytes < least_bytes:
        raise ScenarioError(
            f"expected --store-budget-gb of at least {least_bytes / GB:.2g} for a sweep "
            f"at {camera.width} x {camera.height} pixels, got {store_bytes / GB:g}; give more, or "
            "a smaller --width"
        )
    return int(min(MOST_SUNS, room / each, most_kept - 1.0))


def even_batches(count: int, most: int) -> list[range]:
    """Split ``count`` things into as few batches as may be, of one size but for the last.

    A pass of as many lights as the one before it needs no new kernel.
    """
    if count == 0:
        return []
    size = -(-count // -(-count // most))
    return [range(first, min(first + size, count)) for first in range(0, count, size)]


class PoseLight:
    """Light and truth of one pose under many Suns.

    Parameters
    ----------
    studio : Studio
        Of a world of one frame (see ``scenario_at``), unless the frame is told.
    suns : sequence of NamedSun
    exposures : sequence of Exposure, optional
        Those of one frame.
    worlds : list of World, optional
        The studio's under each Sun, where they are there already.
    """

    def __init__(
        self,
        studio: Studio,
        suns: Sequence[NamedSun],
        exposures: Sequence[Exposure] | None = None,
        worlds: list[World] | None = None,
    ) -> None:
        self.studio = studio
        self.suns = tuple(suns)
        self.exposures = tuple(studio.world.exposures if exposures is None else exposures)
        self._worlds = worlds
        self.poses: dict[int, RigidTransform] = {
            exposure.band: studio.world.trajectory.cam_from_target(exposure.time_s)
            for exposure in self.exposures
        }

    @cached_property
    def groups_of_sun(self) -> list[list[GroupOfExposure]]:
        """What lights each exposure under each Sun, in the order of ``suns``."""
        known, found = dict[str, GroupOfExposure](), []
        for world in self.worlds:
            own = []
            for exposure in self.exposures:
                for group in world.lit_by(exposure):
                    key = self.studio.group_key(exposure, self.poses[exposure.band], group)
                    own.append(known.setdefault(key, GroupOfExposure(exposure, group, key)))
            found.append(own)
        return found

    def keys(self, sun: int) -> dict[int, dict[str, str]]:
        """Return the store keys of what lights each band under Sun number ``sun``, by group.

        Of a camera that stands still, a Sun's light is one entry for all bands.
        """
        return {
            exposure.band: {
                group.name: self.studio.group_key(exposure, self.poses[exposure.band], group)
                for group in self.worlds[sun].lit_by(exposure)
            }
            for exposure in self.exposures
        }

    def batches(self, suns: Sequence[int], absent: Collection[str], most: int) -> list[Batch]:
        """Return what to trace, pass by pass, before the frames of some Suns can be exposed.

        First the Suns whose light is there, if any; then what several Suns share, in a pass of
        its own; then the others, evenly batched.

        Parameters
        ----------
        suns : sequence of int
            Numbers of the Suns, in the order in which they are wanted.
        absent : collection of str
            Keys that the store does not have.
        most : int
            Groups that one pass may carry.
        """
        shining = Counter(each.key for own in self.groups_of_sun for each in own)
        lacking = {
            sun: tuple(each for each in self.groups_of_sun[sun] if each.key in absent)
            for sun in suns
        }
        shared = {
            each.key: each for own in lacking.values() for each in own if shining[each.key] > 1
        }
        ready = tuple(sun for sun, own in lacking.items() if not own)
        dark = [sun for sun, own in lacking.items() if own]
        batches = [Batch(ready, ())] if ready else []
        if shared:
            batches.append(Batch((), tuple(shared.values())))
        in_a_pass = max((len(self._alone(lacking[sun], shining)) for sun in dark), default=1)
        for part in even_batches(len(dark), max(1, most // max(1, in_a_pass))):
            chosen = tuple(dark[place] for place in part)
            own = (each for sun in chosen for each in lacking[sun] if each.key not in shared)
            batches.append(Batch(chosen, tuple(own)))
        return batches

    def _alone(
        self, groups: Sequence[GroupOfExposure], shining: Mapping[str, int]
    ) -> list[GroupOfExposure]:
        """Return the groups of one Sun and no other in its fuller exposure."""
        by_band: dict[int, list[GroupOfExposure]] = {}
        for each in groups:
            if shining[each.key] == 1:
                by_band.setdefault(each.exposure.band, []).append(each)
        return max(by_band.values(), key=len, default=[])

    def trace(self, groups: Sequence[GroupOfExposure]) -> None:
        """Trace groups into the store, those of each exposure in one pass.

        Raises
        ------
        StorageError
            If the store cannot keep them.
        """
        by_exposure: dict[Exposure, list[GroupOfExposure]] = {}
        for each in groups:
            by_exposure.setdefault(each.exposure, []).append(each)
        for exposure, lit in by_exposure.items():
            images = self.studio.trace(
                exposure, self.poses[exposure.band], [each.group for each in lit]
            )
            self.studio.store.write_all({each.key: images[each.group.name] for each in lit})

    def depth_m(self, band: int) -> Radiance:
        """Trace the depth of each pixel in one exposure: a lens's focus needs it.

        Returns
        -------
        (height, width) float32 array, m
            0 in space.
        """
        (exposure,) = (each for each in self.exposures if each.band == band)
        return self.studio.pixel_truth(exposure, self.poses[band]).depth_m

    @cached_property
    def worlds(self) -> list[World]:
        """The world under each Sun, in the order of ``suns``."""
        if self._worlds is not None:
            return self._worlds
        scenario = self.studio.world.scenario
        tables = (scenario.sun.model_copy(update={"default": sun.text}) for sun in self.suns)
        return [world_of(scenario.model_copy(update={"sun": table})) for table in tables]

    def truths(self) -> dict[str, SealedRecord]:
        """Return the sealed record of the last exposure under each Sun, by ``NamedSun.text``."""
        exposure = self.exposures[-1]
        pose = self.poses[exposure.band]
        self.studio.build(exposure, pose)
        return {
            sun.text: world.truth(self.studio.scene, world, exposure, pose)
            for sun, world in zip(self.suns, self.worlds, strict=True)
        }
