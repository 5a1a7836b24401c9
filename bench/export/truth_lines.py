"""``truth/exposures.jsonl``, line by line: what a chain seals of an exposure, as far as it goes.

A record is of an image by its name, so that it serves every chain that names its files as renders
do. Of its keys those are read that labels need; a chain that seals less has poorer labels.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from models.arrays import Floats, Mask
from models.errors import DatasetError, UnreadableError
from models.pose import RigidTransform
from models.reading.bounds import FRAME, LENGTH_M, TIME_S, UNIT
from models.reading.fields import Fields
from models.reading.json_file import parse_json_line
from models.reading.regular_file import MOST_LINE_BYTES, read_beginning
from renders.truth.exposure_truth import FAR_PX, MEND, direction
from renders.world.exposure import FILTERED, exposure_name

BANDS = (0, 100_000)
POSE = ("R_cam_from_target", "t_cam_from_target_m")


@dataclass(frozen=True, eq=False)
class SealedExposure:
    """What the truth tells of one exposure; what it does not tell is None.

    Attributes
    ----------
    time_s : float, s
    cam_from_target : RigidTransform or None
    sun_dir_in_target : (3,) array or None
    landmarks_px : (m, 2) array or None, px
        NaN behind the camera.
    landmarks_visible : (m,) array of bool or None
    marker_visible, marker_lit : (n,) arrays or None
        Shares of each marker's face that the lens sees, and that Sun or lamps reach.
    """

    time_s: float
    cam_from_target: RigidTransform | None
    sun_dir_in_target: Floats | None
    landmarks_px: Floats | None
    landmarks_visible: Mask | None
    marker_visible: Floats | None
    marker_lit: Floats | None


@dataclass(frozen=True, eq=False)
class TruthLines:
    """The sealed records of a dataset, each read when it is asked for.

    Attributes
    ----------
    path : Path
    places : dict of str to (int, int)
        Line number and first byte, by the name of the exposure's files.
    farthest_m : float, m
        The largest distance between camera and target.
    """

    path: Path
    places: dict[str, tuple[int, int]] = field(default_factory=dict)
    farthest_m: float = 0.0

    def get(self, name: str) -> SealedExposure | None:
        """Return what is sealed of the exposure whose files have a name; None if nothing is.

        Raises
        ------
        DatasetError
            If the record cannot be read, or a value cannot be.
        """
        if name not in self.places:
            return None
        number, place = self.places[name]
        with self.path.open("rb") as file:
            file.seek(place)
            text = file.readline(MOST_LINE_BYTES)
        return _sealed(_fields(self.path, text, number))


def find_truth_lines(folder: Path) -> TruthLines:
    """Find every record of a dataset; none where it has no truth of that kind.

    Raises
    ------
    DatasetError
        If a line cannot be read, names no frame, or names an exposure twice.
    """
    path = folder / "truth" / "exposures.jsonl"
    if not path.exists():
        return TruthLines(path)
    read_beginning(path, 1)  # refuses what is no regular file
    places: dict[str, tuple[int, int]] = {}
    farthest_m = 0.0
    for number, place, text in _lines(path):
        record = _fields(path, text, number)
        band = record.whole("band", *BANDS) if "band" in record else FILTERED
        name = exposure_name(record.whole("frame", *FRAME), band)
        if name in places:
            raise DatasetError(
                f"{path}:{number}: expected each frame and band once, got those of line "
                f"{places[name][0]} again; {MEND}"
            )
        places[name] = (number, place)
        if POSE[1] in record:
            way = record.vector(POSE[1], 3, *LENGTH_M)
            farthest_m = max(farthest_m, float(np.linalg.norm(way)))
    return TruthLines(path, places, farthest_m)


def _lines(path: Path) -> Iterator[tuple[int, int, bytes]]:
    place = 0
    with path.open("rb") as file:
        number = 0
        while text := file.readline(MOST_LINE_BYTES + 1):
            number += 1
            if len(text) > MOST_LINE_BYTES:
                raise DatasetError(
                    f"{path}:{number}: expected a line of at most {MOST_LINE_BYTES} bytes; {MEND}"
                )
            yield number, place, text
            place += len(text)


def _fields(path: Path, text: bytes, number: int) -> Fields:
    try:
        return Fields(parse_json_line(path, text.decode(), number), f"{path}:{number}")
    except (UnreadableError, UnicodeDecodeError) as error:
        told = error.reason if isinstance(error, UnreadableError) else "bytes that are no UTF-8"
        where = f"{path}:{number}"
        raise DatasetError(f"{where}: expected one exposure, got: {told}; {MEND}") from error


def _sealed(record: Fields) -> SealedExposure:
    def if_told(key: str, read: Any) -> Any:
        return read(key) if key in record else None

    def share(key: str) -> Floats:
        return record.vector(key, None, *UNIT)

    landmarks_px = if_told(
        "landmarks_px", lambda key: record.numbers(key, (None, 2), -FAR_PX, FAR_PX, holes=True)
    )
    seen = if_told("landmarks_visible", record.flags)
    if landmarks_px is not None and (seen is None or len(seen) != len(landmarks_px)):
        came = "none" if seen is None else len(seen)
        raise record.refusal("landmarks_visible", f"for each of {len(landmarks_px)}", came)
    lamps, sun = if_told("lamp_lit", share), if_told("sun_lit", share)
    return SealedExposure(
        time_s=record.number("time_s", *TIME_S),
        cam_from_target=record.pose(*POSE, *LENGTH_M) if POSE[0] in record else None,
        sun_dir_in_target=if_told("sun_dir_in_target", lambda key: direction(record, key)),
        landmarks_px=landmarks_px,
        landmarks_visible=None if seen is None else np.array(seen, dtype=np.bool_),
        marker_visible=if_told("visible", share),
        marker_lit=None if lamps is None or sun is None else np.maximum(lamps, sun),
    )
