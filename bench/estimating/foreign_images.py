"""Anybody's grey images: which files are meant, and what is in them, whatever wrote them."""

from __future__ import annotations

import re
import struct
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from models.arrays import Image
from models.errors import DatasetError, cause
from models.frame import IMAGE, IMAGE_800, IMAGE_850

SUFFIXES = ".png, .tif, .tiff, .jpg and .jpeg"
FLAGS = re.IGNORECASE | re.DOTALL
PAIR = re.compile(r"(?P<name>.*)_(?P<band>800|850)\.(png|tiff?|jpe?g)", FLAGS)
SINGLE = re.compile(r"(?P<name>.*)(?P<band>)\.(png|tiff?|jpe?g)", FLAGS)
PAIR_STREAMS = {"800": IMAGE_800, "850": IMAGE_850}
SINGLE_STREAMS = {"": IMAGE}
PNG, JPEG = b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff"
TIFF = (b"II*\0", b"MM\0*")
ENDS = {PNG: b"IEND\xaeB`\x82", JPEG: b"\xff\xd9"}
HEADER_BYTES = 26  # of a PNG, up to the bits of a channel
MOST_SHOWN = 3


@dataclass(frozen=True, eq=False)
class ForeignImage:
    """One image as it was found.

    Attributes
    ----------
    pixels : (height, width) uint16 array, DN
    bits : int
        8 or 16: of the file, not of the detector.
    """

    pixels: Image
    bits: int


@dataclass(frozen=True)
class Header:
    """What the first bytes of an image tell.

    Attributes
    ----------
    is_jpeg : bool
        Compressed with loss.
    size : (int, int), px
        Columns and rows; zeros unless it is a PNG.
    bits : int or None
        Of a channel; None unless it is a PNG.
    """

    is_jpeg: bool
    size: tuple[int, int] = (0, 0)
    bits: int | None = None


def images_by_stream(folder: Path) -> dict[str, dict[str, Path]]:
    """Return the images of a folder by stream, and by name without what tells the stream.

    Where any is called NAME_800 or NAME_850 they are pairs, and others are left alone; else every
    image is a frame of its own.

    Raises
    ------
    DatasetError
        If there are none, or two for one place; the message tells what is there.
    """
    files = sorted(folder.iterdir()) if folder.is_dir() else []
    for streams, pattern in ((PAIR_STREAMS, PAIR), (SINGLE_STREAMS, SINGLE)):
        found: dict[str, dict[str, Path]] = {stream: {} for stream in streams.values()}
        for path in files:
            named = pattern.fullmatch(path.name)
            if named is None or not path.exists():
                continue
            own, name = found[streams[named["band"]]], named["name"]
            if name in own:
                raise DatasetError(
                    f"{folder}: expected one image {path.stem}, found {own[name].name} and "
                    f"{path.name}; take one away"
                )
            own[name] = path
        if any(found.values()):
            return found
    raise DatasetError(
        f"expected images in {folder}: pairs NAME_800.png and NAME_850.png, or single ones of any "
        f"name, {_seen(folder, files)}"
    )


def read_foreign_image(path: Path) -> ForeignImage:
    """Read a grey image of 8 or 16 bits; three equal channels are one.

    Raises
    ------
    DatasetError
        If it is missing, truncated, or of another kind.
    """
    data = _bytes_of(path)
    is_jpeg, is_tiff = data.startswith(JPEG), data.startswith(TIFF)
    end = ENDS[JPEG if is_jpeg else PNG]
    whole = is_tiff or (data.startswith((PNG, JPEG)) and data.rstrip(b"\0").endswith(end))
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED) if whole else None
    if image is None:
        kind = "TIFF" if is_tiff else "JPEG" if is_jpeg else "PNG"
        raise DatasetError(
            f"expected a whole {kind} at {path}, got {len(data)} bytes that are not; copy it again"
        )
    if is_tiff and cv2.imcount(str(path)) > 1:
        raise DatasetError(f"{path}: expected one image in a file, got several pages")
    if image.ndim == 3 and (image[..., :3] == image[..., :1]).all():
        image = image[..., 0]
    if image.ndim != 2 or image.dtype not in (np.uint8, np.uint16):
        raise DatasetError(
            f"{path}: expected a grey image of 8 or 16 bits, got {image.dtype} of shape "
            f"{image.shape}; take the mean of the channels first"
        )
    return ForeignImage(image.astype(np.uint16), 8 * image.dtype.itemsize)


def read_header(path: Path) -> Header:
    """Read what the first bytes of an image tell.

    Raises
    ------
    DatasetError
        If it cannot be read.
    """
    data = _bytes_of(path, HEADER_BYTES)
    if len(data) < HEADER_BYTES or not data.startswith(PNG):
        return Header(data.startswith(JPEG))
    width, height, bits = struct.unpack(">IIB", data[16:25])
    return Header(False, (width, height), max(8, bits))


def _bytes_of(path: Path, most: int = -1) -> bytes:
    try:
        if path.exists() and not path.is_file():  # a pipe would never end
            raise DatasetError(f"expected an image at {path}, found something that is no file")
        with path.open("rb") as file:
            return file.read(most)
    except OSError as error:
        raise DatasetError(f"expected an image at {path}, got: {cause(error)}") from error


def _seen(folder: Path, files: list[Path]) -> str:
    if not folder.is_dir():
        return "found a file there" if folder.exists() else "found no such folder"
    if (folder / "dataset.json").is_file():
        return f"found a dataset: `rvbench estimate {folder}` reads it"
    if not files:
        return "found none: it is empty"
    kinds = Counter(path.suffix if path.is_file() else "folders" for path in files).most_common()
    told = ", ".join(f"{count} {kind or 'without a suffix'}" for kind, count in kinds[:MOST_SHOWN])
    shown = ", ".join(path.name for path in files[:MOST_SHOWN])
    return f"found none among {told}, such as {shown}; {SUFFIXES} are read, in any case"
