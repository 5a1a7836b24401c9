"""The one runner: whoever takes part, over frames, whoever's they are; written, and timed.

It knows nothing of ``renders``: it works where the truth is deleted and no renderer is installed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from bench.estimating.contenders import Contender
from bench.estimating.guard import Guards, printable
from bench.estimating.runs import estimates_path, run_folder, runtimes_path
from bench.estimating.time_limit import checked_limit
from bench.progress import frame_progress
from models.atomic_file import sweep_scratch
from models.dataset.estimates_file import write_estimates, write_runtimes
from models.estimate import Estimate
from models.frame import Frame
from models.onboard import OnboardKnowledge
from models.plain_console import plain_console

MOST_TOLD = 400  # characters of a reason; the file has all of it


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
        failed: dict[str, list[Estimate]] = {label: [] for label in guarded}
        for frame in frames:
            for label, pipeline in guarded.items():
                answer = pipeline.process(frame)
                said[label].append(answer.estimate)
                runtime_ms[label][frame.index] = answer.runtime_ms
                if answer.failed:
                    failed[label].append(answer.estimate)
            advance()
    sweep_scratch(run_folder(folder, number) / "estimates")
    for label in said:
        write_runtimes(runtimes_path(folder, number, label), runtime_ms[label])
        write_estimates(estimates_path(folder, number, label), said[label])
    tell_failures(failed, {label: len(each) for label, each in said.items()}, number)
    return [estimates_path(folder, number, label) for label in said]


def tell_failures(
    failed: Mapping[str, Sequence[Estimate]], frames: Mapping[str, int], number: int
) -> None:
    """Say on stderr of each pipeline that failed at frames, at how many, and why at the first.

    Parameters
    ----------
    failed : mapping of str to sequence of Estimate
        The frames lost by each pipeline that raised, hung or said what cannot be, by its label.
    frames : mapping of str to int
        Those that each was given.
    number : int
        Of the run.
    """
    console = plain_console(stderr=True)
    for label, lost in failed.items():
        if lost:
            run = f" in run {number}" if number else ""
            console.print(
                f"lost: pipeline {label} failed at {len(lost)} of {frames[label]} frames{run}; at "
                f"frame {lost[0].frame}: {printable(lost[0].reason or '')[:MOST_TOLD]}",
                soft_wrap=True,
                highlight=False,
            )
