"""A campaign that was ended goes on at the next seed, and its table is of all trials."""

from __future__ import annotations

import time

import pytest

from bench.campaign import __main__, kills, places
from bench.campaign.hostile.running import trials
from bench.campaign.hostile.trial import NAMES
from bench.campaign.journal import Journal, Tried, code_version
from bench.campaign.kills import try_kills
from bench.campaign.places import Skipped, try_places
from models.errors import RvbenchError, StorageError


def test_what_was_tried_is_kept_with_the_codes_version(tmp_path):
    Journal(tmp_path / "a.jsonl").keep(Tried("GLB", 3, "fault", "traceback"))
    Journal(tmp_path / "a.jsonl").keep(Tried("GLB", 4, "refused"))
    journal = Journal(tmp_path / "a.jsonl")
    assert [(each.seed, each.ended) for each in journal.tried] == [(3, "fault"), (4, "refused")]
    assert {each.code for each in journal.tried} == {code_version()}
    assert journal.left([("GLB", 3), ("GLB", 5), ("OBJ", 3)]) == [("GLB", 5), ("OBJ", 3)]


def test_a_line_that_was_cut_is_tried_again(tmp_path):
    path = tmp_path / "a.jsonl"
    Journal(path).keep(Tried("GLB", 3, "refused"))
    whole = path.read_text()
    path.write_text(whole + whole[: len(whole) // 2])
    journal = Journal(path)
    assert journal.seen == {("GLB", 3)}
    journal.keep(Tried("GLB", 4, "refused"))
    assert Journal(path).seen == {("GLB", 3), ("GLB", 4)}


def test_a_file_that_is_none_is_refused(tmp_path):
    (tmp_path / "a.jsonl").write_text('{"kind": "GLB"}\n')
    with pytest.raises(StorageError, match="expected what a campaign has tried"):
        Journal(tmp_path / "a.jsonl")


@pytest.mark.parametrize("full", [True, False])
def test_every_kind_is_tried_once_before_any_is_tried_twice(full):
    asked = trials(2000, 7, None, full=full)
    kinds = {name for name, _ in asked}
    assert {name for name, _ in asked[: len(kinds)]} == kinds
    assert (kinds == set(NAMES)) == full
    assert len(set(asked)) == len(asked)
    assert len(asked) == pytest.approx(2000, abs=len(kinds))  # of rounding a kind's share


@pytest.fixture
def killed(monkeypatch):
    """Two kills whatever the verb and the seed."""
    asked = []

    def try_one(self, verb, seed):
        asked.append((verb, seed))
        return 2, ""

    monkeypatch.setattr(kills.Kills, "try_one", try_one)
    return asked


def test_kills_are_counted_and_those_of_before_left_out(tmp_path, killed):
    seen = {("run", 0), ("export", 1)}
    tried = [*try_kills(["run", "export"], 5, 0, tmp_path, tmp_path, seen, None)]
    assert killed == [("export", 0), ("run", 1), ("run", 2)]
    assert sum(each.kills for each in tried) == 6
    assert {each.ended for each in tried} == {"stood"}


def test_one_trial_is_made_however_late_it_is(tmp_path, killed):
    late = time.monotonic() - 1.0
    assert len([*try_kills(["run"], 9, 0, tmp_path, tmp_path, set(), late)]) == 1


def test_a_place_that_cannot_be_made_is_told_and_not_counted(tmp_path, monkeypatch, capsys):
    def skips(*_):
        raise Skipped("no small disk")

    monkeypatch.setitem(places.PLACES, "full disk", skips)
    monkeypatch.setitem(places.PLACES, "clock", lambda *_: "a fault")
    tried = [*try_places(["full disk", "clock"], 2, 0, tmp_path, tmp_path, set(), None)]
    assert [(each.kind, each.seed, each.fault) for each in tried] == [
        ("clock", 0, "a fault"),
        ("clock", 1, "a fault"),
    ]
    assert capsys.readouterr().err == "full disk: skipped: no small disk\n"
    assert [*try_places(["full disk"], 2, 0, tmp_path, tmp_path, set(), None)] == []


def test_the_same_command_goes_on_and_only_a_fault_of_now_fails(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(__main__, "make_grounds", lambda *_, **__: None)
    said = iter(["a fault", "", ""])
    monkeypatch.setitem(places.PLACES, "clock", lambda *_: next(said))

    def campaign(count):
        return __main__.Campaign("places", count, only="clock", out=tmp_path).run()

    assert campaign(1) == 1
    assert campaign(3) == 0
    table = capsys.readouterr().out
    assert "2 tried now, 0 faults" in table
    assert [each.seed for each in Journal(tmp_path / "places.jsonl").tried] == [0, 1, 2]
    assert campaign(3) == 0
    assert "0 tried now" in capsys.readouterr().out


def test_a_kind_that_is_none_is_refused(tmp_path):
    with pytest.raises(RvbenchError, match="expected --only one of full disk"):
        __main__.Campaign("places", only="no such place", out=tmp_path).run()
