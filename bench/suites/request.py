"""What can be asked of a suite, and what it hands back."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.runners.chunks import Chunk
from models.errors import ScenarioError

SIZES = (
    "runs", "acquisitions", "seeds", "duration_s", "paper_runs", "rate_hz", "width", "bracket",
)  # fmt: skip


@dataclass(frozen=True)
class SuiteRequest:
    """A suite, where it goes, and how much of it.

    Attributes
    ----------
    name : str
    out : Path
    workers : int
    parts : tuple of str
        Empty for all.
    quick : bool
        A small version of everything, to see it work.
    runs, acquisitions, seeds : int, optional
        Instead of the suite's own sizes.
    paper_runs : int, optional
        Most runs and acquisitions of a case by the paper's own algorithms.
    duration_s : float, optional, s
    rate_hz : float, optional, Hz
        Of frames, where frames are rendered.
    width : int, optional, px
        Of them.
    bracket : tuple of float, optional
        Further exposures of each image, as multiples of the metered one.
    store : Path, optional
        Where rendered light is kept.
    store_budget_gb : float, optional
    seed : int
    chunk : Chunk, optional
        Do this share of the units, and leave the results to who has them all.
    """

    name: str
    out: Path
    workers: int
    parts: tuple[str, ...] = ()
    quick: bool = False
    runs: int | None = None
    acquisitions: int | None = None
    seeds: int | None = None
    paper_runs: int | None = None
    duration_s: float | None = None
    rate_hz: float | None = None
    width: int | None = None
    bracket: tuple[float, ...] | None = None
    store: Path | None = None
    store_budget_gb: float | None = None
    seed: int = 0
    chunk: Chunk | None = None

    def sizes(self, *own: str) -> dict[str, Any]:
        """Return the sizes that were typed.

        Parameters
        ----------
        *own : str
            Those that the suite has.

        Raises
        ------
        ScenarioError
            If one is of another suite.
        """
        typed = {name: each for name in SIZES if (each := getattr(self, name)) is not None}
        for name, value in typed.items():
            if name not in own:
                there = ", ".join(map(_option, own))
                raise ScenarioError(
                    f"expected no {_option(name)} with {self.name}, which has {there}; got {value}"
                )
        return typed


def _option(name: str) -> str:
    return f"--{name.replace('_', '-')}"


@dataclass(frozen=True)
class SuiteFiles:
    """What a suite wrote.

    Attributes
    ----------
    score, page : Path
    summary : list of list of str
        Rows for a terminal; the first is the head.
    """

    score: Path
    page: Path
    summary: list[list[str]]
