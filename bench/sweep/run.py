"""A sweep from its request to its maps: light in batches, each batch's poses, then the pictures.

Stop it anywhere, and the same command goes on: light is in the store batch by batch, and what a
shot came to is in the sweep's folder. Light that is needed and absent is traced; light that is
there but damaged is traced again, needed or not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from rich.console import Console

from bench.chains.catalogue import chain_named
from bench.pictures.frame_record import pose_stood_by
from bench.runners.chunks import Chunk, runs_in_order
from bench.scoring.judgement import TrueScene
from bench.scoring.limits import Limits
from bench.sweep.folder import (
    PoseTruth,
    check_folder,
    scenario_path,
    write_asked,
)
from bench.sweep.plan import SweepPlan, SweepRequest, plan_sweep
from bench.sweep.pose_work import PoseWork, pose_work
from bench.sweep.shots import Shot, ShotRecord, read_shot
from bench.sweep.stages import Sweeper
from bench.sweep.table import Row, Setting, judged_row
from bench.sweep.workers import Workers
from models.at_work import at_work
from models.atomic_file import sweep_scratch, write_text
from models.errors import ScenarioError, StorageError
from models.frame import Frame
from models.onboard import OnboardKnowledge
from models.plain_console import plain_console
from renders.batches.case_rendering import provenance
from renders.batches.sweep_batches import scenario_at
from renders.store.radiance_store import RadianceStore, default_store
from renders.variant.choice import choose_variant
from renders.world.build import world_of
from renders.world.checks import is_dark


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
    onboard : dict
        What was on board, by the pose's moment.
    frame : callable
        Exposes the frame of a setting and a Sun's text again.
    provenance : dict
        Versions, variant and the scenario's hash.
    """

    plan: SweepPlan
    rows: list[Row]
    shots: dict[tuple[Setting, str], Shot]
    onboard: dict[float, OnboardKnowledge]
    frame: Callable[[Setting, str], Frame]
    provenance: dict[str, str]

    @property
    def settings(self) -> list[Setting]:
        """Poses, exposures and lamp powers, in the order asked; one Sun map is of each."""
        return list(dict.fromkeys(setting for setting, _ in self.shots))

    @property
    def map_pipeline(self) -> str:
        """The pipeline whose results the maps show."""
        return self.plan.map_pipeline.label


@dataclass(frozen=True, eq=False)
class BegunSweep:
    """A sweep whose folder is there: what is to be done, and with what.

    Attributes
    ----------
    plan : SweepPlan
    works : list of PoseWork
    store : RadianceStore
    variant : str
        The full name of Mitsuba's.
    """

    plan: SweepPlan
    works: list[PoseWork]
    store: RadianceStore
    variant: str


def run_sweep(request: SweepRequest, console: Console | None = None) -> SweepResult:
    """Do what a request asks for and is not there yet.

    Raises
    ------
    ScenarioError, DatasetError, VariantError, StorageError
        Each says what to do; nothing already done is lost.
    """
    console = console or plain_console(stderr=True)
    begun = begin_sweep(request, console)
    with at_work(request.out, "sweep"):
        return _swept(begun, console)


def sweep_share(request: SweepRequest, chunk: Chunk, console: Console | None = None) -> None:
    """Trace and take what is missing under a share of the Suns, and no more.

    Parameters
    ----------
    request : SweepRequest
    chunk : Chunk
    console : Console, optional
        For progress.

    Raises
    ------
    ScenarioError, DatasetError, VariantError, StorageError
        Each says what to do; nothing already done is lost.
    """
    console = console or plain_console(stderr=True)
    begun = begin_sweep(request, console)
    own = runs_in_order(range(len(begun.plan.suns)), chunk.of)[chunk.number]
    sweeper = Sweeper(begun.plan, begun.works, begun.variant, console, own)
    with (
        at_work(request.out, "sweep"),
        Workers(begun.plan.workers) as workers,
        begun.store.claimed(sweeper.claim()),
    ):
        sweeper.sweep(workers)


def begin_sweep(request: SweepRequest, console: Console) -> BegunSweep:
    """Resolve a request, and write the files that say what the folder is of.

    Raises
    ------
    ScenarioError, DatasetError, VariantError, StorageError
        Each says what to do; nothing was changed, or all that was is ours.
    """
    plan = plan_sweep(request)
    check_folder(plan)
    plan = _without_eclipsed(plan, console)
    worlds = [world_of(scenario_at(plan.scenario, pose.time_s)) for pose in plan.poses]
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
    write_asked(request.out, [shot for work in works for shot in work.every_shot])
    return BegunSweep(plan, works, store, variant)


def _swept(begun: BegunSweep, console: Console) -> SweepResult:
    plan, works, variant = begun.plan, begun.works, begun.variant
    sweeper = Sweeper(plan, works, variant, console)
    with Workers(plan.workers) as workers, begun.store.claimed(sweeper.claim()):
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
        onboard={work.pose.time_s: work.onboards[0] for work in works},
        frame=sweeper.frame,
        provenance=provenance(world_of(plan.scenario), variant),
    )


def _without_eclipsed(plan: SweepPlan, console: Console) -> SweepPlan:
    """Leave out the Suns that the Earth hides whole at one of the poses; one in part is dim."""
    shining = tuple(
        sun
        for sun in plan.suns
        if not any(
            is_dark(world_of(scenario_at(plan.scenario, pose.time_s, sun.text)))
            for pose in plan.poses
        )
    )
    if not shining:
        raise ScenarioError(
            f"expected a Sun that the Earth does not hide, got {len(plan.suns)} that it hides at "
            "these poses; give others with --suns, or another --time-s"
        )
    if len(shining) < len(plan.suns):
        console.print(
            f"{len(plan.suns) - len(shining)} of {len(plan.suns)} Suns are left out: the Earth "
            "hides them",
            soft_wrap=True,
        )
    return replace(plan, suns=shining)


def _rows(plan: SweepPlan, works: list[PoseWork], truths: list[PoseTruth]) -> list[Row]:
    rows = []
    for work, truth in zip(works, truths, strict=True):
        world = work.light.studio.world
        judge_alone = chain_named(world.chain).judge_alone
        assert judge_alone is not None, "the plan has asked"
        limits = Limits(**plan.scenario.limits.model_dump())
        scenes = [
            TrueScene(world.camera, world.target.markers, onboard, limits)
            for onboard in work.onboards
        ]
        for place, setting in enumerate(work.settings):
            for number, sun in enumerate(plan.suns):
                shot, *again = work.shots[number][place], *work.again[number][place]
                record, was = _taken(plan, shot), truth[sun.text]
                drawn = [
                    judge_alone(said, was, scenes[other.run])
                    for other in again
                    for said in _taken(plan, other).estimates.values()
                ]
                for label, said in record.estimates.items():
                    judged = judge_alone(said, was, scenes[0])
                    pose = pose_stood_by(said, work.onboards[0])
                    along_m = (
                        None if pose is None else pose.translation - was.cam_from_target.translation
                    )
                    others = drawn if label == plan.map_pipeline.label else []
                    share = record.saturated_percent
                    rows.append(judged_row(sun, setting, label, judged, along_m, share, others))
    return rows


def _taken(plan: SweepPlan, shot: Shot) -> ShotRecord:
    record = read_shot(plan.request.out, shot)
    if record is None:
        raise StorageError(
            f"expected to read back what was just written to {plan.request.out}/shots, got nothing "
            "or something else; run the same command again"
        )
    return record


def about(result: SweepResult) -> dict[str, Any]:
    """Return what ``sweep.json`` says besides its rows."""
    return {
        "case": result.plan.scenario.name,
        "target": result.plan.scenario.target,
        "width": result.plan.scenario.simulated_camera.width,
        "samples": result.plan.scenario.render.samples,
        "marker_samples": result.plan.scenario.render.marker_samples,
        "suns": len(result.plan.suns),
        "pipelines": [each.label for each in result.plan.pipelines],
        "map_pipeline": result.map_pipeline,
        "draws": result.plan.request.draws,
        "provenance": result.provenance,
    }
