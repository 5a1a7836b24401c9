"""The two stages of a sweep, batch by batch: light into the store, and each batch's shots."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path
from time import perf_counter

from rich.console import Console

from bench.sweep.folder import (
    PoseTruth,
    has_depth,
    read_pose_truth,
    write_depth,
    write_pose_truth,
)
from bench.sweep.plan import SweepPlan
from bench.sweep.pose_work import PoseWork
from bench.sweep.shots import exposed, read_light, take_shots
from bench.sweep.table import Setting
from bench.sweep.time_left import LIGHT, POSES, SweepProgress
from bench.sweep.workers import Workers
from models.errors import StorageError
from models.frame import Frame
from renders.batches.sweep_batches import Batch
from renders.store.claims import Claim
from renders.store.radiance_store import RadianceStore
from renders.variant.choice import activate

KEYS_IN_A_TASK = 16
MOST_ROUNDS = 3  # of tracing what another process took out of the store meanwhile


class Sweeper:
    """Does the two stages, batch by batch.

    Parameters
    ----------
    plan : SweepPlan
    works : list of PoseWork
    variant : str
        The full name of Mitsuba's.
    console : Console
        For progress.
    suns : collection of int, optional
        The Suns whose shots are taken; all unless given.
    """

    def __init__(
        self,
        plan: SweepPlan,
        works: list[PoseWork],
        variant: str,
        console: Console,
        suns: Collection[int] | None = None,
    ) -> None:
        self.plan = plan
        self.out = plan.request.out
        self.works = works
        self.variant = variant
        self.console = console
        self.suns = range(len(plan.suns)) if suns is None else sorted(suns)

    def claim(self) -> Claim:
        """Return what the sweep uses of the store: another tracing brings any of it back."""
        suns = f"{len(self.plan.suns)} Suns"
        name = self.plan.scenario.name
        return Claim(name, suns, self.out, frozenset(), frozenset(self._keys()))

    def frame(self, setting: Setting, sun_text: str) -> Frame:
        """Expose a frame again, its light traced again if it has left the store."""
        for work in self.works:
            for number, sun in enumerate(self.plan.suns):
                if sun.text == sun_text and setting in work.settings:
                    shot = work.shots[number][work.settings.index(setting)]
                    light = read_light(shot)
                    if light is None:
                        self._trace_again(work, [number])
                        light = read_light(shot)
                    if light is None:
                        raise self._forgetful_store()
                    return exposed(shot, light)
        raise KeyError(sun_text)

    def sweep(self, workers: Workers) -> None:
        """Trace and take everything that is missing."""
        damaged = self._damaged(workers)
        steps: list[tuple[PoseWork, list[Batch]]] = []
        for work in self.works:
            needed = [sun for sun in self.suns if work.missing_shots(self.out, sun)]
            steps.append((work, self._batches(work, needed, damaged)))
        totals = {
            LIGHT: sum(len(batch.groups) for _, batches in steps for batch in batches),
            POSES: sum(
                len(work.missing_shots(self.out, sun))
                for work, batches in steps
                for batch in batches
                for sun in batch.suns
            ),
        }
        self._announce(totals, len(damaged))
        for work, batches in steps:
            if batches:
                self._put_depth(work)
        progress = SweepProgress(self.console, totals)
        with progress.shown():
            for work, batches in steps:
                for batch in batches:
                    self._step(work, batch, progress, workers)

    def truth(self, work: PoseWork) -> PoseTruth:
        """Return the truth of a pose, traced now unless it is there."""
        studio = work.light.studio
        exposure = studio.world.exposures[-1]
        key = studio.keys.geometry(exposure, work.light.poses[exposure.band])
        found = read_pose_truth(self.out, work, key)
        if found is None:
            self._load(work)
            found = work.light.truths()
            write_pose_truth(self.out, work.pose, key, found)
        return found

    def _announce(self, totals: dict[str, int], damaged: int) -> None:
        camera = self.plan.scenario.simulated_camera
        shots = sum(len(work.every_shot) for work in self.works)
        again = f", {damaged} of it damaged in the store" if damaged else ""
        self.console.print(
            f"{self.plan.scenario.name}: {len(self.plan.suns)} Suns, {len(self.works)} "
            f"pose{'s' if len(self.works) > 1 else ''}, {shots} frames at {camera.width} x "
            f"{camera.height}, {self.variant}; to trace: {totals[LIGHT]} light groups{again}; "
            f"{shots - totals[POSES]} of {shots} frames are done already",
            soft_wrap=True,
            markup=False,
        )

    def _damaged(self, workers: Workers) -> set[str]:
        """Read every entry that is there: what is not whole is as good as absent."""
        store = self.works[0].light.studio.store
        there = [key for key in self._keys() if store.has(key)]
        tasks = [
            (store.folder, there[first : first + KEYS_IN_A_TASK])
            for first in range(0, len(there), KEYS_IN_A_TASK)
        ]
        return {key for _, broken in workers.run(_broken, tasks) for key in broken}

    def _keys(self) -> list[str]:
        groups = (own for work in self.works for own in work.light.groups_of_sun)
        return list(dict.fromkeys(each.key for own in groups for each in own))

    def _batches(self, work: PoseWork, needed: Sequence[int], damaged: set[str]) -> list[Batch]:
        store, light = work.light.studio.store, work.light
        hurt = [
            sun
            for sun, own in enumerate(light.groups_of_sun)
            if sun in self.suns
            and sun not in set(needed)
            and any(each.key in damaged for each in own)
        ]
        absent = {
            each.key
            for sun in needed
            for each in light.groups_of_sun[sun]
            if not store.has(each.key)
        }
        return light.batches([*needed, *hurt], absent | damaged, self.plan.suns_in_a_pass)

    def _step(
        self, work: PoseWork, batch: Batch, progress: SweepProgress, workers: Workers
    ) -> None:
        own = [each.key for sun in batch.suns for each in work.light.groups_of_sun[sun]]
        traced = [each.key for each in batch.groups]
        work.light.studio.store.room.take_in_hand(frozenset([*own, *traced]))
        self._trace(work, batch, progress)
        lost = self._take(work, batch.suns, progress, workers)
        for _ in range(MOST_ROUNDS):
            if not lost:
                return
            self._trace_again(work, lost)
            lost = self._take(work, lost, progress, workers)
        raise self._forgetful_store()

    def _trace_again(self, work: PoseWork, suns: Sequence[int]) -> None:
        """Trace what is not whole of some Suns' light."""
        keys = [each.key for sun in suns for each in work.light.groups_of_sun[sun]]
        broken = set(_broken(work.light.studio.store.folder, keys))
        for batch in self._batches(work, suns, broken):
            self._trace(work, batch, None)

    def _forgetful_store(self) -> StorageError:
        return StorageError(
            "expected to read back what was just written to the store "
            f"{self.works[0].light.studio.store.folder}, got nothing or something else; choose "
            "another --store on a disk that keeps it, or a larger --store-budget-gb"
        )

    def _trace(self, work: PoseWork, batch: Batch, progress: SweepProgress | None) -> None:
        if not batch.groups:
            return
        began = perf_counter()
        self._load(work)
        work.light.trace(batch.groups)
        if progress is not None:
            # A pass of one lamp tells nothing of passes that many Suns share.
            spent_s, telling = perf_counter() - began, bool(batch.suns)
            progress.add(LIGHT, len(batch.groups), spent_s, telling)

    def _take(
        self, work: PoseWork, suns: Sequence[int], progress: SweepProgress, workers: Workers
    ) -> list[int]:
        """Take the shots under some Suns; return the Suns whose light was not there after all."""
        missing = {sun: shots for sun in suns if (shots := work.missing_shots(self.out, sun))}
        tasks = [(shots, work.onboards, self.out) for shots in missing.values()]
        lost, before = [], perf_counter()
        for number, taken in workers.run(take_shots, tasks):
            sun = list(missing)[number]
            if not taken:
                lost.append(sun)
                continue
            now = perf_counter()
            progress.add(POSES, len(missing[sun]), now - before)
            before = now
        return sorted(lost)

    def _put_depth(self, work: PoseWork) -> None:
        """Trace the depth of the pose's pixels where the lens needs it and it is not there."""
        studio = work.light.studio
        for exposure in studio.world.exposures:
            path = work.shots[0][0].depth.get(exposure.band)
            key = studio.keys.geometry(exposure, work.light.poses[exposure.band])
            if path is not None and not has_depth(path, key):
                self._load(work)
                write_depth(path, key, work.light.depth_m(exposure.band))

    def _load(self, work: PoseWork) -> None:
        """Set the variant, and hand a scene that is loaded already on to this pose."""
        activate(self.variant)
        if self.plan.request.threads is not None:
            import drjit

            drjit.set_thread_count(self.plan.workers)
        studio = work.light.studio
        for other in self.works:
            if studio.scene is None and other.light.studio.scene is not None:
                studio.scene, studio.geometry = (
                    other.light.studio.scene,
                    other.light.studio.geometry,
                )
        for other in self.works:  # there is one scene, and the chaser now stands elsewhere in it
            if other is not work:
                other.light.studio.placed = None


def _broken(store: Path, keys: Sequence[str]) -> list[str]:
    """Return those keys whose entries are absent or not what was written."""
    return [key for key in keys if RadianceStore(store).read(key) is None]
