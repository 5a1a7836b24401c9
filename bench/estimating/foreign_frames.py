"""Anybody's frames, made into what a pipeline takes: image pairs, or single images.

A folder of ``NAME_800.png`` and ``NAME_850.png`` holds pairs; of any other names, single images; 8
or 16 bits, grey; TIFFs and JPEGs will do. They are taken in the order of their names. Times come
from ``frames.csv`` (index, time_s, exposure_ms) in or beside the folder, else from the
rate given; what another sensor measured comes from a table in or beside the folder.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.estimating.contenders import Contender, contenders, what_ours_lack
from bench.estimating.estimates_place import check_estimates_place
from bench.estimating.estimation import tell_of
from bench.estimating.foreign_images import images_by_stream, read_foreign_image, read_header
from bench.estimating.foreign_knowledge import GivenFiles, beside, foreign_knowledge
from bench.estimating.runner import estimate_run
from models.camera import Camera
from models.dataset.detector_file import PLAIN, read_detector
from models.dataset.frame_table import FILE_NAME, FrameEntry, read_frame_entries
from models.dataset.sensor_table import read_table
from models.dataset.version1 import PAIR_GAP_S
from models.errors import DatasetError, ScenarioError
from models.frame import CHASER_ORBIT, IMAGE_800, Frame, ImageReading, Reading, TableReading
from models.motion.relative_state import CHASER_ORBIT_COLUMNS
from pipelines.registry import OURS, registered_pipeline

UNKNOWN_EXPOSURE_MS = 1.0  # no pipeline measures with it
OFFSETS_S = {IMAGE_800: -PAIR_GAP_S}
NAVIGATION = "navigation.csv"


@dataclass(frozen=True)
class ForeignFrame:
    """The images of one frame on disk, by stream."""

    entry: FrameEntry
    paths: dict[str, Path]


def estimate_frames(
    folder: Path,
    camera: Camera,
    given: GivenFiles,
    rate_hz: float,
    out: Path,
    pipelines: Sequence[str] = (),
    limit_s: float | None = None,
) -> list[Path]:
    """Estimate every frame of a folder with every variant of every pipeline that they suit.

    Parameters
    ----------
    folder : Path
        Of images.
    camera : Camera
        As calibrated.
    given : GivenFiles
        What is known besides.
    rate_hz : float, Hz
        Where the folder has no ``frames.csv``.
    out : Path
        The estimates go to ``out/estimates``.
    pipelines : sequence of str
        Labels or names of pipelines; all that suit unless given.
    limit_s : float, optional, s
        Most that a frame may take.

    Returns
    -------
    list of Path
        The estimates files.

    Raises
    ------
    DatasetError, ScenarioError
        If the images or what is known cannot be used, or nobody can work with them.
    """
    if not 0.0 < rate_hz < np.inf:
        raise ScenarioError(f"expected a rate in Hz above zero, got {rate_hz}")
    found = find_frames(folder, rate_hz)
    check_estimates_place(out, folder)
    has_jpegs = check_headers(found, camera)
    tables = tables_beside(folder, [each.entry for each in found], given.navigation)
    in_colour = given.detector is not None and read_detector(given.detector).mosaic != PLAIN
    chosen = _taking_part([*found[0].paths, *tables], pipelines, in_colour)
    knowledge = foreign_knowledge(folder, list(found[0].paths.values())[-1], camera, given)
    if has_jpegs:
        print(
            "rvbench: warning: there are JPEGs among these images, whose compression moves the "
            "centroids of markers; their sigmas know nothing of it. Write PNG or TIFF if you can",
            file=sys.stderr,
        )
    frames = read_frames(found, camera, tables)
    return estimate_run(out, 0, frames, knowledge, chosen, len(found), limit_s)


def _taking_part(streams: list[str], asked: Sequence[str], in_colour: bool) -> list[Contender]:
    suited = {name for name in OURS if registered_pipeline(name).in_colour == in_colour}
    own = [name for name in OURS if name in suited or name in asked]
    chosen, remarks = contenders(streams, own, asked)
    tell_of(remarks)
    if not chosen:
        raise ScenarioError(
            f"expected frames that some pipeline takes, got {', '.join(streams)}: "
            f"{what_ours_lack(streams, own)}. Images "
            f"of a pair are called NAME_800 and NAME_850; {CHASER_ORBIT} is the chaser's orbit as "
            f"its navigation has it: write index, time_s, {', '.join(CHASER_ORBIT_COLUMNS)} into "
            f"{NAVIGATION} in or beside the folder"
        )
    return chosen


def find_frames(folder: Path, rate_hz: float) -> list[ForeignFrame]:
    """List the frames of a folder, in order of name.

    Raises
    ------
    DatasetError
        If there are none, one of a pair is missing, or ``frames.csv`` has another number of rows.
    """
    found = images_by_stream(folder)
    everywhere = {name for own in found.values() for name in own}
    for stream, own in found.items():
        if alone := sorted(everywhere - set(own)):
            _, name = next((s, each[alone[0]]) for s, each in found.items() if alone[0] in each)
            band = stream.rpartition("_")[2]
            raise DatasetError(
                f"{folder}: expected {alone[0]}_{band}{name.suffix} beside {name.name}, found "
                f"none (images without one at {band} nm: {len(alone)}); add it, or take the other "
                "away"
            )
    names = sorted(everywhere, key=_natural)
    entries = [FrameEntry(k, k / rate_hz, UNKNOWN_EXPOSURE_MS) for k in range(len(names))]
    table = beside(folder, FILE_NAME, None)
    if table is not None:
        entries = read_frame_entries(table.parent)
        if len(entries) != len(names):
            raise DatasetError(
                f"{table}: expected one row for each of {len(names)} frames, got {len(entries)}"
            )
    return [
        ForeignFrame(entry, {stream: own[name] for stream, own in found.items()})
        for entry, name in zip(entries, names, strict=True)
    ]


def tables_beside(
    folder: Path, entries: list[FrameEntry], navigation: Path | None = None
) -> dict[str, dict[int, TableReading]]:
    """Read what other sensors measured, by stream and frame, from tables in or beside a folder.

    Parameters
    ----------
    folder : Path
        Of images.
    entries : list of FrameEntry
        Of the frames.
    navigation : Path, optional
        The chaser's orbit; looked for unless given.

    Raises
    ------
    DatasetError
        If a table that is there cannot be read; see ``models.dataset.sensor_table``.
    """
    path = beside(folder, NAVIGATION, navigation)
    if path is None:
        return {}
    return {CHASER_ORBIT: read_table(path, CHASER_ORBIT_COLUMNS, entries)}


def read_frames(
    found: list[ForeignFrame],
    camera: Camera,
    tables: dict[str, dict[int, TableReading]] | None = None,
) -> Iterator[Frame]:
    """Read frames one at a time.

    Parameters
    ----------
    found : list of ForeignFrame
    camera : Camera
        As calibrated.
    tables : dict of dict, optional
        As ``tables_beside`` reads them.

    Raises
    ------
    DatasetError
        If an image is not whole, not grey, not of the camera's size or of another depth than the
        first.
    """
    first_bits = None
    for frame in found:
        entry, readings = frame.entry, dict[str, Reading]()
        for stream, path in frame.paths.items():
            image = read_foreign_image(path)
            first_bits = first_bits or image.bits
            _check_size(path, image.pixels.shape[1], image.pixels.shape[0], camera)
            _check_bits(path, image.bits, first_bits)
            time_s = entry.time_s + OFFSETS_S.get(stream, 0.0)
            readings[stream] = ImageReading(image.pixels, time_s, entry.exposure_ms)
        readings.update({stream: own[entry.index] for stream, own in (tables or {}).items()})
        yield Frame(entry.index, entry.time_s, readings)


def check_headers(found: list[ForeignFrame], camera: Camera) -> bool:
    """Refuse images of another size than the camera's, or of two depths, before the first is read.

    PNGs alone tell both in their first bytes; ``read_frames`` looks at all.

    Returns
    -------
    bool
        Whether there are JPEGs among them.

    Raises
    ------
    DatasetError
        The message names the file.
    """
    first_bits, has_jpegs = None, False
    for path in (path for frame in found for path in frame.paths.values()):
        header = read_header(path)
        has_jpegs |= header.is_jpeg
        if header.bits is not None:
            first_bits = first_bits or header.bits
            _check_size(path, *header.size, camera)
            _check_bits(path, header.bits, first_bits)
    return has_jpegs


def _check_size(path: Path, width: int, height: int, camera: Camera) -> None:
    if (width, height) != (camera.width, camera.height):
        raise DatasetError(
            f"{path}: expected {camera.width} x {camera.height} pixels, as the camera has, "
            f"got {width} x {height}; give the camera that took them"
        )


def _check_bits(path: Path, bits: int, first: int) -> None:
    if bits != first:
        raise DatasetError(
            f"{path}: expected {first} bits, as the first image of the folder has, got {bits}; "
            "one detector took them all: write them all alike"
        )


def _natural(name: str) -> tuple[tuple[int, str], ...]:
    parts = re.split(r"(\d+)", name)
    return tuple((int(part), "") if part.isdigit() else (-1, part) for part in parts)
