"""A sweep from its request to its maps: light in batches, each batch's poses, then the pictures.

Stop it anywhere, and the same command goes on: light is in the store batch by batch, and what a
shot came to is in the sweep's folder. Light that is needed and absent is traced; light that is
there but damaged is traced again, needed or not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rich.console import Console

from bench.estimating.runs import PREFERRED
from bench.scoring.pairs.detections import visible_markers
from bench.sweep.folder import (
    PoseTruth,
    check_folder,
    scenario_path,
)
from bench.sweep.plan import SweepPlan, SweepRequest, plan_sweep
from bench.sweep.pose_work import PoseWork, pose_work
from bench.sweep.shots import Shot, read_shot
from bench.sweep.stages import Sweeper
from bench.sweep.table import Row, Setting, judged_row
from bench.sweep.workers import Workers
from models.atomic_file import sweep_scratch, write_text
from models.errors import StorageError
from models.frame import Frame
from models.plain_console import plain_console
from pipelines.chaser_fixed.knowledge import FlightKnowledge
from renders.batches.render_case import provenance
from renders.batches.sweep_batches import scenario_at, under
from renders.store.radiance_store import RadianceStore, default_store
from renders.variant.choice import choose_variant
from renders.world.world import World


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
    pair : callable
        Exposes the pair of a setting and a Sun's text again.
    provenance : dict
        Versions, variant and the scenario's hash.
    """

    plan: SweepPlan
    rows: list[Row]
    shots: dict[tuple[Setting, str], Shot]
    knowledge: dict[float, FlightKnowledge]
    pair: Callable[[Setting, str], Frame]
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
    console = console or plain_console(stderr=True)
    plan = plan_sweep(request)
    check_folder(plan)
    worlds = [World(scenario_at(plan.scenario, pose.time_s)) for pose in plan.poses]
    for world in worlds:
        world.check_poses()
    variant = choose_variant(request.variant)
    store = RadianceStore(request.store or default_store(), plan.store_bytes, request.threads)
    store.open_for_writing()
    write_text(scenario_path(request.out), plan.scenario.to_toml())
    sweep_scratch(request.out)
    works = [
        pose_work(plan, pose, world, store, variant)
        for pose, world in zip(plan.poses, worlds, strict=True)
    ]
    sweeper = Sweeper(plan, works, variant, console)
    with Workers(plan.workers) as workers, store.claimed(sweeper.claim()):
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
        pair=sweeper.pair,
        provenance=provenance(World(plan.scenario), variant),
    )


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
