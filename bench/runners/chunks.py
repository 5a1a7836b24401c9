"""A chunk: a deterministic share of a command's work, K of N, whoever does it and wherever."""

from __future__ import annotations

import heapq
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeVar

from models.errors import ScenarioError
from models.reading.shown import shown

Piece = TypeVar("Piece")
MOST_CHUNKS = 100_000
WRITTEN = re.compile(r"(\d{1,6})/(\d{1,6})")


@dataclass(frozen=True)
class Chunk:
    """One share of several.

    Attributes
    ----------
    number : int
        From 0.
    of : int
    """

    number: int
    of: int

    def __str__(self) -> str:
        return f"{self.number}/{self.of}"


def read_chunk(text: str) -> Chunk:
    """Read ``K/N``, K from 0 to N - 1.

    Raises
    ------
    ScenarioError
        If it is none.
    """
    found = WRITTEN.fullmatch(text)
    number, of = map(int, found.groups()) if found else (0, 0)
    if not (found and number < of <= MOST_CHUNKS):
        raise ScenarioError(
            f"expected --chunk as K/N, with K from 0 to N - 1 and N at most {MOST_CHUNKS}, got "
            f"{shown(text)}"
        )
    return Chunk(number, of)


def shares(
    pieces: Sequence[Piece], of: int, costs: Sequence[float], keys: Sequence[str]
) -> list[list[Piece]]:
    """Return what each chunk does: every piece in one of them, in the order that was given.

    The dearest is given first, each to the chunk that has least to do; so it depends on the pieces
    alone, not on what of them is done.

    Parameters
    ----------
    pieces : sequence
    of : int
        Chunks; some stay empty if there are fewer things to share.
    costs : sequence of float
        Of each piece, in whatever unit.
    keys : sequence of str
        Pieces of one key go to one chunk; an empty key is nobody else's.
    """
    together: dict[tuple[str, int], list[int]] = {}
    for place, key in enumerate(keys):
        together.setdefault((key, -1) if key else ("", place), []).append(place)
    priced = sorted(
        ((sum(costs[place] for place in places), places) for places in together.values()),
        key=lambda each: (-each[0], each[1][0]),
    )
    loads = [(0.0, number) for number in range(of)]
    own: list[list[int]] = [[] for _ in range(of)]
    for cost, places in priced:
        load, number = heapq.heappop(loads)
        own[number] += places
        heapq.heappush(loads, (load + cost, number))
    return [[pieces[place] for place in sorted(places)] for places in own]


def runs_in_order(pieces: Sequence[Piece], of: int) -> list[list[Piece]]:
    """Return pieces cut into as many runs of neighbours, equally long but for one piece."""
    ends = [round(number * len(pieces) / of) for number in range(of + 1)]
    return [list(pieces[a:b]) for a, b in pairwise(ends)]
