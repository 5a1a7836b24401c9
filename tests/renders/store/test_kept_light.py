"""What is kept of a run's light: of all frames, of some or of none, and the same frames."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

import numpy as np
import pytest

from bench.cli import main
from models.arrays import Radiance
from models.errors import DatasetError, ScenarioError
from models.pose import RigidTransform
from renders.batches import case_rendering as batch
from renders.batches.replay import exposed_frames
from renders.batches.studio import Studio
from renders.store.budget import GB, stored
from renders.store.claims import live_claims, read_claims
from renders.store.kept_light import LightKeeping, checked_budget, exposure_bytes, keeping
from renders.store.sealed_exr import read_exr
from renders.tracing.light_groups import LightGroup
from renders.truth.exposure_truth import ExposureTruth, read_exposures
from renders.truth.pixel_truth import PixelTruth
from renders.world.exposure import Exposure
from tests.renders.conftest import TinyDataset

FRAMES, EXPOSURES = 2, 4
NAMES = [f"{frame:06d}_{band}" for frame in range(FRAMES) for band in (800, 850)]


Again: TypeAlias = Callable[..., TinyDataset]


@pytest.fixture
def again(rendered_once: TinyDataset, tmp_path: Path) -> Again:
    """Return the tiny case with other options, to be rendered into folders of its own."""

    def dataset(**options: object) -> TinyDataset:
        home = {"out": tmp_path / "out", "store": tmp_path / "store"}
        return TinyDataset(replace(rendered_once.request, **{**home, **options}))  # type: ignore[arg-type]

    return dataset


@pytest.fixture
def traced_before(
    rendered_once: TinyDataset, monkeypatch: pytest.MonkeyPatch
) -> list[tuple[int, int]]:
    """Give what was traced once, not traced again for seconds; return what is asked to be traced.

    Frame and band of each exposure.
    """
    asked: list[tuple[int, int]] = []

    def trace(
        studio: Studio,
        exposure: Exposure,
        pose: RigidTransform,
        groups: list[LightGroup],
        limits: object = None,
    ) -> dict[str, Radiance]:
        asked.append((exposure.frame, exposure.band))
        keys = {group.name: studio.keys.group(exposure, pose, group) for group in groups}
        images = {name: rendered_once.store.read(key) for name, key in keys.items()}
        return {name: image for name, image in images.items() if image is not None}

    truths = read_exposures(rendered_once.folder)
    geometry = rendered_once.folder / "truth" / "geometry"

    def pixel_truth(_: Studio, exposure: Exposure, pose: RigidTransform) -> PixelTruth:
        (name,) = (
            f"{frame:06d}_{band}"
            for (frame, band), truth in truths.items()
            if np.allclose(truth.cam_from_target.matrix(), pose.matrix(), rtol=0.0, atol=1e-12)
        )
        channels = read_exr(geometry / f"{name}.exr")
        assert channels is not None
        normals = np.stack([channels[axis] for axis in ("NX", "NY", "NZ")], axis=-1)
        return PixelTruth(channels["label"].astype(np.uint8), channels["Z"], normals)

    def truth(_: Studio, exposure: Exposure, __: RigidTransform) -> ExposureTruth:
        return truths[exposure.frame, exposure.band]

    monkeypatch.setattr(Studio, "trace", trace)
    monkeypatch.setattr(Studio, "pixel_truth", pixel_truth)
    monkeypatch.setattr(Studio, "sealed", truth)
    return asked


def frames(dataset: TinyDataset) -> dict[str, bytes]:
    return {n: data for n, data in dataset.files().items() if n.startswith(("frames", "truth/lab"))}


def entries(dataset: TinyDataset) -> int:
    return len(list(stored(dataset.store.folder)))


def size(dataset: TinyDataset) -> int:
    return sum(entry.cost_bytes for entry in stored(dataset.store.folder))


# The frames are the same whatever is kept


@pytest.mark.slow
def test_nothing_is_kept_and_the_frames_are_the_same(
    again: Again, rendered_once: TinyDataset
) -> None:
    dataset = again(keep_light="none")
    dataset.render()
    ours, theirs = dataset.files(), rendered_once.files()
    assert ours.keys() == theirs.keys()
    assert all(ours[name] == theirs[name] for name in ours if name != "truth/light.json")
    assert not dataset.store.folder.exists()


@pytest.mark.usefixtures("traced_before")
def test_the_light_of_some_frames_is_kept(again: Again, rendered_once: TinyDataset) -> None:
    dataset = again(keep_light="some", keep_every=2)
    dataset.render()
    assert frames(dataset) == frames(rendered_once)
    assert entries(dataset) == 2 * 3  # the first frame's: Sun, lamps and geometry of each band
    assert "4 of 4 exposures are there already" in dataset.render()


def light_keys(dataset: TinyDataset, name: str) -> dict[str, str]:
    import json

    table = json.loads((dataset.folder / "truth" / "light.json").read_text())
    return dict(table["exposures"][name])


def test_light_that_was_not_kept_is_told_and_comes_back(
    again: Again, rendered_once: TinyDataset, traced_before: list[tuple[int, int]]
) -> None:
    dataset = again(keep_light="some", keep_every=2)
    dataset.render()
    _, replayed = exposed_frames(dataset.folder, run=1)
    next(replayed)  # kept
    with pytest.raises(DatasetError, match=r"rendered with --keep-light some --keep-every 2"):
        next(replayed)
    traced_before.clear()
    again(seeds=2).render()
    assert traced_before == [(1, 800), (1, 850)]
    _, replayed = exposed_frames(dataset.folder, run=1)
    assert len(list(replayed)) == FRAMES
    assert frames(dataset) == frames(rendered_once)


# Within a budget


@pytest.mark.usefixtures("traced_before")
def test_a_run_streams_within_its_budget(
    again: Again,
    rendered_once: TinyDataset,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The budget holds the light of three of the four exposures; the dataset is the same."""
    light = sum(entry.cost_bytes for entry in stored(rendered_once.store.folder))
    budget = 0.8 * light
    monkeypatch.setattr(batch, "checked_budget", lambda *_: budget)
    sizes = []
    really = batch.compose

    def watched(*arguments: object, **named: object) -> object:
        sizes.append(size(dataset))
        return really(*arguments, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(batch, "compose", watched)
    dataset = again()
    dataset.render()
    assert len(sizes) == EXPOSURES
    assert 0 < max(*sizes, size(dataset)) <= budget
    assert light_of(dataset, NAMES[-1]) == {True}
    assert False in light_of(dataset, NAMES[0])
    assert frames(dataset) == frames(rendered_once)


def light_of(dataset: TinyDataset, name: str) -> set[bool]:
    return {dataset.store.has(key) for key in light_keys(dataset, name).values()}


@pytest.mark.usefixtures("traced_before")
def test_light_that_another_process_prunes_at_once_is_no_loss(
    again: Again,
    rendered_once: TinyDataset,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Everything written is gone before it is read back, links and all."""
    dataset = again()
    really = batch.RadianceStore.write_all

    def written_and_pruned(self: batch.RadianceStore, images: dict[str, np.ndarray]) -> None:
        really(self, images)
        shutil.rmtree(self.folder)

    monkeypatch.setattr(batch.RadianceStore, "write_all", written_and_pruned)
    dataset.render()
    assert frames(dataset) == frames(rendered_once)


@pytest.mark.usefixtures("traced_before")
def test_a_run_claims_its_light_while_it_lives_and_leaves_a_record(
    again: Again, monkeypatch: pytest.MonkeyPatch
) -> None:
    dataset = again(end_s=240.0, seeds=2)
    alive = []
    really = batch.compose

    def watched(*arguments: object, **named: object) -> object:
        alive.extend(live_claims(dataset.store.folder))
        return really(*arguments, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(batch, "compose", watched)
    dataset.render()
    keys = {entry.key for entry in stored(dataset.store.folder)}
    assert [claim.needed | claim.wanted for claim in alive] == [keys, keys]
    lit = {key for name in NAMES[:2] for key in light_keys(dataset, name).values()}
    assert alive[0].needed == lit
    assert live_claims(dataset.store.folder) == []
    (record,) = read_claims(dataset.store.folder)
    assert (record.case, record.sun, record.keys) == ("maxar-demo", "S2", keys)
    assert record.dataset == dataset.folder


# Damage


@pytest.mark.parametrize("place", [-100, b"screenWindowWidth"], ids=["pixels", "header"])
@pytest.mark.parametrize("verified", [False, True], ids=["a run meets it", "verify deletes it"])
def test_a_flipped_byte_is_found_and_that_entry_rendered_again_to_the_same_bits(
    tiny: TinyDataset, traced_before: list[tuple[int, int]], place: int | bytes, verified: bool
) -> None:
    before = tiny.files()
    entry = tiny.store.path(light_keys(tiny, "000001_850")["lamps_850"])
    whole = entry.read_bytes()
    damaged = bytearray(whole)
    damaged[whole.index(place) if isinstance(place, bytes) else place] ^= 1
    entry.write_bytes(bytes(damaged))
    if verified:
        assert main(["store", "verify", "--delete", "--store", str(tiny.store.folder)]) == 1
        assert not entry.exists()
    (tiny.folder / "frames" / "000001_850.png").unlink()
    tiny.render()
    assert traced_before == [(1, 850)]
    assert entry.read_bytes() == whole
    assert tiny.files() == before
    assert main(["store", "verify", "--store", str(tiny.store.folder)]) == 0


# What is asked for


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"keep_every": 5}, "only with --keep-light some, got it with all"),
        ({"keep_light": "none", "keep_every": 5}, "got it with none"),
        ({"keep_light": "some", "keep_every": 0}, "of at least 1, got 0"),
        ({"keep_light": "some", "seeds": 2}, "expected --keep-light all with --seeds 2"),
        ({"keep_light": "none", "seeds": 2}, "expected --keep-light all with --seeds 2"),
        ({"store_budget_gb": 1e-4}, r"of at least 0\.0004.* 2 light groups at 128 x 128.*0\.0001"),
    ],
)
def test_what_cannot_be_is_told_before_anything_is_made(
    again: Again, options: dict[str, object], message: str
) -> None:
    dataset = again(**options)
    with pytest.raises(ScenarioError, match=message):
        dataset.render()
    assert not dataset.folder.exists()
    assert not dataset.store.folder.exists()


def test_no_budget_is_too_small_for_keeping_nothing(again: Again) -> None:
    dataset = again(keep_light="none", store_budget_gb=1e-9)
    assert checked_budget(dataset.request, dataset.world) == pytest.approx(1e-9 * GB)


def test_which_frames_keep_their_light(again: Again) -> None:
    kept = keeping(again(keep_light="some").request)
    assert str(kept) == "--keep-light some --keep-every 10"
    assert [frame for frame in range(25) if kept.keeps(frame)] == [0, 10, 20]
    assert all(LightKeeping().keeps(frame) for frame in range(3))
    assert not any(LightKeeping("none").keeps(frame) for frame in range(3))


def test_an_exposure_never_takes_more_than_is_reckoned(rendered_once: TinyDataset) -> None:
    """Noise does not compress; real light takes less."""
    bound = exposure_bytes(rendered_once.world)
    for exposure in NAMES:
        keys = light_keys(rendered_once, exposure).values()
        geometry = rendered_once.folder / "truth" / "geometry" / f"{exposure}.exr"
        light = sum(rendered_once.store.path(key).stat().st_size for key in keys)
        assert light + geometry.stat().st_size < bound
    noise = np.random.default_rng(2).integers(0, 30000, (128, 128), dtype=np.uint16)
    rendered_once_store = rendered_once.store.folder.parent / "noise"
    store = type(rendered_once.store)(rendered_once_store)
    key = next(iter(light_keys(rendered_once, NAMES[0]).values()))
    store.write(key, noise.view(np.float16).astype(np.float32))
    assert 2 * 128 * 128 < store.path(key).stat().st_size < 2 * 128 * 128 + 65536
