"""SPEED submissions: ``filename,q0,q1,q2,q3,r0,r1,r2``, one image a row, mostly without a header.

``q`` is scalar first and ``r`` in m. SPEED's ``q_vbs2tango`` is a passive rotation from camera to
target, whose parts are those of the active one from target to camera: ``x_cam = R(q) x + r``. An
image is known by its file's name, as the dataset has it or as ``img000012.jpg``, with or without
its ending. Images without a row are lost.
"""

from __future__ import annotations

import re
from pathlib import PurePosixPath

from bench.estimating.foreign_estimates.said_poses import SaidPoses, place, quaternion
from models.dataset.dataset import Dataset
from models.errors import DatasetError, UnreadableError
from models.pose import RigidTransform
from models.reading.bounds import MOST_NAME
from models.reading.csv_table import CsvRow
from models.reading.shown import shown

COLUMNS = ("filename", "q0", "q1", "q2", "q3", "r0", "r1", "r2")
HEADER = ",".join(COLUMNS)
IMAGE_NAME = re.compile(r"img(\d{1,8})", re.ASCII)  # as in SPEED and SPEED+
PLAIN_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.\-]*", re.ASCII)


def read_speed_submission(lines: list[str], said: SaidPoses) -> None:
    """Read the lines of a submission.

    Parameters
    ----------
    lines : list of str
    said : SaidPoses
        Takes what it says.

    Raises
    ------
    UnreadableError, DatasetError
        If a row cannot be, is of no frame, or of one that came before.
    """
    frames = frames_by_name(said.dataset)
    for number, line in enumerate(lines, start=1):
        if not line.strip() or (number == 1 and line.replace(" ", "") == HEADER):
            continue
        cells = [cell.strip() for cell in line.split(",")]
        if len(cells) != len(COLUMNS):
            raise UnreadableError(
                said.path, f"expected {len(COLUMNS)} cells ({HEADER}), got {len(cells)}", number
            )
        row = CsvRow(dict(zip(COLUMNS, cells, strict=True)), f"{said.path}:{number}")
        rotation = quaternion(row, ("q0", "q1", "q2", "q3"))
        pose = RigidTransform(rotation, place(row, ("r0", "r1", "r2")))
        said.add(_frame(row, frames, said.dataset), pose, row.where)


def frames_by_name(dataset: Dataset) -> dict[str, int]:
    """Return the frames by the names of their images, with and without ending."""
    frames: dict[str, int] = {}
    for stream in dataset.info.image_streams:
        for index in dataset.indices:
            path = stream.path(dataset.folder, index)
            frames[path.name] = frames[path.stem] = index
    return frames


def _frame(row: CsvRow, frames: dict[str, int], dataset: Dataset) -> int:
    name = row.text("filename", MOST_NAME)
    if not PLAIN_NAME.fullmatch(name):
        raise row.refusal("filename", "as the plain name of an image, no folder", shown(name))
    stem = PurePosixPath(name).stem
    if (known := frames.get(name, frames.get(stem))) is not None:
        return known
    numbered = IMAGE_NAME.fullmatch(stem)
    if numbered:
        return int(numbered[1])
    example = next(iter(frames), f"img{dataset.indices[0]:06d}.jpg")
    raise DatasetError(
        f"{row.where}: expected filename as the dataset names its images, such as {example} or "
        f"img{dataset.indices[0]:06d}.jpg, got {shown(name)}"
    )
