"""What comes in at one time: where tracks are in the image, a range, and how the camera stands.

As a ``Frame`` these are three tables: ``tracks`` (``track, u_px, v_px, sigma_px``),
``range_finder`` (``range_m, sigma_m``) and ``camera_attitude`` (``q_cam_from_lvlh_w`` to ``_z``),
the last from the chaser's attitude determination and the target's orbit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats, Indices, Mask
from models.errors import DatasetError
from models.frame import RANGE, Frame, TableReading
from models.sensors.range_finder import RANGE_COLUMNS

TRACKS, CAMERA_ATTITUDE = "tracks", "camera_attitude"
TRACK_COLUMNS = ("track", "u_px", "v_px", "sigma_px")
ATTITUDE_COLUMNS = tuple(f"q_cam_from_lvlh_{axis}" for axis in "wxyz")


@dataclass(frozen=True, eq=False)
class TrackedFrame:
    """The readings of one time.

    Attributes
    ----------
    index : int
    time_s : float, s
    R_cam_from_lvlh : (3, 3) array
        The camera with respect to the target's local frame.
    tracks : (m,) int array
        Names of the tracks seen, each once; a name that comes back is the same point.
    points_px : (m, 2) array, px
    sigma_px : (m,) array, px
        1 sigma per axis, as the tracker believes it.
    range_m, range_sigma_m : float or None, m
        Along the boresight.
    covered : (height, width) bool array or None
        The pixels that the target covers, where they are kept.
    """

    index: int
    time_s: float
    R_cam_from_lvlh: Floats
    tracks: Indices
    points_px: Floats
    sigma_px: Floats
    range_m: float | None = None
    range_sigma_m: float | None = None
    covered: Mask | None = None

    def as_frame(self) -> Frame:
        """Return the same as tables."""
        wxyz = Rotation.from_matrix(self.R_cam_from_lvlh).as_quat(scalar_first=True)
        rows = np.column_stack([self.tracks, self.points_px, self.sigma_px])
        readings = {
            TRACKS: TableReading(TRACK_COLUMNS, np.full(len(rows), self.time_s), rows),
            CAMERA_ATTITUDE: _one_row(ATTITUDE_COLUMNS, self.time_s, wxyz),
        }
        if self.range_m is not None and self.range_sigma_m is not None:
            row = np.array([self.range_m, self.range_sigma_m])
            readings[RANGE] = _one_row(RANGE_COLUMNS, self.time_s, row)
        return Frame(self.index, self.time_s, readings)


def seen(frame: Frame) -> TrackedFrame:
    """Return what a frame's tables say.

    Raises
    ------
    DatasetError
        If there are no tracks or there is no attitude, or a number cannot be.
    """
    table = frame.table(TRACKS)
    columns = [table.column(name) for name in TRACK_COLUMNS]
    rows = np.column_stack(columns) if len(table.time_s) else np.zeros((0, len(columns)))
    names = rows[:, 0].astype(np.int64)
    if len(np.unique(names)) != len(names) or not np.isfinite(rows).all():
        raise DatasetError(
            f"frame {frame.index}: expected each track once, its numbers finite, got {len(names)} "
            f"rows of {len(np.unique(names))} tracks; mend the stream {TRACKS!r}"
        )
    if not (rows[:, 3] > 0.0).all():
        raise DatasetError(f"frame {frame.index}: expected a sigma_px above zero for every track")
    attitude = frame.table(CAMERA_ATTITUDE)
    wxyz = np.array([attitude.column(name)[-1] for name in ATTITUDE_COLUMNS])
    if not abs(float(np.linalg.norm(wxyz)) - 1.0) < 1e-6:
        raise DatasetError(
            f"frame {frame.index}: expected a unit quaternion of the camera, got {wxyz.tolist()}"
        )
    range_m, range_sigma_m = range_of(frame)
    return TrackedFrame(
        frame.index,
        frame.time_s,
        Rotation.from_quat(wxyz, scalar_first=True).as_matrix(),
        names,
        rows[:, 1:3],
        rows[:, 3],
        range_m,
        range_sigma_m,
    )


def range_of(frame: Frame) -> tuple[float, float] | tuple[None, None]:
    """Return the last distance that a frame brings, and its sigma, m; None where it brings none.

    Raises
    ------
    DatasetError
        If it is none that a sensor can give.
    """
    table = frame.table(RANGE) if RANGE in frame.readings else None
    if table is None or not len(table.time_s):
        return None, None
    range_m, sigma_m = (float(table.column(name)[-1]) for name in RANGE_COLUMNS)
    if not 0.0 <= range_m < np.inf or not 0.0 < sigma_m < np.inf:
        raise DatasetError(
            f"frame {frame.index}: expected a range_m of at least zero and a sigma_m above zero, "
            f"both finite, got {range_m} and {sigma_m}; mend the stream {RANGE!r}"
        )
    return range_m, sigma_m


def _one_row(columns: tuple[str, ...], time_s: float, row: Floats) -> TableReading:
    return TableReading(columns, np.array([time_s]), row[None])
