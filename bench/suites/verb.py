"""``rvbench suite``: the verb with its options."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from bench.runners.arguments import typed_arguments
from bench.runners.options import (
    NAMES,
    ChunkText,
    Jobs,
    RunnerName,
    Sbatch,
    SchedulerAddress,
    asked_of,
)
from bench.verbs import DONE, OptionalCount, OptionalFolder, OptionalNumber
from models.plain_console import plain_console
from models.reading.options import check_option

MOST_WORKERS = max(64, 2 * (os.cpu_count() or 1))


@dataclass(frozen=True)
class Suite:
    """Repeat a paper's tables: every run of every case, ours beside the paper's figures.

        rvbench suite pesce2019 --quick --out out/try
        rvbench suite pesce2019 --out out/pesce --workers 8
        rvbench suite pesce2019 --parts table6 vinag --runs 10 --out out/some
        rvbench suite pesce2019 --runner slurm --jobs 40 --sbatch time=2:00:00 --out out/pesce

    Runs are spread over the cores and kept one by one: stop it anywhere, and the same command goes
    on from there. Neither the number of workers nor a stop in between changes a bit of
    DIR/suite.json but the times in it, nor does the runner. DIR/suite.html shows tables and
    figures, and what each number means.

    With --runner slurm or dask, jobs on other machines do the units into DIR, which they must see;
    this command waits for them and writes the results. Stop it and the jobs of slurm go on; the
    same command waits for them again, `rvbench cancel DIR` ends them. docs/clusters.md tells more.

    pesce2019 (parts table5, table6, table7, table8, vinag) takes about four hours of one core at
    the paper's sizes, volpe2017 (parts paper, observability, tracks, speed) about twenty minutes;
    what is left is told as it runs. vinag2018 (parts leo, geo, model, lasting, mask, faults,
    sampling, availability, stars, chain, dataset) takes a night of two cores, with --quick less
    than half an hour. opromolla2022 (parts chaser, hand, sun-map, sensitivity, or names of
    sequences such as S2 or E-SB) renders its frames; what that takes is told before it starts.
    uncooperative-suns (parts: targets, xmm, hispasat and maxar1300_unmarked, or the TOML of your
    own) takes an hour of one core a target; uncooperative-tumbles, of the same targets, three.
    """

    name: Positional[Annotated[str, arg(metavar="NAME")]]
    """name of a suite (see `rvbench list`)"""
    out: OptionalFolder = None
    """folder of the results; out/suite-NAME unless given"""
    workers: OptionalCount = None
    """processes; as many as cores unless given"""
    parts: Annotated[tuple[str, ...], arg(metavar="PART ...", help_behavior_hint="")] = ()
    """parts of the suite, all unless given"""
    quick: bool = False
    """a small version of everything, in minutes, to see it work"""
    runs: OptionalCount = None
    """runs of each case that the paper repeats (50), or of volpe2017's own case or each sequence of
    opromolla2022 (100), or starts of each target of uncooperative-suns (500), rounded up to whole
    sets of Suns, four starts of a motion, or tumbles of each of uncooperative-tumbles (50)"""
    acquisitions: OptionalCount = None
    """acquisitions of each case (1000, of which the paper's table takes the first 100), or
    attitudes of vinag2018's star camera (1000)"""
    seeds: OptionalCount = None
    """runs of each cell where the paper has a single one (10), or none (opromolla2022: 20 under
    each error alone)"""
    paper_runs: OptionalCount = None
    """most runs and acquisitions of a case by `paper`, which takes ten times as long as `best`"""
    duration_s: OptionalNumber = None
    """length of a run, in s (1800; volpe2017: of the paper's case, one orbit)"""
    rate_hz: OptionalNumber = None
    """frames a second, of a suite that renders (opromolla2022: 1; the paper's is 5), or of
    vinag2018's star sensor (5)"""
    width: OptionalCount = None
    """columns of rendered images (opromolla2022: 2048, uncooperative-*: 1024)"""
    bracket: Annotated[tuple[float, ...], arg(metavar="FACTOR ...", help_behavior_hint="")] = ()
    """further exposures of each image, as multiples of the metered one, such as 0.25 4, of
    uncooperative-suns, whose pipelines make them one"""
    store: OptionalFolder = None
    """where rendered light is kept"""
    store_budget_gb: OptionalNumber = None
    """what that may take; the longest unused goes first (20, else $RVBENCH_STORE_BUDGET_GB)"""
    seed: Annotated[int, arg(metavar="N")] = 0
    """seed of all draws"""
    runner: RunnerName = "local"
    jobs: Jobs = None
    sbatch: Sbatch = ()
    scheduler: SchedulerAddress = None
    chunk: ChunkText = None

    def run(self) -> int:
        """Run what is missing, and say what came of it.

        Raises
        ------
        ScenarioError
            If there is to be no worker, or the suite or an option is none.
        """
        from bench.suites.catalogue import suite_by_name
        from bench.suites.request import SuiteRequest

        runner, chunk = asked_of(self, self.workers)
        workers = len(os.sched_getaffinity(0)) if self.workers is None else self.workers
        check_option("--workers", workers, 1, MOST_WORKERS, whole=True)
        request = SuiteRequest(
            name=self.name,
            out=self.out or Path("out") / f"suite-{self.name}",
            workers=workers,
            parts=self.parts,
            quick=self.quick,
            runs=self.runs,
            acquisitions=self.acquisitions,
            seeds=self.seeds,
            paper_runs=self.paper_runs,
            duration_s=self.duration_s,
            rate_hz=self.rate_hz,
            width=self.width,
            bracket=self.bracket or None,
            store=self.store,
            store_budget_gb=self.store_budget_gb,
            seed=self.seed,
            chunk=chunk,
        )
        console = plain_console(stderr=True)
        suite = suite_by_name(self.name)
        if request.chunk is not None:
            done = suite.do_share(request, request.chunk, console)
            print(f"chunk {request.chunk}: {done} units done now")
            return DONE
        if runner is not None:
            shared = replace(self, out=request.out, workers=runner.workers)
            suite.have_done(request, runner, typed_arguments("suite", shared, NAMES), console)
        files = suite.run(request, console)
        _print_summary(files.summary)
        print(f"score: {files.score}")
        print(f"page:  {files.page.resolve()}")
        return DONE


def _print_summary(rows: list[list[str]]) -> None:
    from bench.report.summary import print_table
    from bench.report.table import Table

    print_table(plain_console(), Table(rows[0], rows[1:], {}, {}), "")
