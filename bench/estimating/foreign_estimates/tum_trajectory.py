"""TUM trajectories: ``timestamp tx ty tz qx qy qz qw``, apart by spaces; ``#`` begins a remark.

As the RGB-D benchmark has it (Sturm et al. 2012) a row is the place and attitude of the camera in
the world, which here is the target: ``target_from_cam``. A trajectory of the target, as seen by the
camera, has to be named as such, for nothing in the file tells the two apart. A row belongs to the
frame whose time it has. Frames without a row are lost.
"""

from __future__ import annotations

import numpy as np

from bench.estimating.foreign_estimates.said_poses import (
    Choices,
    SaidPoses,
    place,
    quaternion,
)
from models.arrays import Floats
from models.dataset.dataset import Dataset
from models.errors import DatasetError, UnreadableError
from models.pose import RigidTransform
from models.reading.bounds import TIME_S
from models.reading.csv_table import CsvRow

COLUMNS = ("timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw")
WORDS = " ".join(COLUMNS)
SAME_INSTANT_S = 1e-3  # times typed with three decimals are of their frame
SHARE_OF_STEP = 0.1  # but never so far from it that the next frame is in doubt


def read_tum_trajectory(lines: list[str], said: SaidPoses, choices: Choices) -> None:
    """Read the lines of a trajectory.

    Parameters
    ----------
    lines : list of str
    said : SaidPoses
        Takes what it says.
    choices : Choices

    Raises
    ------
    UnreadableError, DatasetError
        If a row cannot be, its time is that of no frame, or that of a row before.
    """
    times_s = np.array([entry.time_s for entry in said.dataset.entries])
    step_s = float(np.diff(times_s).min(initial=np.inf))
    tolerance_s = min(SAME_INSTANT_S, SHARE_OF_STEP * step_s)
    for number, line in enumerate(lines, start=1):
        told = line.strip()
        if not told or told.startswith("#"):
            continue
        cells = told.split()
        if len(cells) != len(COLUMNS):
            raise UnreadableError(
                said.path, f"expected {len(COLUMNS)} numbers ({WORDS}), got {len(cells)}", number
            )
        row = CsvRow(dict(zip(COLUMNS, cells, strict=True)), f"{said.path}:{number}")
        rotation = quaternion(row, ("qw", "qx", "qy", "qz"))
        pose = RigidTransform(rotation, place(row, ("tx", "ty", "tz")))
        cam_from_target = pose.inverse() if choices.trajectory_of == "camera" else pose
        said.add(_frame(row, said.dataset, times_s, tolerance_s), cam_from_target, row.where)


def _frame(row: CsvRow, dataset: Dataset, times_s: Floats, tolerance_s: float) -> int:
    at_s = row.number("timestamp", *TIME_S, unit="s")
    after = int(np.searchsorted(times_s, at_s))
    near = [place for place in (after - 1, after) if 0 <= place < len(times_s)]
    nearest = min(near, key=lambda place: abs(float(times_s[place]) - at_s))
    index, frame_s = dataset.entries[nearest].index, float(times_s[nearest])
    if not abs(frame_s - at_s) <= tolerance_s:
        raise DatasetError(
            f"{row.where}: expected the time of a frame as frames.csv has it, in s, got {at_s!r}; "
            f"the nearest frame, {index}, is at {frame_s!r} s"
        )
    return index
