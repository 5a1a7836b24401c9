"""A frame as it was exposed once, with what it takes to give its markers another run's noise.

One file a frame and Sun, written whole or not at all; its folder's name holds the hash of all that
shapes it, so that a file that is there is done.
"""

from __future__ import annotations

import io
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from models.arrays import AnyArray, Image
from models.atomic_file import write_bytes
from models.errors import DatasetError, UnreadableError
from models.reading.fields import Fields
from models.reading.npz_file import read_npz
from models.reading.regular_file import MEGABYTE
from renders.detector.marker_windows import MarkerWindow
from renders.truth.exposure_truth import ExposureTruth

MOST_BYTES = 500 * MEGABYTE


@dataclass(frozen=True, eq=False)
class OnceExposed:
    """One frame.

    Attributes
    ----------
    index : int
    time_s : float, s
        True, of its last exposure.
    exposure_ms : float, ms
    images : dict of (height, width) uint16 arrays, DN
        By band.
    windows : dict of lists of MarkerWindow or None
        By band, then by marker.
    truth : ExposureTruth
        Of its last exposure.
    """

    index: int
    time_s: float
    exposure_ms: float
    images: dict[int, Image]
    windows: dict[int, list[MarkerWindow | None]]
    truth: ExposureTruth


def frame_path(folder: Path, sun: str, index: int) -> Path:
    """Return where a frame lies below the folder of its flight.

    Parameters
    ----------
    folder : Path
    sun : str
    index : int
    """
    return folder / sun / f"{index:06d}.npz"


def write_frame(path: Path, frame: OnceExposed) -> None:
    """Write a frame.

    Raises
    ------
    StorageError
        If the disk is full or read-only.
    """
    arrays: dict[str, Any] = {}
    told: list[dict[str, Any]] = []
    for band, image in frame.images.items():
        arrays[f"image_{band}"] = image
        for marker, window in enumerate(frame.windows[band]):
            if window is None:
                continue
            name = f"window_{band}_{marker}"
            arrays[name] = window.others
            arrays |= {f"{name}_{lamp}": rates for lamp, rates in window.lamps.items()}
            told.append(
                {
                    "band": band, "marker": marker, "top": window.top, "left": window.left,
                    "rim": window.rim, "lamps": list(window.lamps),
                }
            )  # fmt: skip
    table = {
        "index": frame.index,
        "time_s": frame.time_s,
        "exposure_ms": frame.exposure_ms,
        "truth": frame.truth.to_json(),
        "windows": told,
    }
    stream = io.BytesIO()
    np.savez_compressed(stream, **arrays, told=np.array(json.dumps(table)))
    write_bytes(path, stream.getvalue())


def read_frame(path: Path) -> OnceExposed:
    """Read a frame back.

    Raises
    ------
    DatasetError
        If it is missing or damaged.
    """
    try:
        arrays = read_npz(path, MOST_BYTES)
        table = json.loads(str(arrays.pop("told")))
    except (UnreadableError, ValueError, KeyError) as error:
        raise DatasetError(
            f"expected a frame at {path}, found it absent or damaged ({error}); delete it and run "
            "the same suite again: only what is missing is done"
        ) from error
    truth = ExposureTruth.from_fields(Fields(table["truth"], path))
    images = {
        int(name.removeprefix("image_")): array
        for name, array in arrays.items()
        if name.startswith("image_")
    }
    windows: dict[int, list[MarkerWindow | None]] = {
        band: [None] * len(truth.markers_px) for band in images
    }
    for own in table["windows"]:
        windows[own["band"]][own["marker"]] = _window(own, arrays)
    return OnceExposed(
        table["index"], table["time_s"], table["exposure_ms"], images, windows, truth
    )


def _window(own: dict[str, Any], arrays: dict[str, AnyArray]) -> MarkerWindow:
    name = f"window_{own['band']}_{own['marker']}"
    lamps = {lamp: arrays[f"{name}_{lamp}"] for lamp in own["lamps"]}
    return MarkerWindow(own["top"], own["left"], own["rim"], lamps, arrays[name])
