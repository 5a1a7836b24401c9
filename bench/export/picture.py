"""Images as they leave: as recorded to the bit, or demosaiced, or in eight bits by a tone curve."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from bench.export.tone_curve import ToneCurve
from models.arrays import AnyArray
from models.dataset.image_file import MEND, MOST_IMAGE_BYTES
from models.errors import DatasetError, UnreadableError
from models.reading.regular_file import read_bytes

MOSAICS = {
    "rggb": cv2.COLOR_BayerRGGB2BGR,
    "grbg": cv2.COLOR_BayerGRBG2BGR,
    "gbrg": cv2.COLOR_BayerGBRG2BGR,
    "bggr": cv2.COLOR_BayerBGGR2BGR,
}
"""Filters over the upper left four pixels, row by row."""
PNG_BEGIN = b"\x89PNG\r\n\x1a\n"


@dataclass(frozen=True, eq=False)
class Picture:
    """An image that is to leave.

    Attributes
    ----------
    image : (height, width) or (height, width, 3) array
        Grey, or blue, green, red; 8 or 16 bits.
    png : bytes
        The same as a PNG file.
    """

    image: AnyArray
    png: bytes

    @property
    def is_grey(self) -> bool:
        """Whether it has one channel."""
        return self.image.ndim == 2

    def tiff(self) -> bytes:
        """Return it as a TIFF file.

        Raises
        ------
        DatasetError
            If OpenCV refuses it.
        """
        return encoded(self.image, ".tiff")


def picture_of(path: Path, curve: ToneCurve | None, mosaic: str | None) -> Picture:
    """Read an image and make of it what is to leave.

    Parameters
    ----------
    path : Path
    curve : ToneCurve, optional
        For eight bits; the bits that were recorded leave without one.
    mosaic : str, optional
        A key of ``MOSAICS``, of an image behind a Bayer filter; it leaves in colours.

    Raises
    ------
    DatasetError
        If it is no whole PNG, of neither 8 nor 16 bits, or has colours where a mosaic was said.
    """
    try:
        data = read_bytes(path, MOST_IMAGE_BYTES)
    except UnreadableError as error:
        raise DatasetError(f"expected an image at {path}, got: {error.told}; {MEND}") from error
    image = _decoded(data)
    if (
        image is None
        or image.dtype not in (np.uint8, np.uint16)
        or image.shape[2:] not in ((), (3,))
    ):
        raise DatasetError(
            f"expected a whole PNG at {path}, grey or of three colours, of 8 or 16 bits; got "
            f"{len(data)} bytes that are not; delete it and {MEND}"
        )
    if mosaic is None and (curve is None or image.dtype == np.uint8):
        return Picture(image, data)
    if mosaic is not None:
        if image.ndim != 2:
            raise DatasetError(
                f"{path}: expected a raw image for --demosaic {mosaic}, got one that has colours; "
                "leave the option out"
            )
        image = cv2.cvtColor(image, MOSAICS[mosaic])
    if curve is not None and image.dtype != np.uint8:
        image = curve.applied(image)
    return Picture(image, encoded(image, ".png"))


def encoded(image: AnyArray, ending: str) -> bytes:
    """Return an image file's bytes.

    Parameters
    ----------
    image : (height, width) or (height, width, 3) array
    ending : str
        ``.png`` or ``.tiff``.

    Raises
    ------
    DatasetError
        If OpenCV refuses it.
    """
    ok, data = cv2.imencode(ending, image)
    if not ok:
        raise DatasetError(f"expected to encode an image of shape {image.shape}, OpenCV refused")
    return bytes(data.tobytes())


def _decoded(data: bytes) -> AnyArray | None:
    if not data.startswith(PNG_BEGIN):
        return None
    try:
        return cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:  # a size beyond all that OpenCV takes
        return None
