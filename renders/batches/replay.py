"""Frames composed from the store: another run of the same light costs no rendering.

A run has its own detector noise, prior and calibration. ``truth/light.json`` names the store
entries of each exposure, so no Mitsuba is loaded.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import numpy as np

from models.arrays import Image, Radiance
from models.dataset.frame_table import FrameEntry
from models.errors import DatasetError, StorageError, UnreadableError, cause
from models.frame import Frame, ImageReading, Reading
from models.onboard import OnboardKnowledge
from models.reading.json_file import read_json_table
from models.reading.regular_file import MEGABYTE
from renders.detector.compose import compose
from renders.detector.exposure_control import ExposureControl
from renders.scenario.scenario import read_scenario
from renders.store.claims import Claim, held, read_claim
from renders.store.kept_light import ALL_LIGHT, LightKeeping
from renders.store.radiance_store import RadianceStore
from renders.store.sealed_exr import read_exr
from renders.tracing.light_groups import LightGroup
from renders.world.build import world_of
from renders.world.exposure import FILTERED, Exposure, exposure_name
from renders.world.world import World

MOST_RECORD_BYTES = 2000 * MEGABYTE  # 64 digits a key, some keys an exposure


def read_groups(
    store: RadianceStore, world: World, exposure: Exposure, keys: Mapping[str, str]
) -> dict[LightGroup, Radiance] | None:
    """Read what lights one exposure.

    Parameters
    ----------
    store : RadianceStore
    world : World
    exposure : Exposure
    keys : mapping of str to str
        The store's, by group name.

    Returns
    -------
    dict of LightGroup to (height, width) float32 arrays, W m-2 sr-1, or None
        None if an entry is absent or damaged.
    """
    groups: dict[LightGroup, Radiance] = {}
    for group in world.lit_by(exposure):
        radiance = store.read(keys[group.name]) if group.name in keys else None
        if radiance is None:
            return None
        groups[group] = radiance
    return groups


def read_depth(world: World, folder: Path, exposure: Exposure) -> Radiance | None:
    """Return the depth of an exposure's pixels from a dataset.

    Parameters
    ----------
    world : World
    folder : Path
        The dataset.
    exposure : Exposure

    Returns
    -------
    (height, width) float32 array, m, or None
        0 in space; None if nothing needs it.

    Raises
    ------
    DatasetError
        If it is needed, and absent or damaged.
    """
    if not world.scenario.needs_depth:
        return None
    path = folder / "truth" / "geometry" / f"{exposure.name}.exr"
    channels = read_exr(path)
    if channels is None:
        raise DatasetError(
            f"expected the depth of each pixel at {path}, found it absent or damaged; "
            "run the same command again to bring it back"
        )
    return np.asarray(channels["Z"], dtype=np.float32)


def light_record(
    store: RadianceStore,
    keys: Mapping[tuple[int, int], Mapping[str, str]],
    kept: LightKeeping = ALL_LIGHT,
) -> str:
    """Return the text of ``truth/light.json``.

    Parameters
    ----------
    store : RadianceStore
    keys : mapping of (int, int) to mapping of str to str
        By frame and band: the store's keys, by group name.
    kept : LightKeeping
    """
    exposures = {exposure_name(frame, band): dict(names) for (frame, band), names in keys.items()}
    table = {"store": str(store.folder.resolve()), "exposures": exposures}
    if kept != ALL_LIGHT:
        table["kept"] = str(kept)
    return json.dumps(table, indent=1) + "\n"


def read_light_record(folder: Path) -> tuple[RadianceStore, dict[str, dict[str, str]]]:
    """Read ``truth/light.json``: the store, and the keys of each exposure by group name.

    Raises
    ------
    DatasetError
        If it is missing or broken.
    """
    path = folder / "truth" / "light.json"
    try:
        table = read_json_table(path, MOST_RECORD_BYTES)
        exposures = {str(name): dict(keys) for name, keys in table["exposures"].items()}
        return RadianceStore(Path(table["store"])), exposures
    except (UnreadableError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise DatasetError(
            f"expected the light's keys at {path}, got: {cause(error)}; render again"
        ) from error


def lit_otherwise(
    folder: Path,
    keys: Mapping[tuple[int, int], Mapping[str, str]],
    rendered: Iterable[tuple[int, int]],
) -> list[tuple[int, int]]:
    """Return those of the rendered exposures whose light is on record with other keys.

    Another variant or another version of the house made them; a folder without a record has none.

    Parameters
    ----------
    folder : Path
        The dataset.
    keys : mapping of (int, int) to mapping of str to str
        As for ``light_record``, of all exposures that were rendered at least.
    rendered : iterable of (int, int)
        Frames and bands.
    """
    try:
        _, recorded = read_light_record(folder)
    except DatasetError:
        return []
    return [
        (frame, band)
        for frame, band in rendered
        if recorded.get(exposure_name(frame, band), keys[frame, band]) != keys[frame, band]
    ]


def _at_band(exposure: Exposure) -> str:
    return "" if exposure.band == FILTERED else f" at {exposure.band} nm"


def _how_to_bring_back(folder: Path) -> str:
    kept = read_json_table(folder / "truth" / "light.json", MOST_RECORD_BYTES).get("kept")
    if kept is None:
        return "run the same command again to bring it back"
    return (
        f"the dataset was rendered with {kept}: render it with --keep-light all and --seeds, "
        "which brings back the light and no frame"
    )


@contextmanager
def light_held(folder: Path) -> Iterator[None]:
    """Have nobody evict the light of a rendered dataset's frames for as long as this lasts.

    A store that cannot be written is read without a claim: nothing is evicted from it either.

    Raises
    ------
    DatasetError
        If the dataset was not rendered here.
    """
    world = world_of(read_scenario(folder / "truth" / "scenario.toml"))
    store, recorded = read_light_record(folder)
    needed = needed_keys(
        world,
        {(e.frame, e.band): recorded.get(e.name, {}) for e in world.exposures},
    )
    name, sun = world.scenario.name, world.scenario.sun.default
    claim = Claim(name, sun, folder, needed)
    before = read_claim(claim.path(store.folder))
    if before is not None:
        claim = Claim(name, sun, folder, needed, before.keys - needed)
    with ExitStack() as stack:
        if store.folder.is_dir():
            with suppress(StorageError):
                stack.enter_context(held(store.folder, claim))
        yield


def needed_keys(world: World, keys: Mapping[tuple[int, int], Mapping[str, str]]) -> frozenset[str]:
    """Return the keys of what lights the frames themselves, out of those of each exposure."""
    return frozenset(
        keys[exposure.frame, exposure.band][group.name]
        for exposure in world.exposures
        for group in world.lit_by(exposure)
        if group.name in keys[exposure.frame, exposure.band]
    )


def exposed_frames(folder: Path, run: int) -> tuple[OnboardKnowledge, Iterator[Frame]]:
    """Expose all frames of a rendered dataset again, as run number ``run`` sees them.

    Parameters
    ----------
    folder : Path
        A dataset whose light is still in its store.
    run : int
        0 gives the frames of the dataset itself.

    Returns
    -------
    OnboardKnowledge
        What is on board in that run.
    iterator of Frame
        With the readings of all streams, as that run draws them.

    Raises
    ------
    DatasetError
        If the dataset was not rendered here, or an entry has left the store.
    """
    world = world_of(read_scenario(folder / "truth" / "scenario.toml"))
    store, recorded = read_light_record(folder)
    onboard, clock = world.onboard(run), world.clock(run)
    control = ExposureControl(world, onboard.prior)

    def image(exposure: Exposure, entry: FrameEntry) -> Image:
        keys = recorded.get(exposure.name, {})
        groups = read_groups(store, world, exposure, keys)
        if groups is None:
            raise DatasetError(
                f"expected the light of frame {exposure.frame}{_at_band(exposure)} "
                f"in {store.folder}, "
                f"found it absent or damaged; {_how_to_bring_back(folder)}"
            )
        depth_m = read_depth(world, folder, exposure)
        return compose(world, groups, exposure, entry.exposure_ms, run, depth_m)

    def frames() -> Iterator[Frame]:
        last: dict[int, Image] = {}
        since_s = -np.inf
        for number, time_s in enumerate(world.scenario.times_s):
            entry = control.entry(number, last.__getitem__)
            readings: dict[str, Reading] = {}
            for exposure in world.sensor.exposures(number, time_s):
                shown = image(exposure, entry)
                stream = world.sensor.stream(exposure.band)
                middle_s = clock.shows(time_s) + stream.offset_s
                readings[stream.name] = ImageReading(shown, middle_s, entry.exposure_ms)
                last = {number: shown}
            for sensor in world.tables:
                rows = sensor.reading(number, time_s, since_s, run)
                readings[sensor.name] = clock.stamped_rows(rows)
            since_s = time_s
            yield Frame(number, clock.shows(time_s), readings)

    return onboard, frames()
