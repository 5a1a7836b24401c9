"""One frame of a dataset laid open, as a picture: its chain knows how."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from bench.pictures.frame_record import FrameRecords
from bench.pictures.our_picture import marked
from models.atomic_file import sweep_beside, write_bytes
from models.errors import DatasetError


def show_frame(folder: Path, index: int, variant: str | None = None) -> NDArray[np.uint8]:
    """Draw one frame of a dataset with detections, estimate and truth.

    Parameters
    ----------
    folder : Path
        A dataset; estimates and truth are drawn where it has them.
    index : int
        The frame's number.
    variant : str, optional
        Whose estimates; see ``FrameRecords``.

    Returns
    -------
    (height, width, 3) uint8 array
        RGB.

    Raises
    ------
    DatasetError
        If there is no such frame, it cannot be read, or there is nothing to show of it.
    """
    records = FrameRecords(folder, variant)
    drawn = records.chain.show(records.record(index))
    if drawn is None:
        raise DatasetError(
            f"{folder}: expected a frame that the chain {records.chain.name} has a picture of, "
            f"got {index}"
        )
    return drawn


def write_frame(folder: Path, index: int, out: Path, variant: str | None = None) -> None:
    """Draw one frame into a PNG file; see ``show_frame``.

    Parameters
    ----------
    folder : Path
    index : int
    out : Path
    variant : str, optional

    Raises
    ------
    DatasetError
        If there is no such frame or it cannot be read.
    StorageError
        If the file cannot be written.
    """
    write_picture(show_frame(folder, index, variant), out)


def write_picture(picture: NDArray[np.uint8], out: Path) -> None:
    """Write an RGB picture, (height, width, 3), as a PNG file; see ``bench.pictures.our_picture``.

    Raises
    ------
    StorageError
        If the file cannot be written.
    ValueError
        If OpenCV refuses the picture.
    """
    ok, data = cv2.imencode(".png", picture[:, :, ::-1])
    if not ok:
        raise ValueError(f"expected OpenCV to encode a picture of {picture.shape}, it refused")
    sweep_beside(out)
    write_bytes(out, marked(bytes(data.tobytes())))
