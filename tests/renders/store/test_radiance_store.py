"""The store gives back what was put in, in half floats, or nothing: never something else."""

import errno
import resource
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from models.arrays import Radiance
from models.errors import StorageError
from renders.store.radiance_store import (
    HALF_MAX,
    RadianceStore,
    default_store,
    entry_key,
)
from renders.store.sealed_exr import read_exr, write_exr

KEY = entry_key({"what": "a test"})
HALF_EPSILON = 2.0**-11  # half floats carry eleven binary digits


def picture(rows: int = 48, columns: int = 64) -> Radiance:
    """Return radiances over the decades of space, from its black to a marker's 580."""
    rng = np.random.default_rng(5)
    image = 10.0 ** rng.uniform(-3.0, 2.76, (rows, columns))
    image[rng.random(image.shape) < 0.5] = 0.0
    return image.astype(np.float32)


@pytest.fixture
def store(tmp_path: Path) -> RadianceStore:
    return RadianceStore(tmp_path / "store")


def files(store: RadianceStore) -> list[Path]:
    return sorted(path for path in store.folder.rglob("*") if path.is_file())


def test_an_entry_comes_back_rounded_to_half_floats(store: RadianceStore) -> None:
    image = picture()
    store.write(KEY, image)
    back = store.read(KEY)
    assert back is not None
    assert back.dtype == np.float32
    assert back.shape == image.shape
    np.testing.assert_array_equal(back, image.astype(np.float16).astype(np.float32))
    np.testing.assert_allclose(back, image, rtol=HALF_EPSILON)


def test_rounding_is_far_below_photon_noise() -> None:
    """A marker near full well has 60 ke and 245 e of noise: the store adds at most 29 e."""
    charge_e = 60_000.0
    assert charge_e * HALF_EPSILON < 0.15 * np.sqrt(charge_e)


def test_a_glint_is_clamped_and_stays_finite(store: RadianceStore) -> None:
    image = picture()
    image[3, 5] = 1e9
    image[4, 6] = np.inf
    store.write(KEY, image)
    back = store.read(KEY)
    assert back is not None
    assert back[3, 5] == back[4, 6] == HALF_MAX
    assert np.isfinite(back).all()


def test_an_absent_entry_is_none(store: RadianceStore) -> None:
    assert not store.has(KEY)
    assert store.read(KEY) is None
    assert not store.folder.exists()  # looking makes nothing


def test_entries_keep_apart_and_can_be_written_again(store: RadianceStore) -> None:
    other = entry_key({"what": "another"})
    store.write(KEY, picture())
    store.write(other, 2.0 * picture())
    store.write(KEY, 3.0 * picture())
    one, two = store.read(KEY), store.read(other)
    assert one is not None
    assert two is not None
    np.testing.assert_allclose(one, 3.0 * picture(), rtol=HALF_EPSILON)
    np.testing.assert_allclose(two, 2.0 * picture(), rtol=HALF_EPSILON)
    assert files(store) == sorted([store.path(KEY), store.path(other)])


def test_the_same_light_makes_the_same_file(tmp_path: Path) -> None:
    one, two = RadianceStore(tmp_path / "one"), RadianceStore(tmp_path / "two")
    for store in (one, two):
        store.write(KEY, picture())
    assert one.path(KEY).read_bytes() == two.path(KEY).read_bytes()


# Damage


@pytest.mark.parametrize("kept", [0.0, 0.05, 0.5, 0.9, 0.999])
def test_a_truncated_entry_is_none(store: RadianceStore, kept: float) -> None:
    store.write(KEY, picture())
    data = store.path(KEY).read_bytes()
    store.path(KEY).write_bytes(data[: int(kept * len(data))])
    assert store.has(KEY)
    assert store.read(KEY) is None


def test_a_flipped_bit_anywhere_is_seen(store: RadianceStore) -> None:
    """In the header as in the compressed pixels, in the seal as in what it covers."""
    store.write(KEY, picture(8, 8))
    data = store.path(KEY).read_bytes()
    for place in range(len(data)):
        damaged = bytearray(data)
        damaged[place] ^= 1 << (place % 8)
        store.path(KEY).write_bytes(bytes(damaged))
        assert store.read(KEY) is None, place
    store.path(KEY).write_bytes(data)
    assert store.read(KEY) is not None


def test_an_entry_under_another_key_is_none(store: RadianceStore) -> None:
    """As a copy to the wrong name makes it: whole, but other light."""
    other = entry_key({"what": "another"})
    store.write(KEY, picture())
    store.path(other).parent.mkdir()
    store.path(other).write_bytes(store.path(KEY).read_bytes())
    assert store.read(other) is None


def test_any_exr_reader_opens_an_entry(store: RadianceStore) -> None:
    """The seal is an attribute like another."""
    import OpenEXR

    store.write(KEY, picture())
    with OpenEXR.File(str(store.path(KEY)), separate_channels=True) as file:
        pixels = np.array(file.channels()["Y"].pixels)
        assert file.header()["rvbench_key"] == KEY
    np.testing.assert_array_equal(pixels, picture().astype(np.float16))


def test_many_entries_are_written_side_by_side_as_one_by_one(tmp_path: Path) -> None:
    images = {entry_key({"number": number}): (1.0 + number) * picture() for number in range(9)}
    one, many = (RadianceStore(tmp_path / name, writers=n) for name, n in (("one", 1), ("m", 4)))
    for key, image in images.items():
        one.write(key, image)
    many.write_all(images)
    assert len(files(many)) == 9
    for key in images:
        assert many.path(key).read_bytes() == one.path(key).read_bytes()


def test_a_damaged_entry_is_replaced_by_writing_it_again(store: RadianceStore) -> None:
    store.write(KEY, picture())
    whole = store.path(KEY).read_bytes()
    store.path(KEY).write_bytes(whole[:-100])
    store.write(KEY, picture())
    assert store.path(KEY).read_bytes() == whole


def test_another_programs_exr_is_none(store: RadianceStore, tmp_path: Path) -> None:
    """Without our hash, or with other channels, it is no entry."""
    write_exr(store.path(KEY), {"Z": picture()})
    assert store.read(KEY) is None
    assert read_exr(store.path(KEY)) is not None
    store.path(KEY).write_text("not an image")
    assert store.read(KEY) is None


# Full and read-only disks


@contextmanager
def disk_that_takes(size_bytes: int) -> Iterator[None]:
    """Let no file of this process grow beyond a size, as a full disk would not."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (size_bytes, hard))
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        signal.signal(signal.SIGXFSZ, before)


@pytest.mark.parametrize("size_bytes", [0, 100, 2000])
def test_a_full_disk_is_told_and_leaves_what_was_there(
    store: RadianceStore, size_bytes: int
) -> None:
    store.write(KEY, picture())
    other = entry_key({"what": "too much"})
    with disk_that_takes(size_bytes), pytest.raises(StorageError, match="free some space"):
        store.write(other, picture())
    with disk_that_takes(size_bytes), pytest.raises(StorageError, match="free some space"):
        store.write(KEY, 2.0 * picture())
    back = store.read(KEY)
    assert back is not None
    np.testing.assert_allclose(back, picture(), rtol=HALF_EPSILON)
    assert files(store) == [store.path(KEY)]  # no scratch, no half entry


def test_a_folder_that_cannot_be_made_is_told(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("a file, where the store should be")
    store = RadianceStore(tmp_path / "taken")
    with pytest.raises(StorageError, match=r"expected to write .*taken"):
        store.write(KEY, picture())
    assert (tmp_path / "taken").is_file()


def test_a_read_only_folder_is_told(store: RadianceStore, monkeypatch: pytest.MonkeyPatch) -> None:
    """As the system tells it; root, who may run this test, can write anywhere."""

    def refuse(self: Path, *_: object, **__: object) -> None:
        raise OSError(errno.EROFS, "Read-only file system", str(self))

    monkeypatch.setattr(Path, "mkdir", refuse)
    with pytest.raises(StorageError, match="Read-only file system"):
        store.write(KEY, picture())


# Keys


def test_keys_tell_every_digit_apart_and_ignore_order() -> None:
    assert entry_key({"a": 1.0, "b": 2}) == entry_key({"b": 2, "a": 1.0})
    assert entry_key({"a": 1.0}) != entry_key({"a": float(np.nextafter(1.0, 2.0))})
    assert entry_key({"a": 1.0}) != entry_key({"b": 1.0})
    assert len(KEY) == 64


def test_the_store_lies_where_it_is_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.delenv("RVBENCH_STORE", raising=False)
    assert default_store() == tmp_path / "cache" / "rvbench" / "store"
    monkeypatch.setenv("RVBENCH_STORE", str(tmp_path / "named"))
    assert default_store() == tmp_path / "named"
