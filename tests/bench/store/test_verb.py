"""``rvbench store``: what it prints, what it deletes, and how it exits."""

import errno
import io
import os
import re
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from bench.cli import main
from bench.store.stored_light import age_text, holdings_table, size_text
from models.errors import StorageError
from renders.store.claims import Claim, held
from renders.store.radiance_store import RadianceStore, entry_key

KEYS = [entry_key({"number": number}) for number in range(10)]
AN_HOUR_S = 3600


@pytest.fixture
def store(tmp_path: Path) -> RadianceStore:
    """Ten entries, used an hour after each other; the first four are of one dataset."""
    store = RadianceStore(tmp_path / "store")
    store.open_for_writing()
    rng = np.random.default_rng(3)
    store.write_all({key: rng.random((48, 48), dtype=np.float32) for key in KEYS})
    now_s = store.folder.stat().st_mtime
    for age, key in enumerate(reversed(KEYS), start=3):
        os.utime(store.path(key), (now_s, now_s - age * AN_HOUR_S))
    (tmp_path / "out").mkdir()
    with held(store.folder, claim_of(tmp_path / "out", 0, 4)):
        pass
    return store


def claim_of(dataset: Path, first: int, last: int) -> Claim:
    return Claim("maxar-demo", "S4", dataset, frozenset(), frozenset(KEYS[first:last]))


def flip(path: Path) -> None:
    data = bytearray(path.read_bytes())
    data[-100] ^= 1
    path.write_bytes(bytes(data))


def said(capsys: pytest.CaptureFixture[str], *typed: object) -> tuple[int, str]:
    capsys.readouterr()
    code = main(["store", *map(str, typed)])
    return code, capsys.readouterr().out


def squeezed(text: str) -> str:
    return re.sub(r"\s+", " ", text)


def test_each_action_has_its_help(capsys) -> None:
    for action in ("list", "verify", "prune"):
        code, told = said(capsys, action, "--help")
        assert code == 0
        assert told.startswith(f"usage: rvbench store {action}")
    code, told = said(capsys, "--help")
    assert code == 0
    assert "rvbench store prune --to-gb 5" in told


def test_list_tells_whose_light_how_much_and_when_used(store, tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    with held(store.folder, claim_of(tmp_path / "gone", 2, 6)):
        code, told = said(capsys, "list", "--store", store.folder)
    told = squeezed(told)
    each = store.path(KEYS[0]).stat().st_size
    assert code == 0
    assert f"maxar-demo S4 {tmp_path / 'out'} 4 {size_text(4 * each)[:3]}" in told
    assert f"{tmp_path / 'gone'} (in use) 4 " in told
    assert re.search(r"of no dataset on record 4 .* 3 h ago", told)
    assert f"{store.folder}: {size_text(10 * each)[:3]}" in told
    assert "in 10 entries; budget: 20 GB" in told
    _, told = said(capsys, "list", "--store", store.folder)
    assert f"{tmp_path / 'gone'} (gone) 4 " in squeezed(told)


def test_list_of_an_empty_store_and_of_none(tmp_path, capsys) -> None:
    RadianceStore(tmp_path / "empty").open_for_writing()
    code, told = said(capsys, "list", "--store", tmp_path / "empty")
    assert (code, "0 B in 0 entries" in told) == (0, True)
    assert main(["store", "list", "--store", str(tmp_path / "none")]) == 2
    assert "expected a store of light at" in capsys.readouterr().err
    assert not (tmp_path / "none").exists()


def test_the_store_named_by_the_environment_is_the_default(store, capsys, monkeypatch) -> None:
    monkeypatch.setenv("RVBENCH_STORE", str(store.folder))
    code, told = said(capsys, "list")
    assert (code, "in 10 entries" in told) == (0, True)


def test_verify_says_which_entry_is_damaged_and_whose_it_was(store, tmp_path, capsys) -> None:
    assert said(capsys, "verify", "--store", store.folder)[0] == 0
    flip(store.path(KEYS[1]))
    flip(store.path(KEYS[8]))
    code, told = said(capsys, "verify", "--store", store.folder)
    assert code == 1
    assert f"damaged: {store.path(KEYS[1])}: its bytes are no longer those" in told
    assert f"(maxar-demo, Sun S4, {tmp_path / 'out'})" in told
    assert f"damaged: {store.path(KEYS[8])}" in told
    assert "(of no dataset on record)" in told
    assert "10 entries, 2 damaged" in told
    assert store.has(KEYS[1])
    code, told = said(capsys, "verify", "--delete", "--store", store.folder)
    assert (code, "they are deleted" in told) == (1, True)
    assert not store.has(KEYS[1])
    assert not store.has(KEYS[8])
    assert said(capsys, "verify", "--store", store.folder) == (
        0,
        f"{store.folder}: 8 entries, 0 damaged\n",
    )


def test_prune_leaves_what_was_used_last(store, capsys) -> None:
    to_gb = 3.5 * store.path(KEYS[0]).stat().st_size / 1e9
    code, told = said(capsys, "prune", "--to-gb", to_gb, "--store", store.folder)
    assert (code, "7 entries deleted" in told) == (0, True)
    assert [key for key in KEYS if store.has(key)] == KEYS[7:]
    assert not list((store.folder / "claims").iterdir())  # of whose light nothing is left


def test_prune_spares_what_a_running_command_needs(store, tmp_path, capsys) -> None:
    needs = Claim("maxar-demo", "S2", tmp_path / "running", frozenset(KEYS[:2]), frozenset())
    with held(store.folder, needs):
        code, told = said(capsys, "prune", "--to-gb", 0, "--store", store.folder)
    assert code == 0
    assert "8 entries deleted" in told
    assert "needed by commands that run now" in told
    assert [key for key in KEYS if store.has(key)] == KEYS[:2]


@pytest.mark.parametrize("to_gb", ["-1", "nan"])
def test_prune_to_a_size_that_is_none_deletes_nothing(store, capsys, to_gb) -> None:
    assert main(["store", "prune", "--to-gb", to_gb, "--store", str(store.folder)]) == 2
    assert "expected --to-gb to be a number of gigabytes" in capsys.readouterr().err
    assert all(store.has(key) for key in KEYS)


def test_sizes_and_ages_are_told_in_units_that_fit() -> None:
    assert [size_text(size) for size in (12, 1.2e3, 3.45e6, 2e10)] == [
        "12 B", "1.2 kB", "3.45 MB", "20 GB",
    ]  # fmt: skip
    assert [age_text(age) for age in (-1, 5, 150, 9000, 2e5)] == [
        "0 s", "5 s", "2 min", "2 h", "2 days",
    ]  # fmt: skip


def test_prune_of_a_store_that_lets_nothing_be_deleted_says_so(store, capsys, monkeypatch) -> None:
    """As on a read-only disk."""

    def refuse(path: Path, missing_ok: bool = False) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(path))

    monkeypatch.setattr(Path, "unlink", refuse)
    assert main(["store", "prune", "--to-gb", "0", "--store", str(store.folder)]) == 2
    told = capsys.readouterr()
    assert "Read-only file system (10 entries); 0 entries were deleted" in told.err
    assert "commands that run now" not in told.out + told.err


def test_a_folder_in_the_place_of_an_entry_is_named(store, capsys) -> None:
    """It is no light, nothing deletes it, and who needs its place is told what to do."""
    place = store.path(KEYS[0])
    place.unlink()
    (place / "mine").mkdir(parents=True)
    for action in (["list"], ["verify"], ["prune", "--to-gb", "0"]):
        assert said(capsys, *action, "--store", store.folder)[0] == 0
    with pytest.raises(StorageError, match=f"folder where the file {place.name} should be: move"):
        store.write(KEYS[0], np.zeros((4, 4), np.float32))
    assert (place / "mine").is_dir()


def test_a_long_path_keeps_its_end_and_no_number_is_broken():
    """The beginnings of paths are alike: what tells datasets apart is where they end."""
    rows = [("flyp", "0.86,-0.38,0.33", f"/home/somebody/studies/a/long/way/{name}", "15",
             "408.5 MB", "165.0 kB", "3 min ago") for name in ("first", "second")]  # fmt: skip
    stream = io.StringIO()
    Console(file=stream, width=90).print(holdings_table(rows, 90))
    told = stream.getvalue()
    assert len(told.splitlines()) == 6  # one line each, between a heading and empty ones
    for text in ("way/first ", "way/second ", "…"):
        assert text in told
    assert told.count("408.5 MB") == told.count("3 min ago") == 2
