"""What is timed: whole commands of rvbench, each with a count of the things it does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

EFFICIENT_SUITE, EFFICIENT_RENDER = 0.95, 0.9
DATASET = """\
frames = {frames}
suns_per_pose = {suns}

[[target]]
spacecraft = "xmm"

[[target]]
spacecraft = "hispasat"
range_m = [40.0, 90.0]

[[camera]]
preset = "chaser_fixed"
width = {width}
"""
SUNS_A_POSE = 5
SUNS_AT_45_DEG = 22


@dataclass(frozen=True)
class Work:
    """A command that does so many things.

    Attributes
    ----------
    name : str
    things : str
        What is counted.
    count : int
        Of them in one command.
    arguments : callable of (Path, int) to list of str
        The command's, from a folder within the shared one, empty, and the number of workers.
    prepare : callable of Path to list of list of str
        Commands that are run beforehand and not timed, from the folder that all share.
    target : float or None
        The efficiency from one worker to two that is wanted; None where workers cannot be chosen.
    """

    name: str
    things: str
    count: int
    arguments: Callable[[Path, int], list[str]]
    prepare: Callable[[Path], list[list[str]]] = lambda shared: []
    target: float | None = None


def works(size: float) -> list[Work]:
    """Return what is timed.

    Parameters
    ----------
    size : float
        1 for some twenty seconds of one core a command; start-up, two to four seconds, is counted.
    """
    runs, poses, images, pairs = (max(2, round(n * size)) for n in (2, 30, 60, 40))
    return [
        Work(
            "a suite, pesce2019",
            "runs",
            2 * 5 * runs,  # two variants, five cases
            lambda folder, workers: [
                *("suite", "pesce2019", "--parts", "table6", "--runs", f"{runs}", "--seeds"),
                *(f"{runs}", "--paper-runs", f"{runs}", "--duration-s", "300"),
                *("--workers", f"{workers}", "--out", f"{folder / 'suite'}"),
            ],
            target=EFFICIENT_SUITE,
        ),
        Work(
            "a random dataset, 512 px",
            "frames",
            SUNS_A_POSE * poses,
            lambda folder, workers: [
                *("dataset", f"{folder.parent / 'drawn.toml'}", "--workers", f"{workers}"),
                *("--out", f"{folder / 'dataset'}"),
            ],
            prepare=lambda shared: _drawn(shared, SUNS_A_POSE * poses, 512),
            target=EFFICIENT_RENDER,
        ),
        Work(
            "a sequence, 512 px",
            "frames",
            images,
            lambda folder, workers: [
                *("render", "xmm-tumble", "--width", "512", "--spp", "64", "--rate-hz", "1"),
                *("--span-s", "0", f"{images - 1}", "--threads", f"{workers}"),
                *("--store", f"{folder / 'store'}", "--out", f"{folder / 'frames'}"),
            ],
            target=EFFICIENT_RENDER,
        ),
        Work(
            "a sweep, 512 px",
            "Suns",
            SUNS_AT_45_DEG,
            lambda folder, workers: [
                *("sweep", "maxar-approach", "--range-m", "2.5", "--sun-step-deg", "45"),
                *("--width", "512", "--spp", "16", "--draws", "1", "--threads", f"{workers}"),
                *("--store", f"{folder / 'store'}", "--out", f"{folder / 'sweep'}"),
            ],
            target=EFFICIENT_RENDER,
        ),
        Work(
            "estimates of pairs, 512 px",
            "pairs",
            pairs,
            lambda folder, workers: ["estimate", f"{folder.parent / 'pairs'}"],
            prepare=lambda shared: _approach(shared, pairs),
        ),
        Work(
            "an export as BOP",
            "images",
            2 * pairs,
            lambda folder, workers: [
                *("export", f"{folder.parent / 'pairs'}", "--as", "bop"),
                *("--out", f"{folder / 'bop'}"),
            ],
            prepare=lambda shared: _approach(shared, pairs),
        ),
    ]


def _approach(shared: Path, pairs: int) -> list[list[str]]:
    if (shared / "pairs").exists():
        return []
    return [
        [
            *("render", "maxar-approach", "--width", "512", "--spp", "1", "--rate-hz", "1"),
            *("--span-s", "200", f"{199 + pairs}", "--store", f"{shared / 'store'}"),
            *("--out", f"{shared / 'pairs'}"),
        ]
    ]


def _drawn(shared: Path, frames: int, width: int) -> list[list[str]]:
    text = DATASET.format(frames=frames, suns=SUNS_A_POSE, width=width)
    (shared / "drawn.toml").write_text(f'name = "drawn"\n{text}')
    return []
