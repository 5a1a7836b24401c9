"""Run the chaser-fixed pipeline on a dataset, every variant.

Only the public half is read. This module knows nothing of ``renders``: it works where the truth is
deleted and no renderer is installed.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from time import perf_counter

from bench.estimating.runs import estimates_path, run_folder, runtimes_path
from bench.progress import frame_progress
from models.atomic_file import sweep_scratch
from models.dataset.dataset import read_frame_entries, read_frames, read_info, read_knowledge
from models.dataset.estimates_file import write_estimates, write_runtimes
from models.errors import DatasetError
from models.estimate import Estimate
from models.frame import Frame
from pipelines.chaser_fixed.knowledge import FlightKnowledge
from pipelines.chaser_fixed.pipeline import VARIANTS, ChaserFixed, options_for


def estimate_dataset(folder: Path) -> list[Path]:
    """Estimate every frame of a dataset with every variant, as run 0.

    Returns
    -------
    list of Path
        The estimates files written.

    Raises
    ------
    DatasetError
        If the public half is missing or of another version, or a frame is missing or truncated.
    """
    read_info(folder)
    knowledge = read_knowledge(folder)
    count = len(read_frame_entries(folder))
    if count == 0:
        raise DatasetError(f"{folder}/frames.csv: expected at least one frame, found none")
    return estimate_run(folder, 0, read_frames(folder), knowledge, count)


def estimate_run(
    folder: Path, number: int, frames: Iterable[Frame], knowledge: FlightKnowledge, count: int
) -> list[Path]:
    """Run every variant over frames; write what each said and how long it took.

    Parameters
    ----------
    folder : Path
        The dataset.
    number : int
        The run; see ``bench.estimating.runs``.
    frames : iterable of Frame
        In time; each is read once, when its turn comes, and shown to all variants.
    knowledge : FlightKnowledge
    count : int
        How many frames there are, for the progress bar.

    Returns
    -------
    list of Path
        The estimates files.
    """
    pipelines = {variant: ChaserFixed(knowledge, options_for(variant)) for variant in VARIANTS}
    said: dict[str, list[Estimate]] = {variant: [] for variant in VARIANTS}
    runtime_ms: dict[str, dict[int, float]] = {variant: {} for variant in VARIANTS}
    with frame_progress("estimate" if number == 0 else f"estimate, run {number}", count) as advance:
        for frame in frames:
            for variant, pipeline in pipelines.items():
                began = perf_counter()
                said[variant].append(pipeline.process(frame))
                runtime_ms[variant][frame.index] = 1e3 * (perf_counter() - began)
            advance()
    sweep_scratch(run_folder(folder, number) / "estimates")
    for variant in VARIANTS:
        write_runtimes(runtimes_path(folder, number, variant), runtime_ms[variant])
        write_estimates(estimates_path(folder, number, variant), said[variant])
    return [estimates_path(folder, number, variant) for variant in VARIANTS]
