"""The public half of a dataset folder, opened: what a flight computer gets. Truth lies elsewhere.

::

    DIR/dataset.json          what it is of, its streams and files; see ``description``
        frames.csv            index, time_s, exposure_ms
        camera.toml, ...      what is on board before the first frame; see ``onboard_files``
        frames/...png         images: 12-bit DN, say, in 16-bit files
        navigation.csv, ...   tables of other sensors; see ``sensor_table``
        truth/                behind the wall: see ``renders.truth``
        estimates/            what the pipelines said: see ``estimates_file``
"""

from __future__ import annotations

import bisect
import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from models.dataset.description import FILE_NAME, DatasetInfo, Stream, read_info
from models.dataset.estimates_file import read_estimates
from models.dataset.frame_table import FILE_NAME as FRAME_TABLE
from models.dataset.frame_table import FrameEntry, read_frame_entries
from models.dataset.image_file import check_image_size, read_image
from models.dataset.onboard_files import read_onboard
from models.dataset.sensor_table import read_table
from models.dataset.version1 import HASHED_IN_VERSION_1
from models.errors import DatasetError
from models.estimate import Estimate
from models.frame import Frame, ImageReading, Reading, TableReading
from models.onboard import OnboardKnowledge


@dataclass(frozen=True, eq=False)
class Dataset:
    """A dataset that is whole, as far as its lists tell; open it with ``open_dataset``.

    Attributes
    ----------
    folder : Path
    info : DatasetInfo
    entries : list of FrameEntry
        The rows of ``frames.csv``, in time.
    """

    folder: Path
    info: DatasetInfo
    entries: list[FrameEntry]

    @cached_property
    def onboard(self) -> OnboardKnowledge:
        """What is on board before the first frame, in run 0."""
        return self.onboard_in(None)

    def onboard_in(self, run_folder: Path | None) -> OnboardKnowledge:
        """Return what is on board in a run whose own files lie in a folder.

        Raises
        ------
        DatasetError, ScenarioError
            If a file is missing or cannot be.
        """
        return read_onboard(self.folder, self.info.onboard, run_folder)

    @property
    def indices(self) -> list[int]:
        """The numbers of the frames, in time."""
        return [entry.index for entry in self.entries]

    def entry(self, index: int) -> FrameEntry:
        """Return a frame's row.

        Raises
        ------
        DatasetError
            If there is no such frame.
        """
        indices = self.indices
        place = bisect.bisect_left(indices, index)
        if place < len(indices) and indices[place] == index:
            return self.entries[place]
        raise DatasetError(
            f"{self.folder}: expected one of its {len(indices)} frames "
            f"({indices[0]} to {indices[-1]}), got {index}"
        )

    def frame(self, index: int) -> Frame:
        """Read one frame.

        Raises
        ------
        DatasetError
            If there is no such frame, or a file of it is missing or damaged.
        """
        return self._frame(self.entry(index))

    def frames(self) -> Iterator[Frame]:
        """Read all frames, in order, one at a time.

        Raises
        ------
        DatasetError
            If a file is missing or damaged.
        """
        for entry in self.entries:
            yield self._frame(entry)

    def check_images(self) -> None:
        """Refuse images that are not of the camera's size; only their headers are read.

        Where no camera is on board, images may have any size.

        Raises
        ------
        DatasetError
            The message names the file.
        """
        camera = self.onboard.camera
        if camera is None:
            return
        for stream in self.info.image_streams:
            for entry in self.entries:
                check_image_size(stream.path(self.folder, entry.index), camera)

    def fingerprint(self) -> str:
        """Return a hash of the public half but its images, as hexadecimal text."""
        if self.info.version == 1:
            return _hash_of([self.folder / name for name in HASHED_IN_VERSION_1])
        files = [each.files for each in self.info.streams if each.kind != "image"]
        return _hash_of([self.folder / name for name in self._listed(files)])

    def content_fingerprint(self) -> str:
        """Return a hash of the public half, its images too."""
        files = [each.files for each in self.info.streams if each.kind != "image"]
        images = [
            stream.path(self.folder, entry.index)
            for entry in self.entries
            for stream in self.info.image_streams
        ]
        return _hash_of([*(self.folder / name for name in self._listed(files)), *images])

    def _listed(self, files: list[str]) -> list[str]:
        return [FILE_NAME, FRAME_TABLE, *self.info.onboard, *files]

    def _frame(self, entry: FrameEntry) -> Frame:
        readings: dict[str, Reading] = {}
        for stream in self.info.streams:
            if stream.kind == "image":
                readings[stream.name] = self._image(stream, entry)
            elif stream.kind == "table":
                readings[stream.name] = self._tables[stream.name][entry.index]
            elif (said := self._estimated(stream, entry.time_s)) is not None:
                readings[stream.name] = said
        return Frame(entry.index, entry.time_s, readings)

    def _image(self, stream: Stream, entry: FrameEntry) -> ImageReading:
        image = read_image(stream.path(self.folder, entry.index), self.onboard.camera)
        return ImageReading(image, entry.time_s + stream.offset_s, entry.exposure_ms)

    @cached_property
    def _tables(self) -> dict[str, dict[int, TableReading]]:
        return {
            stream.name: read_table(stream.path(self.folder), stream.columns, self.entries)
            for stream in self.info.streams
            if stream.kind == "table"
        }

    @cached_property
    def _estimates(self) -> dict[str, list[Estimate]]:
        return {
            stream.name: read_estimates(stream.path(self.folder))
            for stream in self.info.streams
            if stream.kind == "estimates"
        }

    def _estimated(self, stream: Stream, time_s: float) -> Estimate | None:
        """Return the last estimate of a stream that is not later than a frame."""
        said = self._estimates[stream.name]
        place = bisect.bisect_right(said, time_s, key=lambda each: each.time_s)
        return said[place - 1] if place else None


def open_dataset(folder: Path) -> Dataset:
    """Open a dataset.

    Raises
    ------
    DatasetError
        If it is none, of another version, or has not all the frames that it says.
    """
    info, entries = read_info(folder), read_frame_entries(folder)
    if len(entries) != info.frames:
        raise DatasetError(
            f"{folder / FRAME_TABLE}: expected the {info.frames} frames that {FILE_NAME} tells "
            f"of, got {len(entries)}; run the render again, it goes on where it stopped"
        )
    return Dataset(folder, info, entries)


def _hash_of(paths: list[Path]) -> str:
    digest = hashlib.sha256()
    for path in paths:
        digest.update(path.read_bytes() if path.is_file() else b"")
    return digest.hexdigest()
