"""The sealed record: what really was, for each exposure.

It loads no renderer, so that scoring can read it; pipelines may not import it (an import
contract), and never need it (a test).

::

    DIR/truth/exposures.jsonl             one ``ExposureTruth`` a line, frame by frame, 800 then 850
        parts.json                        names of the labels: label k + 1 is part k, 0 is space
        labels/000000_850.png             part labels at pixel centres, uint8
        geometry/000000_850.exr           Z (m), NX, NY, NZ (target frame) at pixel centres
        marker_windows/000000_850.exr     light groups around each marker, with --keep-light markers
        scenario.toml                     the scenario with every default resolved
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from models.arrays import Floats
from models.errors import DatasetError, cause
from models.pose import RigidTransform

T = TypeVar("T")
MEND = "render again: only what is missing is rendered, and this file is written anew"


@dataclass(frozen=True)
class ExposureTruth:
    """One exposure as it was.

    Attributes
    ----------
    frame : int
    band : int
        800 or 850.
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
        Share of each disc that the lamps reach.
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
    def from_json(cls, record: dict[str, Any]) -> ExposureTruth:
        """Read it back."""

        def floats(key: str) -> Floats:
            return np.array(record[key], dtype=np.float64)

        return cls(
            frame=int(record["frame"]),
            band=int(record["band"]),
            time_s=float(record["time_s"]),
            cam_from_target=RigidTransform(
                floats("R_cam_from_target"), floats("t_cam_from_target_m")
            ),
            sun_dir_in_target=floats("sun_dir_in_target"),
            markers_px=floats("markers_px"),
            marker_outlines_px=floats("marker_outlines_px"),
            visible=floats("visible"),
            lamp_lit=floats("lamp_lit"),
            sun_lit=floats("sun_lit"),
        )


def read_exposures(folder: Path) -> dict[tuple[int, int], ExposureTruth]:
    """Read the truth of a dataset, by (frame, band); see ``read_records``."""
    records = read_records(folder, ExposureTruth.from_json)
    return {(truth.frame, truth.band): truth for truth in records}


def read_records(folder: Path, from_json: Callable[[dict[str, Any]], T]) -> list[T]:
    """Read the sealed records of a dataset, one a line.

    Raises
    ------
    DatasetError
        If the truth half is missing or a line of it cannot be read.
    """
    path = folder / "truth" / "exposures.jsonl"
    if not path.is_file():
        raise DatasetError(
            f"expected the truth half of a dataset at {path}, found none; "
            "only datasets rendered here can be scored"
        )
    try:
        lines = path.read_text().splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise DatasetError(f"expected text at {path}, got: {cause(error)}; {MEND}") from error
    records = []
    for number, line in enumerate(lines, start=1):
        try:
            records.append(from_json(json.loads(line)))
        except (KeyError, TypeError, ValueError) as error:
            raise DatasetError(
                f"{path}:{number}: expected one exposure, got: {cause(error)}; {MEND}"
            ) from error
    return records


def read_part_names(folder: Path) -> tuple[str, ...]:
    """Return the names of the part labels; label k + 1 is name k."""
    path = folder / "truth" / "parts.json"
    try:
        return tuple(json.loads(path.read_text()))
    except (OSError, ValueError) as error:
        raise DatasetError(f"expected part names at {path}, got: {cause(error)}") from error
