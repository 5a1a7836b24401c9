"""Make a random dataset, or what is missing of one: draw, render, join, draw its pictures."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from rich.console import Console

from bench.random_dataset.card import card
from bench.random_dataset.coverage import contact_sheet, coverage
from bench.random_dataset.crew import Crew, Task, tasks_of
from bench.random_dataset.folder import (
    begin,
    case_path,
    check_cases,
    check_folder,
    has_begun,
    write_splits,
)
from bench.random_dataset.parts import Part
from bench.random_dataset.plan import Plan, make_plan, shots_by_chunk
from bench.random_dataset.progress import dataset_progress
from bench.random_dataset.spec import read_spec
from bench.runners.chunks import Chunk
from models.at_work import at_work
from models.atomic_file import write_bytes, write_text
from models.errors import ScenarioError
from models.plain_console import plain_console
from models.reading.options import check_option
from renders.batches.case_rendering import CaseRendering
from renders.scenario.scenario import MOST_THREADS, RenderRequest

COVERAGE, SHEET, CARD = "coverage.png", "frames.png", "README.md"


@dataclass(frozen=True)
class DatasetRequest:
    """A random dataset that is asked for.

    Attributes
    ----------
    spec : Path
    out : Path
    workers : int, optional
        Processes; one a core unless given.
    only : (int, int), optional
        First and last frame that are rendered now; all unless given.
    variant : str
        auto, llvm, cuda or scalar.
    chunk : Chunk, optional
        Render the poses of this share, and leave what is made of all to who has them all.

    Raises
    ------
    ScenarioError
        If there are no workers, or too many.
    """

    spec: Path
    out: Path
    workers: int | None = None
    only: tuple[int, int] | None = None
    variant: Literal["auto", "llvm", "cuda", "scalar"] = "auto"
    chunk: Chunk | None = None

    def __post_init__(self) -> None:
        check_option("--workers", self.workers, 1, MOST_THREADS, whole=True)
        if self.chunk is not None and self.only is not None:
            raise ScenarioError("expected either --chunk or --only, got both")


@dataclass(frozen=True, eq=False)
class DatasetResult:
    """What was made.

    Attributes
    ----------
    plan : Plan
    out : Path
    left : int
        Frames that are not there; with ``only``, others may be missing.
    """

    plan: Plan
    out: Path
    left: int

    @property
    def folders(self) -> list[Path]:
        """The datasets in it."""
        return [self.out / part.name for part in self.plan.used]


def make_dataset(request: DatasetRequest, console: Console | None = None) -> DatasetResult:
    """Make what is missing of a dataset.

    Parameters
    ----------
    request : DatasetRequest
    console : Console, optional
        Where progress goes; stderr unless given.

    Raises
    ------
    ScenarioError, DatasetError, VariantError, StorageError
        Each says what to do; nothing already rendered is lost.
    """
    console = console or plain_console(stderr=True)
    plan = planned(request)
    asked = _asked(request, plan)
    if request.chunk is None or not has_begun(request.out, plan):
        begin(request.out, plan)
        write_bytes(request.out / COVERAGE, coverage(plan))
    with at_work(request.out, "dataset"):
        return _made(request, plan, asked, console)


def _made(
    request: DatasetRequest, plan: Plan, asked: Sequence[set[int]], console: Console
) -> DatasetResult:
    cores, tasks = len(os.sched_getaffinity(0)), dict[Path, list[Task]]()
    if request.chunk is not None and request.workers is not None:
        cores = request.workers  # a job has as many as it was given, whatever else there is
    workers, missing, variant = request.workers, 0, ""
    for part in plan.used:
        if request.chunk is not None and not asked[part.number]:
            continue  # nor is its scene built, or its light counted
        begun = _begin_part(request, plan, part)
        variant, missing = begun.variant, missing + len({e.frame for e in begun.left})
        if workers is None:
            workers = 1 if variant.startswith("cuda") else cores
        left = {exposure.frame for exposure in begun.left} & asked[part.number]
        poses: dict[int, list[int]] = {}
        for shot in plan.of_part(part):
            if shot.frame in left:
                poses.setdefault(shot.pose_number, []).append(shot.frame)
        rendering = _request(request, part, max(1, cores // workers))
        tasks[rendering.out] = tasks_of(rendering, list(poses.values()))
    total = sum(len(frames) for own in tasks.values() for _, frames in own)
    assert workers is not None
    _tell(console, plan, variant, workers, missing)
    if total:
        with dataset_progress(console, total) as advance:
            for frames in Crew(workers).work(tasks):
                advance(frames)
    left_over = missing - total
    if request.chunk is not None:
        return DatasetResult(plan, request.out, left_over)
    if not left_over:
        for part in plan.used:
            CaseRendering(_request(request, part, 1)).finish()
        write_bytes(request.out / SHEET, contact_sheet(plan, request.out))
    write_text(request.out / CARD, card(plan, left_over, variant))
    return DatasetResult(plan, request.out, left_over)


def planned(request: DatasetRequest) -> Plan:
    """Return all frames as drawn, once the folder is known to be new, empty or theirs.

    Raises
    ------
    ScenarioError, DatasetError
        Nothing was written.
    """
    spec = read_spec(request.spec)
    check_folder(request.out, spec)
    plan = make_plan(spec, request.spec)
    check_cases(request.out, plan)
    return plan


def begin_parts(request: DatasetRequest, plan: Plan) -> None:
    """Write all but the frames.

    Raises
    ------
    ScenarioError, DatasetError, VariantError, StorageError
        Each says what to do; nothing already rendered is lost.
    """
    begin(request.out, plan)
    for part in plan.used:
        _begin_part(request, plan, part)


def _request(request: DatasetRequest, part: Part, threads: int) -> RenderRequest:
    return RenderRequest(
        case=str(case_path(request.out, part)),
        out=request.out / part.name,
        variant=request.variant,
        keep_light="none",
        threads=threads,
    )


def _begin_part(request: DatasetRequest, plan: Plan, part: Part) -> CaseRendering:
    case = CaseRendering(_request(request, part, 1))
    case.begin()
    write_splits(request.out, plan, part)
    return case


def _asked(request: DatasetRequest, plan: Plan) -> Sequence[set[int]]:
    """Return which frames of each part are asked for, by the part's number."""
    asked: list[set[int]] = [set() for _ in plan.parts]
    if request.chunk is not None:
        for shot in shots_by_chunk(plan, request.chunk.of)[request.chunk.number]:
            asked[shot.part].add(shot.frame)
        return asked
    first, last = request.only or (0, len(plan.shots) - 1)
    if not 0 <= first <= last < len(plan.shots):
        raise ScenarioError(
            f"expected --only as first and last frame, from 0 to {len(plan.shots) - 1}, got "
            f"{first} {last}"
        )
    for shot in plan.shots[first : last + 1]:
        asked[shot.part].add(shot.frame)
    return asked


def _tell(console: Console, plan: Plan, variant: str, workers: int, missing: int) -> None:
    spec, refused = plan.spec, sum(plan.refused.values())
    reasons = ", ".join(f"{reason}: {count}" for reason, count in plan.refused.most_common())
    console.print(
        f"{spec.name}: {spec.frames} frames of {spec.poses} poses in {len(plan.used)} folders, "
        f"{variant}, {workers} process{'es' if workers > 1 else ''}; {spec.frames - missing} are "
        f"there already; {refused} draws were refused{f' ({reasons})' if refused else ''}",
        soft_wrap=True,
    )
