"""Verifying a store names every entry that is not as it was written, and no other."""

import os
from pathlib import Path

import numpy as np
import pytest

from renders.store.check import ANOTHERS_NAME, all_entries, damaged
from renders.store.claims import Claim, held
from renders.store.radiance_store import RadianceStore, entry_key
from renders.store.sealed_exr import CHANGED, CUT_SHORT, EARLIER, FIELD, HEADER_BYTES

KEYS = [entry_key({"number": number}) for number in range(12)]


@pytest.fixture
def store(tmp_path: Path) -> RadianceStore:
    store = RadianceStore(tmp_path / "store")
    rng = np.random.default_rng(7)
    store.write_all({key: rng.random((32, 48), dtype=np.float32) for key in KEYS})
    return store


def flip(path: Path, place: int) -> None:
    data = bytearray(path.read_bytes())
    data[place] ^= 0x10
    path.write_bytes(bytes(data))


def found(store: RadianceStore) -> dict[str, str]:
    entries = all_entries(store.folder)
    return {damage.path.stem: damage.reason for damage in damaged(store.folder, entries)}


def test_a_store_as_it_was_written_has_no_damage(store: RadianceStore) -> None:
    assert len(all_entries(store.folder)) == len(KEYS)
    assert found(store) == {}


def test_each_kind_of_damage_is_found_and_named(store: RadianceStore) -> None:
    pixels, header, cut, empty, moved, earlier = (store.path(key) for key in KEYS[:6])
    flip(pixels, len(pixels.read_bytes()) - 100)
    flip(header, header.read_bytes().index(b"screenWindowWidth"))
    cut.write_bytes(cut.read_bytes()[:-1])
    empty.write_bytes(b"")
    moved.write_bytes(store.path(KEYS[7]).read_bytes())
    earlier.write_bytes(b"v/1\x01" + b"rvbench_sha256\0string\0" + bytes(500))
    assert found(store) == {
        KEYS[0]: CHANGED,
        KEYS[1]: CHANGED,
        KEYS[2]: CHANGED,
        KEYS[3]: CUT_SHORT,
        KEYS[4]: ANOTHERS_NAME,
        KEYS[5]: EARLIER,
    }


def test_every_flipped_byte_of_an_entry_is_found(store: RadianceStore) -> None:
    path = store.path(KEYS[0])
    data = path.read_bytes()
    assert data.index(FIELD) < HEADER_BYTES
    (entry,) = (entry for entry in all_entries(store.folder) if entry.key == KEYS[0])
    for place in range(0, len(data), 7):
        flip(path, place)
        assert len(damaged(store.folder, [entry])) == 1, place
        path.write_bytes(data)
    assert damaged(store.folder, [entry]) == []


def test_what_is_evicted_meanwhile_is_no_damage(store: RadianceStore) -> None:
    entries = all_entries(store.folder)
    store.path(KEYS[2]).unlink()
    assert damaged(store.folder, entries) == []


def test_verifying_is_no_use_of_an_entry(store: RadianceStore) -> None:
    before = [entry.used_ns for entry in all_entries(store.folder)]
    assert found(store) == {}
    assert [entry.used_ns for entry in all_entries(store.folder)] == before


def test_damage_is_deleted_where_a_dataset_holds_it_too(
    store: RadianceStore, tmp_path: Path
) -> None:
    """A link shows the same bytes: left there, the dataset's truth would stay damaged."""
    home = tmp_path / "out" / "truth" / "geometry"
    home.mkdir(parents=True)
    linked, whole = home / "000000_850.exr", home / "000001_850.exr"
    os.link(store.path(KEYS[0]), linked)
    os.link(store.path(KEYS[1]), whole)
    with held(store.folder, Claim("case", "S2", tmp_path / "out", frozenset(), frozenset(KEYS))):
        flip(store.path(KEYS[0]), 900)
        (damage,) = damaged(store.folder, all_entries(store.folder))
    assert damage.copies == (linked.resolve(),)
    damage.delete()
    assert not linked.exists()
    assert whole.exists()
    assert found(store) == {}
    assert len(all_entries(store.folder)) == len(KEYS) - 1
