"""One image of a dataset: a 16-bit grey PNG."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from models.arrays import Image
from models.camera import Camera
from models.errors import DatasetError, UnreadableError
from models.reading.regular_file import read_beginning, read_bytes

PNG_BEGIN, PNG_END = b"\x89PNG\r\n\x1a\n", b"IEND\xaeB`\x82"
HEADER_BYTES = 33
MOST_IMAGE_BYTES = 1_000_000_000
MEND = "render again: only what is missing is rendered"


def encode_image(image: Image) -> bytes:
    """Return a (height, width) uint16 image as PNG.

    Raises
    ------
    DatasetError
        If OpenCV refuses it.
    """
    ok, data = cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 1])
    if not ok:
        raise DatasetError(f"expected to encode an image of shape {image.shape}, OpenCV refused")
    return bytes(data.tobytes())


def read_image(path: Path, camera: Camera | None = None) -> Image:
    """Read one 16-bit image, (height, width), DN.

    Parameters
    ----------
    path : Path
    camera : Camera, optional
        That took it: it must be of its size.

    Raises
    ------
    DatasetError
        If the file is missing, no regular file, truncated, not a 16-bit single-channel PNG, or of
        another size.
    """
    try:
        data = read_bytes(path, MOST_IMAGE_BYTES)
    except UnreadableError as error:
        raise DatasetError(f"expected an image at {path}, got: {error.told}; {MEND}") from error
    whole = png_size(data) is not None and data.rstrip(b"\0").endswith(PNG_END)
    if whole and camera is not None:
        _check_size(path, data, camera)
    image = decoded_png(data) if whole else None
    if image is None:
        raise DatasetError(
            f"expected a whole PNG at {path}, got {len(data)} bytes that are not; "
            f"delete it and {MEND}"
        )
    if image.ndim != 2 or image.dtype != np.uint16:
        raise DatasetError(
            f"expected a 16-bit single-channel image at {path}, "
            f"got shape {image.shape} of {image.dtype}; "
            "images of other kinds are read by `rvbench estimate --frames`"
        )
    return np.asarray(image)


def check_image_size(path: Path, camera: Camera) -> None:
    """Refuse an image that is not of its camera's size; only its header is read.

    Raises
    ------
    DatasetError
    """
    try:
        header = read_beginning(path, HEADER_BYTES)
    except UnreadableError as error:
        raise DatasetError(f"expected an image at {path}, got: {error.told}; {MEND}") from error
    _check_size(path, header, camera)


def _check_size(path: Path, data: bytes, camera: Camera) -> None:
    size = png_size(data)
    if size != (camera.width, camera.height):
        told = "no PNG" if size is None else f"{size[0]} x {size[1]}"
        raise DatasetError(
            f"{path}: expected {camera.width} x {camera.height} pixels, as camera.toml has, "
            f"got {told}; give the camera that took them, or {MEND}"
        )


def png_size(data: bytes) -> tuple[int, int] | None:
    """Return the width and height that a PNG says it has; None if it is no PNG."""
    if len(data) < HEADER_BYTES or not data.startswith(PNG_BEGIN):
        return None
    return int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")


def decoded_png(data: bytes) -> Image | None:
    """Return the (height, width) image that bytes hold; None if they hold none."""
    try:
        return cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:  # a size beyond all that OpenCV takes
        return None
