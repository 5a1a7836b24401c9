"""Run the pipeline for an uncooperative target on a dataset of single images, every variant.

Only the public half is read. This module knows nothing of ``renders``: it works where the truth is
deleted and no renderer is installed.
"""

from __future__ import annotations

from pathlib import Path
from time import perf_counter

from models.dataset.image_dataset import (
    read_image_frames,
    read_image_info,
    read_uncooperative_knowledge,
)
from models.dataset.navigation_estimates_file import write_navigation_estimates
from models.uncooperative import NavigationEstimate

from bench.estimating.runs import estimates_path, run_folder, runtimes_path
from bench.progress import frame_progress
from models.atomic_file import sweep_scratch
from models.dataset.dataset import read_frame_entries
from models.dataset.estimates_file import write_runtimes
from models.errors import DatasetError
from pipelines.uncooperative.image_pose_finder import ImagePoseFinder
from pipelines.uncooperative.knowledge import UncooperativeKnowledge
from pipelines.uncooperative.pipeline import VARIANTS, Uncooperative, options_for


def pipeline_of(knowledge: UncooperativeKnowledge, variant: str) -> Uncooperative:
    """Return the pipeline of one variant, with no state yet: it acquires the target first."""
    options = options_for(variant)
    return Uncooperative(knowledge, options, images=ImagePoseFinder(knowledge, options))


def estimate_image_dataset(folder: Path) -> list[Path]:
    """Estimate every frame of a dataset of single images with every variant, without a prior.

    Returns
    -------
    list of Path
        The estimates files written.

    Raises
    ------
    DatasetError
        If the public half is missing or of another version, or a frame is missing or truncated.
    """
    read_image_info(folder)
    knowledge = read_uncooperative_knowledge(folder)
    count = len(read_frame_entries(folder))
    if count == 0:
        raise DatasetError(f"{folder}/frames.csv: expected at least one frame, found none")
    pipelines = {variant: pipeline_of(knowledge, variant) for variant in VARIANTS}
    said: dict[str, list[NavigationEstimate]] = {variant: [] for variant in VARIANTS}
    runtime_ms: dict[str, dict[int, float]] = {variant: {} for variant in VARIANTS}
    with frame_progress("estimate", count) as advance:
        for frame in read_image_frames(folder):
            for variant, pipeline in pipelines.items():
                began = perf_counter()
                said[variant].append(pipeline.process(frame))
                runtime_ms[variant][frame.index] = 1e3 * (perf_counter() - began)
            advance()
    sweep_scratch(run_folder(folder, 0) / "estimates")
    for variant in VARIANTS:
        write_runtimes(runtimes_path(folder, 0, variant), runtime_ms[variant])
        write_navigation_estimates(estimates_path(folder, 0, variant), said[variant])
    return [estimates_path(folder, 0, variant) for variant in VARIANTS]
