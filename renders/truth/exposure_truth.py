"""The sealed record: what really was, for each exposure.

It loads no renderer, so that scoring can read it; pipelines may not import it (an import
contract), and never need it (a test).

::

    DIR/truth/exposures.jsonl             one ``ExposureTruth`` a line, frame by frame, 800 then 850
        parts.json                        names of the labels: label k + 1 is part k, 0 is space
        labels/000000_850.png             part labels at pixel centres, uint8
        geometry/000000_850.exr           Z (m), NX, NY, NZ (target frame) at pixel centres
        scenario.toml                     the scenario with every default resolved
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from models.arrays import Floats
from models.errors import DatasetError, UnreadableError, cause
from models.pose import RigidTransform
from models.reading.bounds import FRAME, LENGTH_M, TIME_S, UNIT
from models.reading.fields import Fields
from models.reading.json_file import read_json, read_json_lines
from models.reading.regular_file import MEGABYTE

T = TypeVar("T")
UNIT_TOLERANCE = 1e-6  # of a direction's length
FAR_PX = 1e15  # a point almost beside the lens is projected this far out
MOST_TRUTH_BYTES = 4000 * MEGABYTE
MOST_PARTS = 254  # labels have eight bits
MEND = "render again: only what is missing is rendered, and this file is written anew"


@dataclass(frozen=True)
class ExposureTruth:
    """One exposure as it was.

    Attributes
    ----------
    frame : int
    band : int
        800 or 850; 0 of a single image.
    time_s : float, s
        Middle of the exposure.
    cam_from_target : RigidTransform
    sun_dir_in_target : (3,) array
        Unit vector towards the Sun.
    markers_px : (n, 2) array, px
        Projection of each marker's centre with the true camera; NaN behind the camera.
    marker_outlines_px : (n, 2) array, px
        Centre of area of each marker's projected outline: where a perfect area centroid would
        fall; differs from ``markers_px`` by the perspective of a circle.
    visible : (n,) array
        Share of each disc that the camera's lens sees and the image holds.
    lamp_lit : (n,) array
        Share of each disc that the lamps reach; of a painted dot, the Sun or they, whichever more.
    sun_lit : (n,) array
        Share of each disc that the centre of the Sun reaches; 0 where it faces away.
    """

    frame: int
    band: int
    time_s: float
    cam_from_target: RigidTransform
    sun_dir_in_target: Floats
    markers_px: Floats
    marker_outlines_px: Floats
    visible: Floats
    lamp_lit: Floats
    sun_lit: Floats

    def to_json(self) -> dict[str, Any]:
        """Return the JSON object of its line."""

        def nullable(pixels: Floats) -> list[list[float | None]]:
            return [[None if np.isnan(x) else float(x) for x in row] for row in pixels]

        return {
            "frame": self.frame,
            "band": self.band,
            "time_s": self.time_s,
            "R_cam_from_target": self.cam_from_target.rotation.tolist(),
            "t_cam_from_target_m": self.cam_from_target.translation.tolist(),
            "sun_dir_in_target": self.sun_dir_in_target.tolist(),
            "markers_px": nullable(self.markers_px),
            "marker_outlines_px": nullable(self.marker_outlines_px),
            "visible": self.visible.tolist(),
            "lamp_lit": self.lamp_lit.tolist(),
            "sun_lit": self.sun_lit.tolist(),
        }

    @classmethod
    def from_fields(cls, record: Fields) -> ExposureTruth:
        """Read it back.

        Raises
        ------
        DatasetError
            If a value is missing or cannot be.
        """
        shares = {name: record.vector(name, None, *UNIT) for name in SHARES}
        points = {
            name: record.numbers(name, (None, 2), -FAR_PX, FAR_PX, holes=True) for name in POINTS
        }
        if len({len(array) for array in (*shares.values(), *points.values())}) > 1:
            counts = ", ".join(f"{name} {len(array)}" for name, array in (points | shares).items())
            raise record.refusal("markers_px", "and all shares as one for each marker", counts)
        return cls(
            frame=record.whole("frame", *FRAME),
            band=record.whole("band", 0, 100_000),
            time_s=record.number("time_s", *TIME_S),
            cam_from_target=record.pose("R_cam_from_target", "t_cam_from_target_m", *LENGTH_M),
            sun_dir_in_target=direction(record, "sun_dir_in_target"),
            **points,
            **shares,
        )


POINTS = ("markers_px", "marker_outlines_px")
SHARES = ("visible", "lamp_lit", "sun_lit")


def direction(record: Fields, key: str) -> Floats:
    """Return a unit vector, (3,).

    Raises
    ------
    DatasetError
        If it has another length.
    """
    vector = record.vector(key, 3, -1.0 - UNIT_TOLERANCE, 1.0 + UNIT_TOLERANCE)
    length = float(np.linalg.norm(vector))
    if abs(length - 1.0) > UNIT_TOLERANCE:
        raise record.refusal(key, "as a unit vector", f"one of length {length:g}")
    return vector


def read_exposures(folder: Path) -> dict[tuple[int, int], ExposureTruth]:
    """Read the truth of a dataset, by (frame, band); see ``read_records``."""
    records = read_records(folder, ExposureTruth.from_fields)
    return {(truth.frame, truth.band): truth for truth in records}


def read_records(folder: Path, from_fields: Callable[[Fields], T]) -> list[T]:
    """Read the sealed records of a dataset, one a line.

    Raises
    ------
    DatasetError
        If the truth half is missing, a line of it cannot be read, or a frame and band come twice.
    """
    path = folder / "truth" / "exposures.jsonl"
    if not path.exists():
        raise DatasetError(
            f"expected the truth half of a dataset at {path}, found none; "
            "only datasets rendered here can be scored"
        )
    records: list[T] = []
    lines: dict[tuple[object, object], int] = {}
    try:
        tables = read_json_lines(path, MOST_TRUTH_BYTES)
    except UnreadableError as error:
        expected = f"expected text at {path}"
        if error.line is not None:
            expected = f"{path}:{error.line}: expected one exposure"
        raise DatasetError(f"{expected}, got: {error.reason}; {MEND}") from error
    for number, table in tables:
        record = Fields(table, f"{path}:{number}")
        try:
            records.append(from_fields(record))
        except DatasetError as error:
            said = str(error).removeprefix(f"{record.where}: expected ")
            raise DatasetError(f"{record.where}: expected one exposure: {said}; {MEND}") from error
        named = (table.get("frame"), table.get("band"))
        if named in lines:
            raise DatasetError(
                f"{path}:{number}: expected each frame and band once, got those of line "
                f"{lines[named]} again; {MEND}"
            )
        lines[named] = number
    return records


def read_part_names(folder: Path) -> tuple[str, ...]:
    """Return the names of the part labels; label k + 1 is name k.

    Raises
    ------
    DatasetError
        If the file cannot be read.
    """
    path = folder / "truth" / "parts.json"
    try:
        return Fields({"parts": read_json(path)}, path).texts("parts", MOST_PARTS)
    except UnreadableError as error:
        raise DatasetError(f"expected part names at {path}, got: {cause(error)}; {MEND}") from error
