"""Shares of work: every piece in one of them, whoever asks, and none much dearer than another."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench.runners.chunks import Chunk, read_chunk, runs_in_order, shares
from models.errors import ScenarioError

COSTS = st.lists(st.floats(0.1, 100.0), max_size=40)


@given(COSTS, st.integers(1, 12))
def test_every_piece_is_in_one_share(costs: list[float], of: int) -> None:
    pieces = list(range(len(costs)))
    own = shares(pieces, of, costs, [""] * len(costs))
    assert len(own) == of
    assert sorted(piece for share in own for piece in share) == pieces
    assert all(share == sorted(share) for share in own)


@given(COSTS.filter(len), st.integers(1, 12))
def test_no_share_is_dearer_than_the_mean_and_one_piece(costs: list[float], of: int) -> None:
    """Graham 1969: a list schedule ends at most one piece after the mean load."""
    own = shares(range(len(costs)), of, costs, [""] * len(costs))
    dearest = max(sum(costs[piece] for piece in share) for share in own)
    assert dearest <= sum(costs) / of + max(costs) + 1e-9


def test_the_dearest_piece_does_not_come_last() -> None:
    """Given in the order of their names, the long one would come on top of half of the others."""
    assert shares("abcde", 2, [1.0, 1.0, 1.0, 1.0, 4.0], [""] * 5) == [["e"], ["a", "b", "c", "d"]]


def test_what_reads_the_same_stays_together() -> None:
    keys = ["", "frames", "", "frames", "", "frames"]
    own = shares("abcdef", 2, [1.0] * 6, keys)
    assert ["b", "d", "f"] in own
    assert sorted(map(len, own)) == [3, 3]


@given(st.integers(0, 60), st.integers(1, 12))
def test_runs_are_neighbours_and_equally_long(count: int, of: int) -> None:
    own = runs_in_order(range(count), of)
    assert [piece for share in own for piece in share] == list(range(count))
    assert len(own) == of
    assert max(map(len, own)) - min(map(len, own)) <= 1


def test_a_chunk_reads_as_it_is_written() -> None:
    assert read_chunk(str(Chunk(3, 16))) == Chunk(3, 16)


@pytest.mark.parametrize("text", ["", "3", "16/16", "-1/4", "1/0", "0/100001", "1/4/2", "a/b"])
def test_what_is_no_chunk_is_refused(text: str) -> None:
    with pytest.raises(ScenarioError, match="--chunk as K/N"):
        read_chunk(text)
