"""More runs over the same light: another detector seed and another prior, nothing rendered.

The frames of a run are exposed anew from the radiance store and never written. A run whose
dataset and settings are those of its last time, and whose files are whole, is not done again.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

from bench.estimating.estimation import estimate_run
from bench.estimating.runs import (
    dataset_fingerprint,
    estimates_path,
    read_stamp,
    run_folder,
    stamp_path,
)
from models.atomic_file import write_text
from models.dataset.dataset import prior_to_toml, read_frame_entries
from models.dataset.estimates_file import read_estimates
from models.errors import DatasetError
from pipelines.chaser_fixed.options import VARIANTS, options_for


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
    done_now = runs_left(folder, runs)
    for number in done_now:
        _repeat(folder, number)
    return done_now


def runs_left(folder: Path, runs: int) -> list[int]:
    """Return the numbers of the runs from 1 to ``runs`` - 1 that are not done."""
    return [number for number in range(1, runs) if not is_done(folder, number)]


def is_done(folder: Path, number: int) -> bool:
    """Tell whether a run has whole estimates of this very dataset with today's settings."""
    if read_stamp(folder, number) != _stamp(folder):
        return False
    frames = [entry.index for entry in read_frame_entries(folder)]
    try:
        said = [read_estimates(estimates_path(folder, number, variant)) for variant in VARIANTS]
    except DatasetError:
        return False
    return all([estimate.frame for estimate in estimates] == frames for estimates in said)


def _repeat(folder: Path, number: int) -> None:
    from renders.batches.replay import (
        exposed_frames,  # here, so that estimating alone loads no renders
    )

    knowledge, frames = exposed_frames(folder, number)
    home = run_folder(folder, number)
    write_text(home / "prior.toml", prior_to_toml(knowledge))
    write_text(home / "camera.toml", knowledge.camera.to_toml())
    estimate_run(folder, number, frames, knowledge, len(read_frame_entries(folder)))
    write_text(stamp_path(folder, number), json.dumps(_stamp(folder), indent=1) + "\n")


def _stamp(folder: Path) -> dict[str, str]:
    settings = {
        f"settings_{variant}": hashlib.sha256(repr(options_for(variant)).encode()).hexdigest()
        for variant in VARIANTS
    }
    return {"dataset": dataset_fingerprint(folder), **settings}
