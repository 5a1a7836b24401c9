"""The bench from Python: functions that the command line only wraps.

>>> from pathlib import Path
>>> from bench import api
>>> api.run("maxar-demo", Path("out/demo"))["pipelines"]["best"]["core"]  # doctest: +SKIP

Each loads what it needs when called: ``estimate`` no truth, ``score`` and ``report`` no Mitsuba.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Unpack

from bench.api_options import DatasetOptions, ExportOptions, RenderOptions, SweepOptions, check_case
from models.at_work import at_work
from models.errors import ScenarioError

if TYPE_CHECKING:  # both load much; each function loads what it needs
    from bench.compare.comparison import Comparison
    from bench.compare.options import CompareChoices
    from bench.export.plan import Plan
    from bench.random_dataset.run import DatasetResult
    from bench.sweep.outcome import SweepFiles
    from bench.sweep.run import SweepResult
    from models.camera import Camera
    from renders.batches.stepping import Simulation

MOST_RUNS = 1000  # their folders are named by three digits; see bench.estimating.runs


def render(case: str, out: Path, seeds: int = 1, **options: Unpack[RenderOptions]) -> None:
    """Render a case into a dataset: what is there already is kept.

    Parameters
    ----------
    case : str
        Name of a case, or path of a scenario file.
    out : Path
        Folder of the dataset.
    seeds : int
        Runs that are meant over this light; with more than one, what light has left the store is
        rendered again. See ``run``.
    **options
        Sun, rate, span, size, samples, variant, store, its budget, what it keeps, threads.

    Raises
    ------
    RvbenchError
        Each says what to do; nothing already rendered is lost.
    """
    check_case(case)
    from renders.batches.render_case import render_case
    from renders.scenario.scenario import RenderRequest

    render_case(RenderRequest(case=case, out=out, seeds=seeds, **options))


def estimate(
    folder: Path,
    threads: int | None = None,
    pipelines: Sequence[str] = (),
    time_limit_s: float | None = None,
) -> list[Path]:
    """Run pipelines on a dataset's public half.

    Parameters
    ----------
    folder : Path
    threads : int, optional
        Processes for what a chain tries beside the run, such as starts without a prior; as many
        as there are cores unless given.
    pipelines : sequence of str
        Labels or names, such as ``best``; unless given, all variants of the chain's own and every
        installed pipeline that the dataset's streams suit.
    time_limit_s : float, optional, s
        Most that a pipeline may take for a frame; a frame that takes longer is lost. Other
        packages' pipelines have a minute unless it is given.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    RvbenchError
        If the dataset cannot be read, or a pipeline asked for is not there.
    """
    from bench.estimating.estimation import estimate_dataset

    workers = min(threads or cores(), cores())
    return estimate_dataset(folder, pipelines, time_limit_s, workers)


def estimate_frames(
    folder: Path,
    camera: Camera,
    target: str,
    out: Path,
    rate_hz: float = 5.0,
    pipelines: Sequence[str] = (),
    time_limit_s: float | None = None,
    **files: Path | None,
) -> list[Path]:
    """Run pipelines on anybody's image pairs or single images.

    Parameters
    ----------
    folder : Path
        Of the images.
    camera : Camera
        As calibrated.
    target : str
        A target's name, or its ``markers.toml`` or ``wireframe.json``.
    out : Path
        The estimates go to ``out/estimates``.
    rate_hz : float, Hz
        Where the folder has no ``frames.csv``.
    pipelines : sequence of str
        As for ``estimate``.
    time_limit_s : float, optional, s
        As for ``estimate``.
    **files : Path or None
        ``prior``, ``detector``, ``knowledge`` and ``navigation``; see
        ``bench.estimating.foreign_knowledge``.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    RvbenchError
        If the images or what is known cannot be used.
    """
    from bench.estimating.foreign_frames import estimate_frames
    from bench.estimating.foreign_knowledge import GivenFiles

    given = GivenFiles(target, **files)
    return estimate_frames(folder, camera, given, rate_hz, out, pipelines, time_limit_s)


def score(folder: Path) -> dict[str, Any]:
    """Score the estimates of a dataset into ``score.json``; see ``bench.scoring.score``."""
    from bench.scoring.score import score_dataset

    return score_dataset(folder)


def score_estimates(
    folder: Path, estimates: Path, out: Path, **options: Unpack[CompareChoices]
) -> tuple[Comparison, dict[str, Any]]:
    """Score a file of estimates made elsewhere; see ``bench.compare.run.score_one``.

    Parameters
    ----------
    folder : Path
        The dataset, which is only read.
    estimates : Path
    out : Path
        The score, JSON.
    **options
    """
    from bench.compare.options import compare_options
    from bench.compare.run import score_one

    return score_one(folder, estimates, out, compare_options(**options))


def compare(
    methods: Sequence[Path],
    dataset: Path | None = None,
    out: Path | None = None,
    **options: Unpack[CompareChoices],
) -> tuple[Comparison, dict[str, Path]]:
    """Compare methods on the same frames; see ``bench.compare.run.write_outcome``.

    Parameters
    ----------
    methods : sequence of Path
        Files of estimates, or datasets for all estimates in them.
    dataset : Path, optional
    out : Path, optional
    **options
    """
    from bench.compare.options import compare_options
    from bench.compare.run import write_outcome

    return write_outcome(methods, dataset, out, compare_options(**options))


def report(folder: Path) -> Path:
    """Write ``report.html`` of a scored dataset; see ``bench.report.page``."""
    from bench.report.page import write_report

    return write_report(folder)


def show(folder: Path, frame: int, out: Path, variant: str | None = None) -> Path:
    """Draw one frame of a dataset into a PNG file, with estimate and truth.

    Parameters
    ----------
    folder : Path
    frame : int
    out : Path
        The picture.
    variant : str, optional
        Whose estimates; those of ``best`` unless given, or of the first that has spoken.

    Returns
    -------
    Path
        The picture.
    """
    from bench.pictures.show import write_frame

    write_frame(folder, frame, out, variant)
    return out


def export(
    datasets: Sequence[Path], kind: str, out: Path, **options: Unpack[ExportOptions]
) -> Plan:
    """Write datasets in a format that other people's tools read; what is there already is kept.

    Parameters
    ----------
    datasets : sequence of Path
    kind : str
        bop, bop-imagewise, webdataset, speedplus, coco, yolo-pose or huggingface.
    out : Path
        Folder of the export.
    **options
        Bits, tone curve, splits and more; see ``bench.export.request.ExportRequest``.

    Returns
    -------
    Plan
        Which images have left, and into which splits.

    Raises
    ------
    RvbenchError
        Each says what to do; nothing already exported is lost.
    """
    from bench.export.exporter import export_datasets
    from bench.export.request import ExportRequest

    return export_datasets(ExportRequest(tuple(datasets), kind, out, **options))


def cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0))


def run(case: str, out: Path, seeds: int = 1, **options: Unpack[RenderOptions]) -> dict[str, Any]:
    """Render what is missing, estimate, score and report.

    Parameters
    ----------
    case : str
        Name of a case, or path of a scenario file.
    out : Path
        Folder of the dataset.
    seeds : int
        Runs over the same light, each with its own detector noise and prior.
    **options
        As for ``render``.

    Returns
    -------
    dict
        The score.

    Raises
    ------
    ScenarioError
        If there are no seeds, or more than a thousand; or no pipeline takes such frames.
    RvbenchError
        Each says what to do; nothing already rendered is lost.
    """
    check_case(case)
    from bench.estimating.estimation import check_somebody_estimates
    from bench.estimating.repeated_runs import repeat_runs, runs_left
    from renders.batches.render_case import render_case
    from renders.batches.replay import light_held
    from renders.scenario.scenario import RenderRequest

    if not 1 <= seeds <= MOST_RUNS:
        raise ScenarioError(f"expected --seeds from 1 to {MOST_RUNS}, got {seeds}")
    left = runs_left(out, seeds)
    request = RenderRequest(case=case, out=out, seeds=seeds if left else 1, **options)
    render_case(request, check=check_somebody_estimates)
    with at_work(out, "run"):
        with light_held(out) if left else nullcontext():
            estimate(out, options.get("threads"))
            repeat_runs(out, seeds)
        scored = score(out)
        report(out)
    return scored


def sweep(case: str, out: Path, **options: Unpack[SweepOptions]) -> tuple[SweepResult, SweepFiles]:
    """Try poses of a case under many Suns, exposures and lamp powers.

    Parameters
    ----------
    case : str
        Name of a case, or path of a scenario file.
    out : Path
        Folder of the sweep: what is there already is kept.
    **options
        Poses, Suns, exposures, lamp powers, size, samples, store, threads, memory.

    Returns
    -------
    SweepResult, SweepFiles
        The rows with what they are of, and where table, maps and page lie.

    Raises
    ------
    RvbenchError
        Each says what to do; nothing already done is lost.
    """
    check_case(case)
    from bench.sweep.outcome import write_outcome
    from bench.sweep.plan import SweepRequest
    from bench.sweep.run import run_sweep

    result = run_sweep(SweepRequest(case=case, out=out, **options))
    return result, write_outcome(result)


def dataset(spec: Path, out: Path, **options: Unpack[DatasetOptions]) -> DatasetResult:
    """Render a dataset of random poses, or what is missing of it; see ``make_dataset``.

    Parameters
    ----------
    spec : Path
        What is drawn, as TOML.
    out : Path
    **options
    """
    from bench.random_dataset.run import DatasetRequest, make_dataset

    return make_dataset(DatasetRequest(spec, out, **options))


def simulation(case: str, run: int = 0, **options: Any) -> Simulation:
    """Start a world that is stepped frame by frame, for a loop of your own.

    Parameters
    ----------
    case : str
        Name of a case, or path of a scenario file.
    run : int
        Keys detector noise, prior and calibration.
    **options
        Sun, span, width, samples, variant, store and threads; see
        ``renders.batches.stepping.Simulation``.

    Raises
    ------
    RvbenchError
        If the case or an option cannot be used.
    """
    from renders.batches.stepping import Simulation

    return Simulation(case, run, **options)


def new(
    kind: Literal["case", "camera", "dataset", "pipeline"], name: str, folder: Path = Path()
) -> Path:
    """Write a file or a package to start from; see ``rvbench new``.

    Parameters
    ----------
    kind : str
        case, camera, dataset or pipeline.
    name : str
    folder : Path
        Where.

    Raises
    ------
    ScenarioError
        If the name cannot be, or something of that name is there.
    """
    from bench.new.start import write_start

    place, _ = write_start(kind, name, folder)
    return place
