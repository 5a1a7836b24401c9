"""More runs over the same light: another detector seed and another prior, nothing rendered.

The frames of a run are exposed anew from the radiance store and never written. A run whose
dataset and settings are those of its last time, and whose files are whole, is not done again.
"""

from __future__ import annotations

import json
from pathlib import Path

from bench.estimating.contenders import Contender
from bench.estimating.estimation import taking_part
from bench.estimating.run_times import NotedTimes
from bench.estimating.runner import estimate_run
from bench.estimating.runs import (
    estimates_path,
    read_stamp,
    run_folder,
    stamp_path,
)
from models.atomic_file import sweep_scratch, write_text
from models.dataset.dataset import Dataset, open_dataset
from models.dataset.estimates_file import read_estimates
from models.dataset.onboard_files import onboard_texts
from models.errors import DatasetError, RvbenchError
from models.reading.regular_file import holds_text


def repeat_runs(folder: Path, runs: int) -> list[int]:
    """Estimate runs 1 to ``runs`` - 1 of a rendered dataset, those that are not done.

    Returns
    -------
    list of int
        The runs done now.

    Raises
    ------
    DatasetError
        If the light of a frame has left the radiance store.
    """
    dataset = open_dataset(folder)
    chosen = _who_spoke(dataset)
    left = [number for number in range(1, runs) if not _is_done(dataset, number, chosen)]
    for number in left:
        _repeat(dataset, number, chosen)
    return left


def runs_left(folder: Path, runs: int) -> list[int]:
    """Return the numbers of the runs from 1 to ``runs`` - 1 that are not done."""
    if runs == 1:
        return []
    try:
        dataset = open_dataset(folder)
        chosen = _who_spoke(dataset)
    except RvbenchError:
        return list(range(1, runs))
    return [number for number in range(1, runs) if not _is_done(dataset, number, chosen)]


def _who_spoke(dataset: Dataset) -> list[Contender]:
    """Return who takes part and was made for run 0: a pipeline that could not be is left out."""
    every = taking_part(dataset, tell=False)  # run 0 has told
    spoke = [each for each in every if estimates_path(dataset.folder, 0, each.label).is_file()]
    return spoke or every


def _is_done(dataset: Dataset, number: int, chosen: list[Contender]) -> bool:
    """Tell whether a run has whole estimates of this very dataset with today's settings."""
    folder = dataset.folder
    if read_stamp(folder, number) != _stamp(dataset, chosen):
        return False
    try:
        said = [read_estimates(estimates_path(folder, number, each.label)) for each in chosen]
    except DatasetError:
        return False
    return all([estimate.frame for estimate in own] == dataset.indices for own in said)


def _repeat(dataset: Dataset, number: int, chosen: list[Contender]) -> None:
    from renders.batches.replay import exposed_frames  # estimating alone loads no renders

    folder = dataset.folder
    onboard, frames = exposed_frames(folder, number)
    home = run_folder(folder, number)
    sweep_scratch(home)
    for name, text in onboard_texts(onboard).items():
        if not holds_text(folder / name, text):
            write_text(home / name, text)
    noted = NotedTimes(frames)
    estimate_run(folder, number, noted, onboard, chosen, len(dataset.entries))
    noted.write(dataset, home)
    write_text(stamp_path(folder, number), json.dumps(_stamp(dataset, chosen), indent=1) + "\n")


def _stamp(dataset: Dataset, chosen: list[Contender]) -> dict[str, str]:
    settings = {f"settings_{each.label}": each.settings for each in chosen}
    return {"dataset": dataset.fingerprint(), **settings}
