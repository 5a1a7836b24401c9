"""A table of poses that somebody else has computed: a CSV file whose header names the frames.

::

    time_s,t_cam_from_target_x_m,t_cam_from_target_y_m,t_cam_from_target_z_m,
        q_cam_from_target_w,q_cam_from_target_x,q_cam_from_target_y,q_cam_from_target_z

in one line, or the same eight with ``target_from_cam`` for ``cam_from_target``: each way says
which it is. Quaternions are scalar first. Beside them, where they are known: ``sun_x,sun_y,sun_z``,
the unit vector towards the Sun in target axes, ``exposure_ms``, and what stands behind:
``earth_x,earth_y,earth_z``, the unit vector towards the Earth's centre in target axes, three zeros
where there is none; and ``stars``, 1 where they are seen and 0 where not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from models.arrays import Floats, Mask
from models.errors import DatasetError
from models.pose import RigidTransform
from models.reading.bounds import EXPOSURE_MS, LENGTH_M
from models.reading.csv_table import CsvRow, csv_rows
from models.reading.regular_file import MEGABYTE, read_lines

WAYS = ("cam_from_target", "target_from_cam")
SUN = ("sun_x", "sun_y", "sun_z")
EARTH = ("earth_x", "earth_y", "earth_z")
EXPOSURE, STARS = "exposure_ms", "stars"
MOST_BYTES = 24 * MEGABYTE
MOST_ROWS = 100_000
ROUNDING_S = 1e-9  # of a time that was counted in frames
LATEST_S = 1e6  # as of every motion of a scenario
UNIT_TOLERANCE = 1e-3  # a quaternion typed with four digits is one


@dataclass(frozen=True, eq=False)
class PoseTable:
    """Poses at rising times, and what else is known of those times.

    Attributes
    ----------
    times_s : (n,) array, s
    poses : tuple of RigidTransform
        ``cam_from_target`` at each.
    sun_dirs_in_target : (n, 3) array or None
        Unit vectors towards the Sun.
    exposures_ms : (n,) array or None, ms
    earth_dirs_in_target : (n, 3) array or None
        Unit vectors towards the Earth's centre; zeros where there is no Earth.
    stars : (n,) array of bool or None
        Whether they are seen.
    """

    times_s: Floats
    poses: tuple[RigidTransform, ...]
    sun_dirs_in_target: Floats | None = None
    exposures_ms: Floats | None = None
    earth_dirs_in_target: Floats | None = None
    stars: Mask | None = None

    def __len__(self) -> int:
        return len(self.poses)


def pose_columns(way: str) -> tuple[str, ...]:
    """Return the eight columns of a way, ``cam_from_target`` or ``target_from_cam``."""
    place = [f"t_{way}_{axis}_m" for axis in "xyz"]
    return ("time_s", *place, *(f"q_{way}_{part}" for part in "wxyz"))


def read_pose_lines(path: Path) -> list[str]:
    """Return the lines of a table's file, empty ones at its end left out.

    Raises
    ------
    UnreadableError
        If it is no regular file, too large or no text.
    """
    lines = read_lines(path, MOST_BYTES)
    while lines and not lines[-1].strip():
        lines.pop()
    return lines


def pose_table(lines: Sequence[str], where: Path | str) -> PoseTable:
    """Read the lines of a table, its header first.

    Parameters
    ----------
    lines : sequence of str
    where : Path or str
        Where they stand, for messages.

    Raises
    ------
    DatasetError
        If the header names no frames or other columns, a number is none or cannot be, times do not
        rise, a quaternion or a Sun has not length one, or a target is not in front of the camera.
    """
    header = lines[0].split(",") if lines else []
    way = _way(header, where)
    rows = csv_rows(lines, where, pose_columns(way), (*SUN, EXPOSURE, *EARTH, STARS))
    if not 0 < len(rows) <= MOST_ROWS:
        raise DatasetError(f"{where}: expected 1 to {MOST_ROWS} rows, got {len(rows)}")
    times_s = [row.number("time_s", 0.0, LATEST_S, unit="s") for row in rows]
    for row, (before, after) in zip(rows[1:], pairwise(times_s), strict=True):
        if not after > before:
            raise row.refusal(
                "time_s", f"to rise, above {before:g} s of the row before", f"{after:g}"
            )
    suns, earths = _has_all(SUN, header, where), _has_all(EARTH, header, where)
    exposures_ms = None
    if EXPOSURE in header:
        exposures_ms = np.array([row.number(EXPOSURE, *EXPOSURE_MS, unit="ms") for row in rows])
    return PoseTable(
        times_s=np.array(times_s),
        poses=tuple(_pose(row, way) for row in rows),
        sun_dirs_in_target=np.stack([_sun(row) for row in rows]) if suns else None,
        exposures_ms=exposures_ms,
        earth_dirs_in_target=np.stack([_earth(row) for row in rows]) if earths else None,
        stars=np.array([_flag(row, STARS) for row in rows]) if STARS in header else None,
    )


def _has_all(names: Sequence[str], header: Sequence[str], where: Path | str) -> bool:
    """Tell whether columns that belong together are there; refuse some of them."""
    there = [name for name in names if name in header]
    if there and len(there) < len(names):
        raise DatasetError(
            f"{where}:1: expected all of the columns {', '.join(names)} or none of them, "
            f"got {', '.join(there)}"
        )
    return bool(there)


def _way(header: Sequence[str], where: Path | str) -> str:
    named = [way for way in WAYS if any(f"_{way}_" in name for name in header)]
    if len(named) != 1:
        got = f"both of {', '.join(named)}" if named else f"{', '.join(header)[:200] or 'nothing'}"
        raise DatasetError(
            f"{where}:1: expected a header that names the frames of the poses once: "
            f"{','.join(pose_columns(WAYS[0]))}, or the same with {WAYS[1]}; got {got}"
        )
    return named[0]


def _pose(row: CsvRow, way: str) -> RigidTransform:
    from scipy.spatial.transform import Rotation

    place = np.array([row.number(f"t_{way}_{axis}_m", *LENGTH_M, unit="m") for axis in "xyz"])
    wxyz = _unit(row, [f"q_{way}_{part}" for part in "wxyz"], "as a quaternion of length 1")
    turn = Rotation.from_quat(wxyz, scalar_first=True).as_matrix()
    pose = RigidTransform(turn, place)
    cam_from_target = pose if way == WAYS[0] else pose.inverse()
    depth_m = float(cam_from_target.translation[2])
    if not depth_m > 0.0:
        raise row.refusal(
            f"t_{way}_z_m",
            "of a target in front of the camera, which looks along +z",
            f"a target at z = {depth_m:g} m in camera axes; check which way the poses map, "
            "and the camera's axes (x right, y down, z forward)",
        )
    return cam_from_target


def _sun(row: CsvRow) -> Floats:
    return _unit(row, list(SUN), "as a vector of length 1 towards the Sun, in target axes")


def _earth(row: CsvRow) -> Floats:
    if not any(row.number(key, -2.0, 2.0) for key in EARTH):
        return np.zeros(3)
    expected = "as a vector of length 1 towards the Earth, in target axes, or three zeros"
    return _unit(row, list(EARTH), expected)


def _flag(row: CsvRow, key: str) -> bool:
    value = row.number(key, 0.0, 1.0)
    if value not in (0.0, 1.0):
        raise row.refusal(key, "as 0 or 1", f"{value:g}")
    return value == 1.0


def _unit(row: CsvRow, keys: list[str], expected: str) -> Floats:
    vector = np.array([row.number(key, -2.0, 2.0) for key in keys])
    length = float(np.linalg.norm(vector))
    if not abs(length - 1.0) <= UNIT_TOLERANCE:
        raise row.refusal(f"{keys[0]} to {keys[-1]}", expected, f"length {length:.6g}")
    return vector / length
