"""A store keeps its budget: what was used longest ago goes, and nobody loses what he works on."""

import errno
import fcntl
import os
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.errors import ScenarioError, StorageError
from renders.store.budget import (
    DEFAULT_BUDGET_GB,
    GB,
    LOW_WATER,
    VARIABLE,
    budget_bytes,
    evict,
    stored,
)
from renders.store.claims import Claim, held, live_claims
from renders.store.radiance_store import RadianceStore, entry_key

KEYS = [entry_key({"number": number}) for number in range(40)]
NOISE = np.random.default_rng(1).uniform(0.1, 10.0, (32, 32)).astype(np.float32)
ENTRY_BYTES = 2400  # of one entry of it, within a tenth


def filled(folder: Path, count: int) -> RadianceStore:
    """Return a store without a limit whose entries were last used one second after another."""
    store = RadianceStore(folder, limit_bytes=float("inf"))
    store.write_all(dict.fromkeys(KEYS[:count], NOISE))
    for age, key in enumerate(reversed(KEYS[:count])):
        set_age(store, key, 1000 + age)
    return store


def set_age(store: RadianceStore, key: str, age_s: int) -> None:
    used_ns = os.stat(store.folder).st_mtime_ns - age_s * 10**9
    os.utime(store.path(key), ns=(used_ns, used_ns))


def there(store: RadianceStore) -> list[int]:
    return [number for number, key in enumerate(KEYS) if store.has(key)]


def size(store: RadianceStore) -> int:
    return sum(entry.cost_bytes for entry in stored(store.folder))


def claim(tmp_path: Path, needed: list[str], wanted: list[str]) -> Claim:
    return Claim("case", "S2", tmp_path / "out", frozenset(needed), frozenset(wanted))


def test_an_entry_has_the_size_that_the_limits_here_reckon_with(tmp_path: Path) -> None:
    assert size(filled(tmp_path, 10)) == pytest.approx(10 * ENTRY_BYTES, rel=0.1)


# Which entries go


def test_what_was_used_longest_ago_goes_first(tmp_path: Path) -> None:
    store = filled(tmp_path, 10)
    store.read(KEYS[0])  # the oldest: now the newest
    left, deleted = evict(store.folder, 4.5 * ENTRY_BYTES, (), ())
    assert there(store) == [0, 7, 8, 9]
    assert (left, deleted) == (size(store), 6)


def test_what_is_needed_stays_and_what_is_wanted_goes_last(tmp_path: Path) -> None:
    store = filled(tmp_path, 10)
    needed, wanted = KEYS[:2], KEYS[2:5]
    evict(store.folder, 5.5 * ENTRY_BYTES, needed, wanted)
    assert there(store) == [0, 1, 2, 3, 4]
    evict(store.folder, 3.5 * ENTRY_BYTES, needed, wanted)
    assert there(store) == [0, 1, 4]
    evict(store.folder, 0.0, needed, wanted)
    assert there(store) == [0, 1]


def test_what_a_dataset_holds_as_a_link_costs_nothing_and_stays(tmp_path: Path) -> None:
    store = filled(tmp_path / "store", 4)
    os.link(store.path(KEYS[0]), tmp_path / "in_a_dataset.exr")
    before = store.path(KEYS[0]).stat().st_mtime_ns
    assert size(store) == pytest.approx(3 * ENTRY_BYTES, rel=0.1)
    store.read(KEYS[0])
    assert store.path(KEYS[0]).stat().st_mtime_ns == before  # the dataset's file shows no change
    evict(store.folder, 0.0, (), ())
    assert there(store) == [0]


def test_only_entries_are_touched(tmp_path: Path) -> None:
    store = filled(tmp_path, 2)
    others = [store.folder / "note.txt", store.folder / "ab" / "note.txt", store.folder / "ab.exr"]
    for path in others:
        path.parent.mkdir(exist_ok=True)
        path.write_text("mine")
    evict(store.folder, 0.0, (), ())
    assert there(store) == []
    assert all(path.read_text() == "mine" for path in others)


# Writing within a budget


def test_a_store_that_is_written_to_keeps_its_budget(tmp_path: Path) -> None:
    limit = 10.5 * ENTRY_BYTES
    store = RadianceStore(tmp_path, limit_bytes=limit)
    for key in KEYS:
        store.write(key, NOISE)
        assert size(store) <= limit
    assert size(store) > 0.5 * LOW_WATER * limit
    assert there(store)[-1] == len(KEYS) - 1


def test_two_writers_keep_one_budget(tmp_path: Path) -> None:
    """Each counts what the other writes before the two of them could have overrun it."""
    limit = 12.5 * ENTRY_BYTES
    one, two = (RadianceStore(tmp_path, limit_bytes=limit) for _ in range(2))
    for mine, yours in zip(KEYS[::2], KEYS[1::2], strict=True):
        one.write(mine, NOISE)
        two.write(yours, NOISE)
        assert size(one) <= limit


def test_what_a_run_works_on_is_not_taken_from_it(tmp_path: Path) -> None:
    store = RadianceStore(tmp_path / "store", limit_bytes=4.5 * ENTRY_BYTES)
    with store.claimed(claim(tmp_path, [], KEYS)):
        for first in range(0, 30, 3):
            hand = KEYS[first : first + 3]
            store.room.take_in_hand(frozenset(hand))
            store.write(hand[0], NOISE)
            set_age(store, hand[0], 1_000_000)
            store.write(hand[1], NOISE)
            store.write(hand[2], NOISE)
            assert set(range(first, first + 3)) <= set(there(store))


def test_a_run_streams_past_what_it_has_done_and_keeps_what_is_to_come(tmp_path: Path) -> None:
    """Of its own light, that of later frames is spared; of a stranger's, none."""
    folder = tmp_path / "store"
    filled(folder, 6)
    store = RadianceStore(folder, limit_bytes=8.5 * ENTRY_BYTES)
    with store.claimed(claim(tmp_path, [], KEYS[3:20])):
        for number in range(10, 17):
            store.room.take_in_hand(frozenset(KEYS[number : number + 1]))
            store.write(KEYS[number], NOISE)
    assert {3, 4, 5} <= set(there(store))  # old, but to come
    assert not {0, 1, 2, 10} & set(there(store))
    assert 16 in there(store)
    assert size(store) <= 8.5 * ENTRY_BYTES


def test_what_a_live_run_needs_is_not_taken_by_another(tmp_path: Path) -> None:
    folder = tmp_path / "store"
    filled(folder, 6)
    other = RadianceStore(folder, limit_bytes=5.5 * ENTRY_BYTES)
    with held(folder, claim(tmp_path, KEYS[:3], [])):
        for key in KEYS[20:30]:
            other.write(key, NOISE)
        assert there(other)[:3] == [0, 1, 2]
    for key in KEYS[30:40]:
        other.write(key, NOISE)
    assert not {0, 1, 2} & set(there(other))


def test_light_that_must_stay_and_never_fits_is_told_at_the_first_frame(tmp_path: Path) -> None:
    store = RadianceStore(tmp_path / "store", limit_bytes=6 * ENTRY_BYTES)
    with (
        store.claimed(claim(tmp_path, KEYS, [])),
        pytest.raises(StorageError, match=r"about 9\.\de-05 GB.*--store-budget-gb 0\.0001"),
    ):
        store.write(KEYS[0], NOISE)
    assert store.read(KEYS[0]) is not None  # what is there is kept


def test_a_store_that_may_only_be_read_can_be_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = filled(tmp_path, 1)

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "utime", refuse)
    assert store.read(KEYS[0]) is not None


# The budget asked for


def test_the_budget_is_typed_or_in_the_environment_or_twenty_gb(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    assert budget_bytes(None) == DEFAULT_BUDGET_GB * GB == 20e9
    monkeypatch.setenv(VARIABLE, "0.5")
    assert budget_bytes(None) == 0.5e9
    assert budget_bytes(3.0) == 3e9
    monkeypatch.setenv(VARIABLE, "inf")
    assert budget_bytes(None) == float("inf")


@pytest.mark.parametrize("text", ["0", "-1", "nan", "much"])
def test_a_budget_that_is_none_is_told(monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    monkeypatch.setenv(VARIABLE, text)
    with pytest.raises(ScenarioError, match=rf"expected \${VARIABLE} to be .*got '{text}'"):
        budget_bytes(None)


def test_a_typed_budget_of_nothing_is_told() -> None:
    with pytest.raises(ScenarioError, match=r"expected --store-budget-gb .* got '0.0'"):
        budget_bytes(0.0)


# Claims


def test_a_claim_lives_as_long_as_it_is_held(tmp_path: Path) -> None:
    mine = claim(tmp_path, KEYS[:1], KEYS[1:2])
    assert live_claims(tmp_path) == []
    with held(tmp_path, mine) as path:
        assert [each.keys for each in live_claims(tmp_path)] == [frozenset(KEYS[:2])]
        assert live_claims(tmp_path, besides=path) == []
        with held(tmp_path, mine):  # a second run on the same dataset
            assert len(live_claims(tmp_path)) == 1
    assert live_claims(tmp_path) == []


def test_a_claim_is_asked_for_its_lock_as_nfs_wants_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """NFS locks a file for one alone only if it is open for writing, and says EBADF otherwise."""

    def flock(file: Any, operation: int) -> None:
        if operation & fcntl.LOCK_EX and fcntl.fcntl(file, fcntl.F_GETFL) & os.O_ACCMODE == 0:
            raise OSError(errno.EBADF, "no lock on what is only read")

    with held(tmp_path, claim(tmp_path, KEYS[:1], [])):
        pass
    monkeypatch.setattr("renders.store.claims.fcntl.flock", flock)
    assert live_claims(tmp_path) == []


def test_a_claim_that_is_damaged_is_passed_over(tmp_path: Path) -> None:
    with held(tmp_path, claim(tmp_path, KEYS[:1], [])) as path:
        path.write_text("{")
        assert live_claims(tmp_path) == []
    shutil.rmtree(tmp_path / "claims")
    assert live_claims(tmp_path) == []
