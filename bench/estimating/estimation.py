"""Estimate a dataset: its chain's pipelines, and every installed one that its streams suit."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path

from bench.chains.catalogue import chain_named
from bench.estimating.contenders import Contender, contenders, what_ours_lack
from bench.estimating.guard import printable
from bench.estimating.runner import estimate_run
from bench.estimating.runs import estimates_path, spoken_variants
from models.dataset.dataset import Dataset, open_dataset
from models.dataset.description import DatasetInfo
from models.errors import ScenarioError
from models.plain_console import plain_console

HOW_TO_BE_TAKEN = (
    "Of a target without markers ours need the chaser's orbit, which [tumble] in the scenario "
    'brings; of one with markers, image pairs (frame.kind = "pairs"). `rvbench new pipeline NAME` '
    "writes a pipeline of your own to start from"
)


def taking_part(
    dataset: Dataset, asked: Sequence[str] = (), *, tell: bool = True
) -> list[Contender]:
    """Return who estimates a dataset.

    Parameters
    ----------
    dataset : Dataset
    asked : sequence of str
        Labels or names of pipelines; if any are given, these alone.
    tell : bool
        Whether to say on stderr who cannot.

    Raises
    ------
    ScenarioError
        If one asked for is not there, or nobody can run.
    """
    found, remarks = _suited(dataset.info, asked)
    if tell:
        tell_of(remarks)
    if not found:
        raise ScenarioError(f"{dataset.folder}: {_nobody(dataset.info)}. {HOW_TO_BE_TAKEN}")
    return found


def check_somebody_estimates(info: DatasetInfo) -> None:
    """Refuse a case that no pipeline would estimate, before anything is rendered.

    Parameters
    ----------
    info : DatasetInfo
        As the dataset will have it.

    Raises
    ------
    ScenarioError
        The message says what each of ours lacks.
    """
    if not _suited(info)[0]:
        raise ScenarioError(
            f"{info.case}: {_nobody(info)}. {HOW_TO_BE_TAKEN}; frames alone: `rvbench render`. "
            "Nothing was rendered"
        )


def _suited(info: DatasetInfo, asked: Sequence[str] = ()) -> tuple[list[Contender], list[str]]:
    streams = [stream.name for stream in info.streams]
    return contenders(streams, chain_named(info.chain).pipelines, asked)


def _nobody(info: DatasetInfo) -> str:
    streams = [stream.name for stream in info.streams]
    return (
        f"expected frames that some pipeline takes, got {', '.join(streams)}: "
        f"{what_ours_lack(streams)}"
    )


def _tell_of_older(folder: Path, now: Collection[str]) -> None:
    """Say on stderr which estimates are of an earlier run, as of a pipeline that broke since."""
    for label in spoken_variants(folder):
        if label not in now:
            plain_console(stderr=True).print(
                f"not of this run: {estimates_path(folder, 0, label)}; no pipeline {label} ran "
                "now, and what it said earlier is still scored: delete the file to leave it out",
                soft_wrap=True,
                highlight=False,
            )


def tell_of(remarks: Sequence[str]) -> None:
    """Say on stderr what is wrong with installed pipelines."""
    console = plain_console(stderr=True)
    for remark in remarks:
        console.print(f"left out: {printable(remark)}", soft_wrap=True, highlight=False)


def estimate_dataset(
    folder: Path,
    asked: Sequence[str] = (),
    limit_s: float | None = None,
    workers: int = 1,
) -> list[Path]:
    """Estimate every frame of a dataset as run 0; only its public half is read.

    Parameters
    ----------
    folder : Path
    asked : sequence of str
        Labels or names of pipelines, such as ``best``; all unless given.
    limit_s : float, optional, s
        Most that a frame may take; see ``bench.estimating.guard``.
    workers : int
        Processes for what the chain tries beside the run itself.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    DatasetError
        If the public half is missing or of another version, or a frame is missing or truncated.
    ScenarioError
        If a pipeline asked for is not there.
    """
    dataset = open_dataset(folder)
    chosen = taking_part(dataset, asked)
    files = estimate_run(
        folder, 0, dataset.frames(), dataset.onboard, chosen, len(dataset.entries), limit_s
    )
    if not asked:
        _tell_of_older(folder, {path.stem for path in files})
    trials = chain_named(dataset.info.chain).trials
    if trials is None or not any(each.is_ours for each in chosen):
        return files
    return [*files, *trials(dataset, workers)]
