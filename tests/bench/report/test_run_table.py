"""What stands behind a cell: every run, or the worst of many, and which is the worst."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench.report.numbers import NONE
from bench.report.page import Page, write_page
from bench.report.parts import Section, TitledTable
from bench.report.run_table import MOST_ROWS, run_table, with_runs
from bench.report.table import Table

SIZES = st.lists(st.floats(0.0, 1e6) | st.just(np.nan), min_size=1, max_size=3 * MOST_ROWS)


@given(SIZES)
def test_the_worst_is_listed_and_marked_however_many_there_are(sizes):
    runs = run_table("some", "drawn", {"error, m": sizes})
    assert len(runs.rows) == min(len(sizes), MOST_ROWS)
    listed = [int(row[0]) for row in runs.rows]
    assert listed == sorted(set(listed))
    ranks = np.where(np.isnan(sizes), np.inf, sizes)
    others = np.delete(ranks, listed)
    if others.size:
        assert others.max() <= ranks[listed].min()
    if (place := runs.worst[1]) is not None:
        assert ranks[listed[place]] == ranks.max()
    else:
        assert len({*ranks[listed]}) == 1


def test_a_run_that_came_to_nothing_is_the_worst():
    runs = run_table("some", "drawn", {"error, m": [1.0, np.nan, 3.0], "lost": [0, 7, 0]})
    assert [row[1] for row in runs.rows] == ["1.00", NONE, "3.00"]
    assert runs.worst == (None, 1, 1)


def test_a_size_is_ranked_by_what_it_is_without_its_sign():
    assert run_table("some", "drawn", {"mean, m": [-5.0, 2.0]}).worst[1] == 0


def table() -> Table:
    return Table(["", "error", "why"], [["best", "1.0", ""], ["paper", NONE, "x"]], {}, {})


def test_only_what_has_runs_leads_to_them():
    runs, none = run_table("a", "d", {"e": [1.0]}), run_table("b", "d", {"e": []})
    led = with_runs(table(), {1: runs, 2: none})
    assert led.behind == {(0, 1): runs}
    assert with_runs(table(), [None, {2: runs}]).behind == {(1, 2): runs}
    assert (table().anchor, bool(led.anchor)) == ("", True)


@pytest.fixture
def page(tmp_path) -> str:
    runs = run_table("those of <best>", "seed 0", {"error, m": [1.0, 2.0, 1.5]})
    led = with_runs(table(), {1: runs})
    shown = [Section("one", tables=(TitledTable("one", led),))] * 2
    write_page(tmp_path / "p.html", Page("t", "h", "l", "best", [], "head", table(), after=shown))
    return (tmp_path / "p.html").read_text()


def test_each_cell_leads_to_runs_that_are_once_in_the_page_and_lead_back(page):
    links = re.findall(r'href="#(runs-[0-9a-f]+)"', page)
    assert len(links) == 2
    assert len(re.findall(f'id="{links[0]}"', page)) == 1
    back = re.findall(r'<a href="#(table-[0-9a-f]+)">back', page)
    assert len(back) == 1
    assert f'id="{back[0]}"' in page
    assert "those of &lt;best&gt;" in page
    assert page.count('class="worst"') == 1
