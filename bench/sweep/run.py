"""A sweep from its request to its maps: light in batches, each batch's poses, then the pictures.

Stop it anywhere, and the same command goes on: light is in the store batch by batch, and what a
shot came to is in the sweep's folder. Light that is needed and absent is traced; light that is
there but damaged is traced again, needed or not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from time import perf_counter
from typing import Any

from rich.console import Console

from bench.detections import visible_markers
from bench.frame_records import PREFERRED
from bench.sweep.folder import (
    PoseTruth,
    check_folder,
    read_pose_truth,
    scenario_path,
    write_pose_truth,
)
from bench.sweep.plan import SweepPlan, SweepPose, SweepRequest, plan_sweep
from bench.sweep.shots import Shot, read_shot, take_shots
from bench.sweep.table import Row, Setting, judged_row
from bench.sweep.time_left import LIGHT, POSES, SweepProgress
from bench.sweep.workers import Workers
from models.atomic_file import sweep_scratch, write_text
from models.errors import StorageError
from models.frame import FlightKnowledge
from renders.batch import Studio, provenance
from renders.light_keys import LightKeys
from renders.store import RadianceStore, default_store
from renders.sweep_batches import Batch, PoseLight, scenario_at, under
from renders.variant import activate, choose_variant
from renders.world import World

KEYS_IN_A_TASK = 16
MOST_ROUNDS = 3  # of tracing what another process took out of the store meanwhile


@dataclass(eq=False)
class PoseWork:
    """One pose with everything that is to be tried on it.

    Attributes
    ----------
    pose : SweepPose
    light : PoseLight
    knowledge : FlightKnowledge
    settings : list of Setting
    shots : list of lists of Shot
        By Sun, then as ``settings``.
    """

    pose: SweepPose
    light: PoseLight
    knowledge: FlightKnowledge
    settings: list[Setting]
    shots: list[list[Shot]]

    def missing_shots(self, out: Path, sun: int) -> list[Shot]:
        """Return the shots under one Sun that have not been taken."""
        return [shot for shot in self.shots[sun] if read_shot(out, shot) is None]


@dataclass(frozen=True, eq=False)
class SweepResult:
    """What a sweep came to.

    Attributes
    ----------
    plan : SweepPlan
    rows : list of Row
        By setting, Sun and pipeline, in the order asked.
    shots : dict
        The shot of (setting, Sun's text).
    knowledge : dict
        What was on board, by the pose's moment.
    provenance : dict
        Versions, variant and the scenario's hash.
    """

    plan: SweepPlan
    rows: list[Row]
    shots: dict[tuple[Setting, str], Shot]
    knowledge: dict[float, FlightKnowledge]
    provenance: dict[str, str]

    @property
    def settings(self) -> list[Setting]:
        """Poses, exposures and lamp powers, in the order asked; one Sun map is of each."""
        return list(dict.fromkeys(setting for setting, _ in self.shots))

    @property
    def map_pipeline(self) -> str:
        """The pipeline whose results the maps show."""
        chosen = self.plan.pipelines
        return PREFERRED if PREFERRED in chosen else chosen[0]


def run_sweep(request: SweepRequest, console: Console | None = None) -> SweepResult:
    """Do what a request asks for and is not there yet.

    Raises
    ------
    ScenarioError, DatasetError, VariantError, StorageError
        Each says what to do; nothing already done is lost.
    """
    console = console or Console(stderr=True)
    plan = plan_sweep(request)
    check_folder(plan)
    worlds = [World(scenario_at(plan.scenario, pose.time_s)) for pose in plan.poses]
    for world in worlds:
        world.check_poses()
    variant = choose_variant(request.variant)
    store = RadianceStore(request.store or default_store())
    store.open_for_writing()
    write_text(scenario_path(request.out), plan.scenario.to_toml())
    sweep_scratch(request.out)
    works = [
        _pose_work(plan, pose, world, store, variant)
        for pose, world in zip(plan.poses, worlds, strict=True)
    ]
    sweeper = _Sweeper(plan, works, variant, console)
    with Workers(plan.workers) as workers:
        sweeper.sweep(workers)
    truths = [sweeper.truth(work) for work in works]
    return SweepResult(
        plan=plan,
        rows=_rows(plan, works, truths),
        shots={
            (setting, sun.text): shot
            for work in works
            for sun, shots in zip(plan.suns, work.shots, strict=True)
            for setting, shot in zip(work.settings, shots, strict=True)
        },
        knowledge={work.pose.time_s: work.knowledge for work in works},
        provenance=provenance(World(plan.scenario), variant),
    )


def _pose_work(
    plan: SweepPlan, pose: SweepPose, world: World, store: RadianceStore, variant: str
) -> PoseWork:
    knowledge = world.knowledge(run=0)
    keys = LightKeys(world, "scalar" if variant.startswith("scalar") else "jit")
    light = PoseLight(Studio(world, store, keys, knowledge.markers), plan.suns)
    own_lamps_w_sr = plan.scenario.lamps.intensity_w_sr
    own_ms = world.frame_entries(knowledge.prior)[0].exposure_ms
    settings = [
        Setting(pose.time_s, pose.range_m, exposure_ms, lamp_w_sr)
        for exposure_ms, lamp_w_sr in product(
            dict.fromkeys(plan.request.exposure_ms or (own_ms,)),
            dict.fromkeys(plan.request.lamp_w_sr or (own_lamps_w_sr,)),
        )
    ]
    shots = [
        [
            Shot(
                scenario=scenario_at(plan.scenario, pose.time_s, sun.text),
                store=store.folder,
                light=light.keys(number),
                exposure_ms=setting.exposure_ms,
                lamp_factor=setting.lamp_w_sr / own_lamps_w_sr,
                pipelines=plan.pipelines,
            )
            for setting in settings
        ]
        for number, sun in enumerate(plan.suns)
    ]
    return PoseWork(pose, light, knowledge, settings, shots)


class _Sweeper:
    """Does the two stages, batch by batch."""

    def __init__(
        self, plan: SweepPlan, works: list[PoseWork], variant: str, console: Console
    ) -> None:
        self.plan = plan
        self.out = plan.request.out
        self.works = works
        self.variant = variant
        self.console = console

    def sweep(self, workers: Workers) -> None:
        """Trace and take everything that is missing."""
        damaged = self._damaged(workers)
        steps: list[tuple[PoseWork, list[Batch]]] = []
        for work in self.works:
            needed = [
                sun for sun in range(len(self.plan.suns)) if work.missing_shots(self.out, sun)
            ]
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
        found = read_pose_truth(self.out, work.pose, key, self.plan.suns)
        if found is None:
            self._load(work)
            found = work.light.truth()
            write_pose_truth(self.out, work.pose, key, found)
        return found

    def _announce(self, totals: dict[str, int], damaged: int) -> None:
        camera = self.plan.scenario.simulated_camera
        shots = sum(len(own) for work in self.works for own in work.shots)
        again = f", {damaged} of it damaged in the store" if damaged else ""
        self.console.print(
            f"{self.plan.scenario.name}: {len(self.plan.suns)} Suns, {len(self.works)} "
            f"pose{'s' if len(self.works) > 1 else ''}, {shots} image pairs at {camera.width} x "
            f"{camera.height}, {self.variant}; to trace: {totals[LIGHT]} light groups{again}; "
            f"{shots - totals[POSES]} of {shots} pairs are done already",
            soft_wrap=True,
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
            if sun not in set(needed) and any(each.key in damaged for each in own)
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
        self._trace(work, batch, progress)
        lost = self._take(work, batch.suns, progress, workers)
        for _ in range(MOST_ROUNDS):
            if not lost:
                return
            broken = set(
                _broken(
                    work.light.studio.store.folder,
                    [each.key for sun in lost for each in work.light.groups_of_sun[sun]],
                )
            )
            for again in self._batches(work, lost, broken):
                self._trace(work, again, None)
            lost = self._take(work, lost, progress, workers)
        raise StorageError(
            "expected to read back what was just written to the store "
            f"{work.light.studio.store.folder}, got nothing or something else; choose another "
            "--store on a disk that keeps it"
        )

    def _trace(self, work: PoseWork, batch: Batch, progress: SweepProgress | None) -> None:
        if not batch.groups:
            return
        began = perf_counter()
        self._load(work)
        work.light.trace(batch.groups)
        if progress is not None:
            progress.add(LIGHT, len(batch.groups), perf_counter() - began)

    def _take(
        self, work: PoseWork, suns: Sequence[int], progress: SweepProgress, workers: Workers
    ) -> list[int]:
        """Take the shots under some Suns; return the Suns whose light was not there after all."""
        missing = {sun: shots for sun in suns if (shots := work.missing_shots(self.out, sun))}
        tasks = [(shots, work.knowledge, self.out) for shots in missing.values()]
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

    def _load(self, work: PoseWork) -> None:
        """Set the variant, and hand a scene that is loaded already on to this pose."""
        activate(self.variant)
        if self.plan.request.threads is not None:
            import drjit

            drjit.set_thread_count(self.plan.request.threads)
        studio = work.light.studio
        for other in self.works:
            if studio.scene is None and other.light.studio.scene is not None:
                studio.scene, studio.geometry = (
                    other.light.studio.scene,
                    other.light.studio.geometry,
                )
        for other in self.works:  # there is one scene, and the chaser now stands elsewhere in it
            if other is not work:
                other.light.studio.placed_cam_from_target = None


def _broken(store: Path, keys: Sequence[str]) -> list[str]:
    """Return those keys whose entries are absent or not what was written."""
    return [key for key in keys if RadianceStore(store).read(key) is None]


def _rows(plan: SweepPlan, works: list[PoseWork], truths: list[PoseTruth]) -> list[Row]:
    rows = []
    for work, (pose_truth, sun_lit) in zip(works, truths, strict=True):
        camera, pattern = work.light.studio.world.camera, work.knowledge.markers
        markers = visible_markers(pose_truth, camera, pattern)
        for place, setting in enumerate(work.settings):
            for number, sun in enumerate(plan.suns):
                record = read_shot(plan.request.out, work.shots[number][place])
                if record is None:
                    raise StorageError(
                        f"expected to read back what was just written to {plan.request.out}/shots, "
                        "got nothing or something else; run the same command again"
                    )
                truth = under(pose_truth, sun, sun_lit[sun.text])
                rows += [
                    judged_row(sun, setting, name, said, truth, markers, record.saturated_percent)
                    for name, said in record.estimates.items()
                ]
    return rows


def about(result: SweepResult) -> dict[str, Any]:
    """Return what ``sweep.json`` says besides its rows."""
    return {
        "case": result.plan.scenario.name,
        "target": result.plan.scenario.target,
        "width": result.plan.scenario.camera.width,
        "samples": result.plan.scenario.render.samples,
        "marker_samples": result.plan.scenario.render.marker_samples,
        "suns": len(result.plan.suns),
        "pipelines": list(result.plan.pipelines),
        "map_pipeline": result.map_pipeline,
        "provenance": result.provenance,
    }
