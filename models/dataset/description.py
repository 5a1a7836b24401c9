"""``dataset.json``: what a dataset is of, and which streams and on-board files it holds.

Version 1, which knew image pairs and single images alone, still reads; version 2 is written.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, TypeAlias

from models.dataset.version1 import FORMATS as FORMATS_OF_VERSION_1
from models.errors import DatasetError, UnreadableError
from models.reading.bounds import MOST_FRAMES, TIME_S
from models.reading.fields import Fields
from models.reading.json_file import read_json_table

FORMAT, VERSION = "rvbench-dataset", 2
FILE_NAME = "dataset.json"
Kind: TypeAlias = Literal["image", "table", "estimates"]
KINDS: tuple[Kind, ...] = ("image", "table", "estimates")
STREAM_NAME = re.compile(r"[a-z][a-z0-9_]{0,63}")
PLAIN_PATH = re.compile(r"(?!.*\.\.)[A-Za-z0-9][A-Za-z0-9_.\-/]*")
INDEX = "{index:06d}"


@dataclass(frozen=True)
class Stream:
    """One sensor's readings in a dataset.

    Attributes
    ----------
    name : str
    kind : str
        ``image``: a file a frame; ``table``: one CSV file; ``estimates``: another pipeline's file.
    files : str
        Path in the dataset; of images with ``{index:06d}`` where the frame's number stands.
    columns : tuple of str
        Of a table, beside ``index`` (of the frame that gets the row) and ``time_s``.
    offset_s : float, s
        Of images: middle of the exposure minus the frame's time.
    """

    name: str
    kind: Kind
    files: str
    columns: tuple[str, ...] = ()
    offset_s: float = 0.0

    def path(self, folder: Path, index: int = 0) -> Path:
        """Return the file of a frame, or that of all frames."""
        return folder / self.files.replace(INDEX, f"{index:06d}")


@dataclass(frozen=True)
class DatasetInfo:
    """What ``dataset.json`` says.

    Attributes
    ----------
    case : str
    sun : str
        Name of the Sun direction, or the vector as typed.
    frames : int
        How many there are when it is complete.
    target : str
    chain : str
        Name of the chain that judges it; see ``bench.chains``.
    streams : tuple of Stream
    onboard : tuple of str
        Files of what is on board before the first frame.
    provenance : dict
        Versions and hashes; nothing that tells a pose.
    version : int
        Of the format that it was read from.
    """

    case: str
    sun: str
    frames: int
    target: str
    chain: str
    streams: tuple[Stream, ...]
    onboard: tuple[str, ...]
    provenance: dict[str, str] = field(default_factory=dict)
    version: int = VERSION

    def stream(self, name: str) -> Stream:
        """Return a stream by name.

        Raises
        ------
        DatasetError
            If the dataset has none of that name.
        """
        for each in self.streams:
            if each.name == name:
                return each
        there = ", ".join(each.name for each in self.streams)
        raise DatasetError(f"expected a stream {name!r} in the dataset, got {there}")

    @property
    def image_streams(self) -> tuple[Stream, ...]:
        """Those of images, in order of time."""
        return tuple(each for each in self.streams if each.kind == "image")


def info_to_json(info: DatasetInfo) -> str:
    """Return the text of ``dataset.json``."""
    table = {
        "format": FORMAT,
        "version": VERSION,
        "case": info.case,
        "sun": info.sun,
        "frames": info.frames,
        "target": info.target,
        "chain": info.chain,
        "streams": {each.name: _stream_table(each) for each in info.streams},
        "onboard": list(info.onboard),
        "provenance": info.provenance,
    }
    return json.dumps(table, indent=2) + "\n"


def read_info(folder: Path) -> DatasetInfo:
    """Read ``dataset.json``.

    Raises
    ------
    DatasetError
        If it is missing, no dataset of ours, of another version, or a value cannot be.
    """
    path = folder / FILE_NAME
    try:
        table = read_json_table(path)
    except UnreadableError as error:
        raise DatasetError(
            f"expected a dataset in {folder}, with a {FILE_NAME}; got: {error}; "
            "`rvbench render` makes one"
        ) from error
    fields = Fields(table, path)
    version = (table.get("format"), table.get("version"))
    if version == (FORMAT, VERSION):
        return _info(fields, _streams(fields), _onboard(fields), fields.text("chain"))
    if version[1] == 1 and version[0] in FORMATS_OF_VERSION_1:
        old = FORMATS_OF_VERSION_1[version[0]]
        streams = tuple(Stream(**each) for each in old.streams)
        return _info(fields, streams, old.onboard, old.chain, version=1)
    known = ", ".join(FORMATS_OF_VERSION_1)
    raise DatasetError(
        f"{path}: expected format {FORMAT!r} of version {VERSION}, or version 1 of {known}, "
        f"got {version[0]!r} of version {version[1]!r}; is it ours? render it again, or read it "
        "with the rvbench that wrote it"
    )


def _info(
    fields: Fields,
    streams: tuple[Stream, ...],
    onboard: tuple[str, ...],
    chain: str,
    version: int = VERSION,
) -> DatasetInfo:
    provenance = fields.value("provenance")
    if not isinstance(provenance, dict):
        raise fields.refusal("provenance", "as a table", type(provenance).__name__)
    return DatasetInfo(
        case=fields.text("case"),
        sun=fields.text("sun"),
        frames=fields.whole("frames", 1, MOST_FRAMES),
        target=fields.text("target"),
        chain=chain,
        streams=streams,
        onboard=onboard,
        provenance={str(key): str(value) for key, value in provenance.items()},
        version=version,
    )


def _stream_table(stream: Stream) -> dict[str, Any]:
    table: dict[str, Any] = {"kind": stream.kind, "files": stream.files}
    if stream.kind == "image":
        table["offset_s"] = stream.offset_s
    if stream.kind == "table":
        table["columns"] = list(stream.columns)
    return table


def _streams(fields: Fields) -> tuple[Stream, ...]:
    told = fields.value("streams")
    if not isinstance(told, dict) or not told:
        raise fields.refusal("streams", "as a table with at least one stream", "none")
    streams = []
    for name in told:
        if not STREAM_NAME.fullmatch(name):
            raise fields.refusal("streams", "named by small letters, digits and _", repr(name))
        own = fields.table("streams").table(name)
        kind: Any = own.choice("kind", KINDS)
        files = own.text("files")
        if not PLAIN_PATH.fullmatch(files.replace(INDEX, "000000")) or (
            (kind == "image") != (INDEX in files)
        ):
            raise own.refusal(
                "files",
                f"as a path within the dataset, with {INDEX} for images and for nothing else",
                repr(files),
            )
        streams.append(
            Stream(
                name=name,
                kind=kind,
                files=files,
                columns=own.texts("columns", 1000) if kind == "table" else (),
                offset_s=own.number("offset_s", -TIME_S[1], TIME_S[1]) if kind == "image" else 0.0,
            )
        )
    return tuple(streams)


def _onboard(fields: Fields) -> tuple[str, ...]:
    names = fields.texts("onboard", 100)
    for name in names:
        if not PLAIN_PATH.fullmatch(name):
            raise fields.refusal("onboard", "as paths within the dataset", repr(name))
    return names
