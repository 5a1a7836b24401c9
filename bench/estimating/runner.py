"""The one runner: whoever takes part, over frames, whoever's they are; written, and timed.

It knows nothing of ``renders``: it works where the truth is deleted and no renderer is installed.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from bench.estimating.contenders import Contender
from bench.estimating.guard import Guards
from bench.estimating.runs import estimates_path, run_folder, runtimes_path
from bench.estimating.time_limit import checked_limit
from bench.progress import frame_progress
from models.atomic_file import sweep_scratch
from models.dataset.estimates_file import write_estimates, write_runtimes
from models.estimate import Estimate
from models.frame import Frame
from models.onboard import OnboardKnowledge


def estimate_run(
    folder: Path,
    number: int,
    frames: Iterable[Frame],
    onboard: OnboardKnowledge,
    taking_part: list[Contender],
    count: int,
    limit_s: float | None = None,
) -> list[Path]:
    """Run everybody who takes part over frames; write what each said and how long it took.

    Parameters
    ----------
    folder : Path
        The dataset, or where estimates of other frames go.
    number : int
        The run; see ``bench.estimating.runs``.
    frames : iterable of Frame
        In time; each is read once, when its turn comes, and shown to all.
    onboard : OnboardKnowledge
    taking_part : list of Contender
    count : int
        How many frames there are, for the progress bar.
    limit_s : float, optional, s
        Most that a frame may take; see ``bench.estimating.guard``.

    Returns
    -------
    list of Path
        The estimates files.

    Raises
    ------
    DatasetError
        If a frame is missing or damaged, or somebody of the house lacks something on board.
    ScenarioError
        If the limit is not above zero.
    """
    title = "estimate" if number == 0 else f"estimate, run {number}"
    with (
        Guards(taking_part, onboard, checked_limit(limit_s)) as guarded,
        frame_progress(title, count) as advance,
    ):
        said: dict[str, list[Estimate]] = {label: [] for label in guarded}
        runtime_ms: dict[str, dict[int, float]] = {label: {} for label in guarded}
        for frame in frames:
            for label, pipeline in guarded.items():
                answer = pipeline.process(frame)
                said[label].append(answer.estimate)
                runtime_ms[label][frame.index] = answer.runtime_ms
            advance()
    sweep_scratch(run_folder(folder, number) / "estimates")
    for label in said:
        write_runtimes(runtimes_path(folder, number, label), runtime_ms[label])
        write_estimates(estimates_path(folder, number, label), said[label])
    return [estimates_path(folder, number, label) for label in said]
