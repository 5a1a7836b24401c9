"""One shot of a sweep: a frame exposed from stored light, and what each pipeline says of it.

Shots are taken in worker processes. A pipeline gets the frame and what is on board as drawn; truth
stays with whoever judges. No Mitsuba is loaded. What a shot came to is kept as
``DIR/shots/KEY.json``, of run 0 with ``KEY.png``, its last image small; the key is the hash of all
that shaped it.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from bench.estimating.contenders import Contender
from bench.estimating.guard import Guards
from bench.pictures.stretch import stretch
from models.arrays import Image, Radiance
from models.atomic_file import write_bytes, write_text
from models.dataset.estimates_file import estimate_from_json, estimate_to_json
from models.errors import DatasetError, StorageError
from models.estimate import Estimate
from models.frame import Frame, ImageReading, Reading
from models.onboard import OnboardKnowledge, needed
from models.reading.json_file import read_json_table
from models.reading.regular_file import read_bytes
from models.sensors.camera_chip import Detector
from renders.batches.replay import read_groups
from renders.detector.compose import compose
from renders.scenario.scenario import Scenario
from renders.store.radiance_store import RadianceStore
from renders.store.sealed_exr import read_exr
from renders.tracing.light_groups import LightGroup
from renders.world.build import world_of

SHOT_FORMAT, SHOT_VERSION = "rvbench-shot", 2
THUMBNAIL_PX = 256


@dataclass(frozen=True)
class Shot:
    """Everything that shapes one shot.

    Attributes
    ----------
    scenario : Scenario
        Of one frame, under one Sun; see ``renders.batches.sweep_batches.scenario_at``.
    store : Path
    light : dict
        Store keys by band and group name.
    exposure_ms : float, ms
    lamp_factor : float
        Lamp power over that of the scenario.
    pipelines : tuple of Contender
        To ask.
    depth : dict of int to Path
        Where each band's depth lies; empty for a lens that is sharp at any depth.
    run : int
        Whose detector noise, prior and other draws: those of `rvbench run --seeds`.
    """

    scenario: Scenario
    store: Path
    light: Mapping[int, Mapping[str, str]]
    exposure_ms: float
    lamp_factor: float
    pipelines: tuple[Contender, ...]
    depth: Mapping[int, Path]
    run: int = 0

    @cached_property
    def key(self) -> str:
        """Hash of all of it but the places of files."""
        shaping: dict[str, object] = {
            "format": [SHOT_FORMAT, SHOT_VERSION, THUMBNAIL_PX],
            "scenario": self.scenario.fingerprint(),
            "light": {str(band): dict(keys) for band, keys in self.light.items()},
            "exposure_ms": self.exposure_ms,
            "lamp_factor": self.lamp_factor,
            "pipelines": {each.label: each.settings for each in self.pipelines},
        }
        if self.run:
            shaping["run"] = self.run
        return hashlib.sha256(json.dumps(shaping, sort_keys=True).encode()).hexdigest()


@dataclass(frozen=True, eq=False)
class ShotRecord:
    """What a shot came to.

    Attributes
    ----------
    estimates : dict of str to Estimate
        By pipeline variant.
    saturated_percent : dict of str to float
        Share of the pixels at the full well or the converter's end, within their noise, by stream.
    thumbnail : (n, n) uint8 array or None
        The last image, small, stretched as everywhere (``bench.pictures.stretch``); of run 0 alone.
    """

    estimates: dict[str, Estimate]
    saturated_percent: dict[str, float]
    thumbnail: NDArray[np.uint8] | None


def take_shots(shots: Sequence[Shot], onboards: Sequence[OnboardKnowledge], out: Path) -> bool:
    """Take shots of one pose under one Sun, and keep what they came to in ``out/shots``.

    Parameters
    ----------
    shots : sequence of Shot
        At least one; all under the same light.
    onboards : sequence of OnboardKnowledge
        By run.
    out : Path
        The sweep's folder.

    Returns
    -------
    bool
        False if the store has not, or no longer, the light that they need; nothing is kept then.
    """
    light = read_light(shots[0])
    if light is None:
        return False
    for shot in shots:
        frame, onboard = exposed(shot, light), onboards[shot.run]
        with Guards(list(shot.pipelines), onboard, None) as guarded:
            said = {label: one.process(frame).estimate for label, one in guarded.items()}
        _write(out, shot, frame, said, needed(onboard.detector, "detector.toml", "a sweep"))
    return True


def read_light(shot: Shot) -> dict[int, dict[LightGroup, Radiance]] | None:
    """Read what lights a shot, by band; None if an entry is absent or damaged.

    Returns
    -------
    dict of int to dict of LightGroup to (height, width) arrays, W m-2 sr-1, or None
    """
    world, store = world_of(shot.scenario), RadianceStore(shot.store)
    light = {}
    exposures = {exposure.band: exposure for exposure in world.exposures}
    for band, keys in shot.light.items():
        groups = read_groups(store, world, exposures[band], keys)
        if groups is None:
            return None
        light[band] = groups
    return light


def exposed(shot: Shot, light: Mapping[int, Mapping[LightGroup, Radiance]]) -> Frame:
    """Expose the frame: light is linear, so another lamp power is a factor.

    Parameters
    ----------
    shot : Shot
    light : mapping of int to mapping of LightGroup to (height, width) arrays, W m-2 sr-1
        By band.
    """
    world = world_of(shot.scenario)
    readings: dict[str, Reading] = {}
    for exposure in world.exposures:
        stream = world.sensor.stream(exposure.band)
        groups = {
            group: radiance * np.float32(shot.lamp_factor)
            if group == stream.own_lamps and shot.lamp_factor != 1.0
            else radiance
            for group, radiance in light[exposure.band].items()
        }
        depth_m = _depth_m(shot, exposure.band)
        image = compose(world, groups, exposure, shot.exposure_ms, shot.run, depth_m)
        readings[stream.name] = ImageReading(image, exposure.time_s, shot.exposure_ms)
    time_s = world.scenario.times_s[0]
    for sensor in world.tables:
        readings[sensor.name] = sensor.reading(0, time_s, -np.inf, shot.run)
    return Frame(0, time_s, readings)


def _depth_m(shot: Shot, band: int) -> Radiance | None:
    if band not in shot.depth:
        return None
    channels = read_exr(shot.depth[band])
    if channels is None:
        raise StorageError(
            f"expected the depth of each pixel at {shot.depth[band]}, found it absent or damaged; "
            "run the same command again to bring it back"
        )
    return np.asarray(channels["Z"], dtype=np.float32)


def read_shot(out: Path, shot: Shot) -> ShotRecord | None:
    """Read what a shot came to; None if it has not been taken or its files are not whole."""
    path = shot_path(out, shot)
    try:
        record = read_json_table(path)
        if record["key"] != shot.key:
            return None
        estimates = {
            each.label: estimate_from_json(record["estimates"][each.label], path)
            for each in shot.pipelines
        }
        saturated = {str(stream): float(x) for stream, x in record["saturated_percent"].items()}
        if shot.run:
            return ShotRecord(estimates, saturated, None)
        data = np.frombuffer(read_bytes(path.with_suffix(".png")), np.uint8)
    except (DatasetError, ValueError, KeyError, TypeError):
        return None
    thumbnail = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE) if len(data) else None
    if thumbnail is None:
        return None
    return ShotRecord(estimates, saturated, np.asarray(thumbnail, dtype=np.uint8))


def images_of(frame: Frame) -> dict[str, Image]:
    """Return a frame's images by stream, (height, width), DN; the last meters the exposure."""
    return {
        name: each.image for name, each in frame.readings.items() if isinstance(each, ImageReading)
    }


def picture(image: Image, detector: Detector, width_px: int | None = None) -> NDArray[np.uint8]:
    """Return a frame as grey levels, averaged down to ``width_px`` if it is wider.

    Parameters
    ----------
    image : (height, width) array, DN
    detector : Detector
    width_px : int, px, optional
        As wide as it is unless given.

    Returns
    -------
    (height, width) uint8 array
    """
    grey = stretch(image.astype(np.float64) - detector.bias_dn, detector)
    if width_px is not None and width_px < grey.shape[1]:
        height_px = round(grey.shape[0] * width_px / grey.shape[1])
        grey = cv2.resize(grey, (width_px, height_px), interpolation=cv2.INTER_AREA)
    return np.rint(255.0 * grey).astype(np.uint8)


def encoded_png(grey: NDArray[np.uint8]) -> bytes:
    """Return grey levels as PNG.

    Parameters
    ----------
    grey : (height, width) uint8 array

    Raises
    ------
    DatasetError
        If OpenCV refuses.
    """
    ok, data = cv2.imencode(".png", grey)
    if not ok:
        raise DatasetError(f"expected OpenCV to encode an image of {grey.shape}, it refused")
    return bytes(data.tobytes())


def _write(
    out: Path, shot: Shot, frame: Frame, estimates: Mapping[str, Estimate], detector: Detector
) -> None:
    path = shot_path(out, shot)
    images = images_of(frame)
    if shot.run == 0:
        small = picture(list(images.values())[-1], detector, THUMBNAIL_PX)
        write_bytes(path.with_suffix(".png"), encoded_png(small))
    full_dn = detector.saturation_dn - 3.0 * detector.read_noise_e / detector.gain_e_dn - 1.0
    record = {
        "format": SHOT_FORMAT,
        "key": shot.key,
        "estimates": {name: estimate_to_json(said) for name, said in estimates.items()},
        "saturated_percent": {
            stream: 100.0 * float((image >= full_dn).mean()) for stream, image in images.items()
        },
    }
    write_text(path, json.dumps(record) + "\n")  # last: a shot with its record is whole


def shot_path(out: Path, shot: Shot) -> Path:
    """Return where the record of a shot lies in a sweep's folder."""
    return out / "shots" / f"{shot.key[:24]}.json"
