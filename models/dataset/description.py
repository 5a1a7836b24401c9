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
from models.reading.bounds import MOST_FRAMES, MOST_PROSE
from models.reading.fields import Fields
from models.reading.json_file import read_json_table
from models.reading.shown import shown

FORMAT, VERSION = "rvbench-dataset", 2
OFFSET_S = (-60.0, 60.0)  # of an exposure from its frame
FILE_NAME = "dataset.json"
Kind: TypeAlias = Literal["image", "table", "estimates"]
KINDS: tuple[Kind, ...] = ("image", "table", "estimates")
STREAM_NAME = re.compile(r"[a-z][a-z0-9_]{0,63}")
PLAIN_PATH = re.compile(r"(?!.*\.\.)[A-Za-z0-9][A-Za-z0-9_.\-/]*")
INDEX = "{index:06d}"
COLUMN_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,63}")
OWN_COLUMNS = ("index", "time_s")
SEALED = "truth"
MOST_STREAMS, MOST_COLUMNS, MOST_PROVENANCE = 100, 1000, 100
KEYS_OF_VERSION_1 = (
    "format", "version", "case", "sun", "frames", "target", "provenance",
)  # fmt: skip
KEYS = (*KEYS_OF_VERSION_1, "chain", "streams", "onboard")
EXTRA_KEYS: dict[str, tuple[str, ...]] = {
    "image": ("offset_s",),
    "table": ("columns",),
    "estimates": (),
}


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
    name, version = table.get("format"), table.get("version")
    if (name, version, type(version)) == (FORMAT, VERSION, int):
        fields.only(KEYS)
        return _info(fields, _streams(fields), _onboard(fields), fields.text("chain"))
    old = FORMATS_OF_VERSION_1.get(name) if isinstance(name, str) else None
    if old is not None and version == 1 and type(version) is int:
        fields.only(KEYS_OF_VERSION_1)
        streams = tuple(Stream(**each) for each in old.streams)
        return _info(fields, streams, old.onboard, old.chain, version=1)
    known = ", ".join(FORMATS_OF_VERSION_1)
    raise DatasetError(
        f"{path}: expected format {FORMAT!r} of version {VERSION}, or version 1 of {known}, "
        f"got {shown(name)} of version {shown(version)}; is it ours? render it again, or read it "
        "with the rvbench that wrote it"
    )


def _info(
    fields: Fields,
    streams: tuple[Stream, ...],
    onboard: tuple[str, ...],
    chain: str,
    version: int = VERSION,
) -> DatasetInfo:
    provenance = fields.table("provenance")
    return DatasetInfo(
        case=fields.text("case"),
        sun=fields.text("sun"),
        frames=fields.whole("frames", 1, MOST_FRAMES),
        target=fields.text("target"),
        chain=chain,
        streams=streams,
        onboard=onboard,
        provenance={
            key: provenance.text(key, MOST_PROSE) for key in provenance.names(MOST_PROVENANCE)
        },
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
    told = fields.table("streams")
    names = told.names(MOST_STREAMS)
    if not names:
        raise fields.refusal("streams", "as a table with at least one stream", "none")
    streams = []
    for name in names:
        if not STREAM_NAME.fullmatch(name):
            raise fields.refusal("streams", "named by small letters, digits and _", shown(name))
        own = told.table(name)
        kind: Any = own.choice("kind", KINDS)
        own.only(("kind", "files", *EXTRA_KEYS[kind]))
        files = own.text("files")
        if not _is_public(files.replace(INDEX, "000000")) or (kind == "image") != (INDEX in files):
            raise own.refusal(
                "files",
                "as a path within the dataset's public half, "
                f"with {INDEX} for images and for nothing else",
                shown(files),
            )
        streams.append(
            Stream(
                name=name,
                kind=kind,
                files=files,
                columns=_columns(own) if kind == "table" else (),
                offset_s=own.number("offset_s", *OFFSET_S) if kind == "image" else 0.0,
            )
        )
    return tuple(streams)


def _columns(own: Fields) -> tuple[str, ...]:
    columns = own.texts("columns", MOST_COLUMNS)
    good = [each for each in columns if COLUMN_NAME.fullmatch(each) and each not in OWN_COLUMNS]
    if not columns or len(set(good)) < len(columns):
        raise own.refusal(
            "columns",
            f"as names of letters, digits and _, each once, beside {' and '.join(OWN_COLUMNS)}",
            shown(list(columns)),
        )
    return columns


def _is_public(path: str) -> bool:
    """Tell whether a path stays in the public half: neither out of the dataset nor at truth."""
    return bool(PLAIN_PATH.fullmatch(path)) and path.split("/")[0].lower() != SEALED


def _onboard(fields: Fields) -> tuple[str, ...]:
    names = fields.texts("onboard", 100)
    for name in names:
        if not _is_public(name):
            expected = "as paths within the dataset's public half"
            raise fields.refusal("onboard", expected, shown(name))
    if len(set(names)) < len(names):
        raise fields.refusal("onboard", "as paths, each once", shown(list(names)))
    return names
