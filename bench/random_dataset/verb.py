"""``rvbench dataset``: the verb with its options."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

from bench.runners.arguments import typed_arguments
from bench.runners.options import (
    NAMES,
    ChunkText,
    Jobs,
    RunnerName,
    RunnerRequest,
    Sbatch,
    SchedulerAddress,
    asked_of,
)
from bench.verbs import DONE, OptionalCount
from models.errors import ScenarioError

SpecFile = Annotated[Path, arg(metavar="SPEC.toml")]
Folder = Annotated[Path, arg(metavar="DIR")]


@dataclass(frozen=True)
class Dataset:
    """Render a dataset of random poses, Suns, exposures and backgrounds, drawn by a seed.

        rvbench new dataset mine
        rvbench dataset mine.toml --out out/mine
        rvbench dataset mine.toml --out out/mine --runner slurm --jobs 40 --sbatch time=2:00:00
        rvbench export out/mine --as coco --out out/mine-coco

    SPEC.toml names spacecraft and cameras, and says from where to where all is drawn; a start file
    with every key explained comes from `rvbench new dataset`. Several Suns and exposures at a pose
    (suns_per_pose, exposures_per_sun) share its light: that of five Suns costs 1.4 times that of
    one.

    DIR gets a folder for each spacecraft, camera and specimen: each is a dataset, which the verbs
    show, estimate, score and export open. Its README.md has pictures of what was drawn, and counts
    of what was refused. Training, validation and test share no pose, and `rvbench export DIR` keeps
    them apart.

    Frame number n is the same, to the bit, whatever was rendered before it. Stop it anywhere: the
    same command goes on. Another specification in the same DIR is refused, with what differs.

    With --runner slurm or dask, jobs on other machines render into DIR, which they must see, with
    the variant that this machine has. Stop it and the jobs of slurm go on; the same command waits
    for them again, `rvbench cancel DIR` ends them. docs/clusters.md tells more.
    """

    spec: Positional[SpecFile]
    """what is drawn, as TOML"""
    out: Folder
    """folder of the dataset"""
    workers: OptionalCount = None
    """processes that render; one for each core unless given, one in all with CUDA"""
    only: Annotated[tuple[int, int] | None, arg(metavar="FIRST LAST", help_behavior_hint="")] = None
    """render these frames now, and others another time, or on another machine"""
    variant: Literal["auto", "llvm", "cuda", "scalar"] = "auto"
    """how Mitsuba computes; auto takes the fastest that renders here"""
    runner: RunnerName = "local"
    jobs: Jobs = None
    sbatch: Sbatch = ()
    scheduler: SchedulerAddress = None
    chunk: ChunkText = None

    def run(self) -> int:
        """Make it, and say what came of it.

        Raises
        ------
        ScenarioError
            If options do not go together.
        """
        from bench import api

        runner, chunk = asked_of(self, self.workers)
        if runner is not None:
            self._have_done(runner)
        result = api.dataset(
            self.spec,
            self.out,
            workers=self.workers,
            only=self.only,
            variant=self.variant,
            chunk=chunk,
        )
        if chunk is not None:
            print(f"chunk {chunk}: done, into {self.out}")
            return DONE
        for folder in result.folders:
            print(f"dataset: {folder}")
        if result.left:
            same = "the same command" if self.only is None else "the same command without --only"
            print(
                f"left: {result.left} frame{'s' if result.left != 1 else ''}; {same} renders them"
            )
        print(f"card: {(self.out / 'README.md').resolve()}")
        return DONE

    def _have_done(self, runner: RunnerRequest) -> None:
        """Have what is missing rendered on a cluster."""
        from bench.random_dataset.run import DatasetRequest
        from bench.random_dataset.shared_frames import frames_work
        from bench.runners.cluster_run import have_done
        from models.at_work import at_work
        from models.plain_console import plain_console
        from renders.variant.choice import choose_variant, short_name

        if self.only is not None:
            raise ScenarioError(
                f"expected no --only with --runner {self.runner}, which shares all that is missing"
            )
        variant = short_name(choose_variant(self.variant))  # frames of one dataset are of one kind
        shared = replace(self, variant=variant, workers=runner.workers)
        request = DatasetRequest(self.spec, self.out, variant=variant)
        work = frames_work(request, runner, typed_arguments("dataset", shared, NAMES))
        with at_work(self.out, "dataset"):
            have_done(runner, work, plain_console(stderr=True))
