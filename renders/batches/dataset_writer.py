"""Write a dataset: the public half, and the truth behind the wall, each file whole or not there."""

from __future__ import annotations

import json
import os
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np

from models.arrays import AnyArray, Image
from models.atomic_file import sweep_scratch, write_bytes, write_text
from models.dataset.description import (
    FILE_NAME,
    VERSION,
    DatasetInfo,
    info_to_json,
    read_info,
)
from models.dataset.frame_table import FrameEntry, frames_to_csv, read_frame_entries
from models.dataset.image_file import encode_image
from models.dataset.marker_file import markers_to_toml
from models.errors import DatasetError, UnreadableError
from models.markers import MarkerPattern
from models.output_folder import check_empty, check_place
from models.reading.json_file import read_json_table
from models.reading.regular_file import check_regular, read_text
from models.reading.shown import shown
from models.reading.toml_file import read_toml
from renders.store.radiance_store import KEY, RadianceStore
from renders.store.sealed_exr import read_exr, write_exr
from renders.truth.makers import SealedRecord
from renders.world.exposure import exposure_name
from renders.world.told import EXACT_CLOCK, ToldClock

if TYPE_CHECKING:  # it loads Mitsuba, which must wait until a variant is known to render
    from renders.truth.pixel_truth import PixelTruth

PNG_END = b"IEND\xaeB`\x82"
RECORD_END = b"}\n"
LEFT_OUT = "left out"
MOST_TOLD = 4  # settings that differ, in one message


def is_whole_png(path: Path) -> bool:
    """Tell whether a PNG is there to its last byte."""
    return _ends_with(path, PNG_END)


def _ends_with(path: Path, end: bytes) -> bool:
    try:
        check_regular(path)
        with path.open("rb") as file:
            file.seek(-len(end), os.SEEK_END)
            return file.read() == end
    except (OSError, UnreadableError):
        return False


def is_whole_record(path: Path) -> bool:
    """Tell whether one exposure's truth is there, a table of JSON in one line."""
    if not _ends_with(path, RECORD_END):
        return False
    try:
        return read_text(path).count("\n") == 1 and bool(read_json_table(path))
    except UnreadableError:
        return False


def check_folder(folder: Path, info: DatasetInfo, scenario: str) -> None:
    """Refuse what cannot take a dataset: a file, a folder with another, or with what is not ours.

    ``dataset.json`` is the first file to be written, so that a run killed at any moment goes on.

    Parameters
    ----------
    folder : Path
    info : DatasetInfo
        Of the dataset that is meant.
    scenario : str
        Its resolved scenario as TOML, so that what differs can be told.

    Raises
    ------
    DatasetError
        Nothing was changed.
    """
    check_place(folder)
    if not (folder / FILE_NAME).exists():
        check_empty(folder, "a dataset that rvbench made")
        return
    there = read_info(folder)
    version = read_json_table(folder / FILE_NAME)["version"]
    if version != VERSION:
        raise DatasetError(
            f"expected {folder} to be empty or to hold a dataset of version {VERSION}; it holds "
            f"one of version {version}, which still reads and scores but is not gone on with; "
            "nothing was changed: choose another --out"
        )
    if there.provenance.get("scenario") != info.provenance.get("scenario"):
        raise DatasetError(
            f"expected {folder} to be empty or to hold this very scenario ({_told(info)}); "
            f"it holds another ({_told(there)}{_in_what(there, info, folder, scenario)}); "
            "nothing was changed: choose another --out, or delete it"
        )


def image_path(folder: Path, index: int, band: int) -> Path:
    """Return where the image of one exposure lies in a dataset.

    Parameters
    ----------
    folder : Path
        The dataset.
    index : int
        Of the frame.
    band : int
        800, 850 or ``FILTERED``.
    """
    return folder / "frames" / f"{exposure_name(index, band)}.png"


def recorded_entries(folder: Path) -> list[FrameEntry]:
    """Return the rows of ``frames.csv`` in a folder; none if it is absent or damaged."""
    try:
        return read_frame_entries(folder)
    except DatasetError:
        return []


@dataclass(frozen=True, eq=False)
class DatasetWriter:
    """One dataset folder being filled; ``begin`` it first.

    Attributes
    ----------
    folder : Path
    info : DatasetInfo
    known : mapping of str to str
        Texts of the files that are on board before the first frame, by name; see
        ``renders.batches.public_half``.
    entries : list of FrameEntry
        Those known, in true time; the list may grow, see ``renders.detector.exposure_control``.
    labels : tuple of str
        Names of the part labels.
    scenario_toml : str
        The resolved scenario; it goes behind the wall, since it holds the motion.
    bands : tuple of int
        The exposures of a frame, in order of time.
    clock : ToldClock
        That on board, by which ``frames.csv`` goes.
    installed : MarkerPattern or None
        The markers as they are, where those on board are told otherwise.
    sealed : mapping of str to str
        Other texts behind the wall, by name.
    """

    folder: Path
    info: DatasetInfo
    known: Mapping[str, str]
    entries: list[FrameEntry]
    labels: tuple[str, ...]
    scenario_toml: str
    bands: tuple[int, ...]
    clock: ToldClock = EXACT_CLOCK
    installed: MarkerPattern | None = None
    sealed: Mapping[str, str] = field(default_factory=dict)

    def begin(self) -> None:
        """Write everything but the exposures, and sweep away what killed runs left half written.

        Raises
        ------
        DatasetError
            If the folder holds a dataset of another scenario, Sun or version.
        StorageError
            If it cannot be written.
        """
        check_folder(self.folder, self.info, self.scenario_toml)
        sweep_scratch(self.folder)
        texts = {
            FILE_NAME: info_to_json(self.info),
            **self.known,
            "truth/parts.json": json.dumps(self.labels) + "\n",
            "truth/scenario.toml": self.scenario_toml,
        }
        if self.installed is not None:
            texts["truth/markers.toml"] = markers_to_toml(self.installed)
        for name, text in {**texts, **self.sealed}.items():
            write_text(self.folder / name, text)
        self.write_frames()

    def write_frames(self) -> None:
        """Write the rows of ``frames.csv`` that are known."""
        stamped = [self.clock.stamped(entry) for entry in self.entries]
        write_text(self.folder / "frames.csv", frames_to_csv(stamped))

    def truth_path(self, frame: int, band: int) -> Path:
        """Return where one exposure's truth lies until the dataset is complete."""
        return self.folder / "truth" / "exposures" / f"{exposure_name(frame, band)}.json"

    def labels_path(self, frame: int, band: int) -> Path:
        """Return where one exposure's part labels lie."""
        return self.folder / "truth" / "labels" / f"{exposure_name(frame, band)}.png"

    def geometry_path(self, frame: int, band: int) -> Path:
        """Return where one exposure's depth and normals lie."""
        return self.folder / "truth" / "geometry" / f"{exposure_name(frame, band)}.exr"

    def has_exposure(self, frame: int, band: int) -> bool:
        """Tell whether everything of an exposure is there; its image is written last."""
        return (
            is_whole_png(image_path(self.folder, frame, band))
            and is_whole_png(self.labels_path(frame, band))
            and is_whole_record(self.truth_path(frame, band))
            and self.geometry_path(frame, band).is_file()
        )

    def write_exposure(self, image: Image, truth: SealedRecord) -> None:
        """Write an exposure's truth and then its image; the pixel truth must be there already.

        Parameters
        ----------
        image : (height, width) uint16 array, DN
        truth : SealedRecord
            It says which exposure.
        """
        text = json.dumps(truth.to_json()) + "\n"
        write_text(self.truth_path(truth.frame, truth.band), text)
        write_bytes(image_path(self.folder, truth.frame, truth.band), encode_image(image))

    def write_pixel_truth(self, frame: int, band: int, truth: PixelTruth, key: str) -> None:
        """Write labels, depth (float) and normals (half) of an exposure, as the store has them.

        Parameters
        ----------
        frame : int
        band : int
            800, 850 or ``FILTERED``.
        truth : PixelTruth
        key : str
            Under which the store has labels, depth and normals of this exposure.
        """
        normals = truth.normals_in_target.astype(np.float16)
        channels: dict[str, AnyArray] = {
            "Z": truth.depth_m,
            "NX": np.ascontiguousarray(normals[..., 0]),
            "NY": np.ascontiguousarray(normals[..., 1]),
            "NZ": np.ascontiguousarray(normals[..., 2]),
            "label": truth.labels.astype(np.float16),
        }
        write_exr(self.geometry_path(frame, band), channels, {KEY: key})
        self._write_labels(frame, band, channels["label"])

    def take_pixel_truth(self, frame: int, band: int, store: RadianceStore, key: str) -> bool:
        """Take labels, depth and normals of an exposure from a store.

        Parameters
        ----------
        frame : int
        band : int
            800, 850 or ``FILTERED``.
        store : RadianceStore
        key : str
            Of its entry.

        Returns
        -------
        bool
            False if the store has them not, or not whole; nothing is kept then.
        """
        place = self.geometry_path(frame, band)
        if not store.lend(key, place):
            return False
        channels = read_exr(place, {KEY: key})
        if channels is None:
            place.unlink()
            return False
        self._write_labels(frame, band, channels["label"])
        return True

    def _write_labels(self, frame: int, band: int, labels: AnyArray) -> None:
        ok, data = cv2.imencode(".png", np.rint(labels).astype(np.uint8))
        if not ok:
            raise DatasetError("expected OpenCV to encode the labels, it refused")
        write_bytes(self.labels_path(frame, band), bytes(data.tobytes()))

    def finish(self) -> None:
        """Join the exposures' truth into one file, in order of time."""
        lines = [
            read_text(self.truth_path(entry.index, band))
            for entry in self.entries
            for band in self.bands
        ]
        write_text(self.folder / "truth" / "exposures.jsonl", "".join(lines))


def _told(info: DatasetInfo) -> str:
    return f"{info.case}, Sun {info.sun}, frames: {info.frames}"


def _in_what(there: DatasetInfo, info: DatasetInfo, folder: Path, scenario: str) -> str:
    """Tell which settings differ, where name, Sun and frames are the same."""
    if _told(there) != _told(info):
        return ""
    try:
        old = dict(_settings(read_toml(folder / "truth" / "scenario.toml"), ""))
    except DatasetError:
        return ", with other settings"
    now = dict(_settings(tomllib.loads(scenario), ""))
    differ = [
        f"{key} {shown(old.get(key, LEFT_OUT))}, now {shown(now.get(key, LEFT_OUT))}"
        for key in dict.fromkeys([*old, *now])
        if old.get(key) != now.get(key)
    ]
    more = [f"and {len(differ) - MOST_TOLD} more"] if len(differ) > MOST_TOLD else []
    return f", with {'; '.join([*differ[:MOST_TOLD], *more]) or 'other settings'}"


def _settings(table: dict[str, Any], within: str) -> Iterator[tuple[str, Any]]:
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _settings(value, f"{within}{key}.")
        else:
            yield f"{within}{key}", value
