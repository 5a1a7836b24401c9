"""SPEED submissions: ``filename,q0,q1,q2,q3,r0,r1,r2``, one image a row, mostly without a header.

``q`` is scalar first and ``r`` in m. SPEED's ``q_vbs2tango`` is a passive rotation from camera to
target, whose parts are those of the active one from target to camera: ``x_cam = R(q) x + r``. An
image is known by its file's name, with or without its ending: as the dataset has it, as its export
has it (``000001_000012_image_850.png``), or ``img000012.jpg``. Images without a row are lost. A
frame of several images is judged at its last, so that the poses of the others are left out.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import PurePosixPath

from bench.estimating.foreign_estimates.said_poses import Choices, SaidPoses, place, quaternion
from models.dataset.dataset import Dataset
from models.errors import DatasetError, UnreadableError
from models.pose import RigidTransform
from models.reading.bounds import MOST_NAME
from models.reading.csv_table import CsvRow
from models.reading.shown import shown

COLUMNS = ("filename", "q0", "q1", "q2", "q3", "r0", "r1", "r2")
HEADER = ",".join(COLUMNS)
IMAGE_NAME = re.compile(r"img(\d{1,8})", re.ASCII)  # as in SPEED and SPEED+
EXPORTED_NAME = re.compile(r"(\d{6})_(\d{6,8})(?:_([a-z][a-z0-9_]*))?", re.ASCII)
PLAIN_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.\-]*", re.ASCII)


@dataclass(frozen=True)
class ImageNamed:
    """The image that a row names.

    Attributes
    ----------
    frame : int
    stream : str
        Empty where a name tells none.
    scene : int or None
        Of an export; None where a name is none of an export's.
    """

    frame: int
    stream: str = ""
    scene: int | None = None


def read_speed_submission(lines: list[str], said: SaidPoses, choices: Choices) -> None:
    """Read the lines of a submission.

    Parameters
    ----------
    lines : list of str
    said : SaidPoses
        Takes what it says.
    choices : Choices

    Raises
    ------
    UnreadableError, DatasetError
        If a row cannot be, is of no frame, or of one that came before; if scenes of an export are
        several and none was chosen.
    """
    names = names_of_images(said.dataset)
    rows: list[tuple[ImageNamed, RigidTransform, CsvRow]] = []
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
        rows.append((_named(row, names, said.dataset), pose, row))
    rows = _of_one_scene(rows, choices.scene)
    judged = _judged_stream(rows, said.dataset)
    left = 0
    for image, pose, row in rows:
        if image.stream in ("", judged):
            said.add(image.frame, pose, row.where)
        else:
            said.check_frame(image.frame, row.where)
            left += 1
    if left:
        said.remarks.append(f"{left} poses of other images than {judged} left out")
    last = said.dataset.info.image_streams[-1].name if said.dataset.info.image_streams else ""
    if judged != last:
        said.remarks.append(f"poses of {judged}, judged at the frame's last exposure, {last}")


def names_of_images(dataset: Dataset) -> dict[str, ImageNamed]:
    """Return the dataset's images by their names, with and without ending."""
    names: dict[str, ImageNamed] = {}
    for stream in dataset.info.image_streams:
        for index in dataset.indices:
            path = stream.path(dataset.folder, index)
            names[path.name] = names[path.stem] = ImageNamed(index, stream.name)
    return names


def _named(row: CsvRow, names: dict[str, ImageNamed], dataset: Dataset) -> ImageNamed:
    name = row.text("filename", MOST_NAME)
    if not PLAIN_NAME.fullmatch(name):
        raise row.refusal("filename", "as the plain name of an image, no folder", shown(name))
    stem = PurePosixPath(name).stem
    if (known := names.get(name, names.get(stem))) is not None:
        return known
    if numbered := IMAGE_NAME.fullmatch(stem):
        return ImageNamed(int(numbered[1]))
    if exported := EXPORTED_NAME.fullmatch(stem):
        return ImageNamed(int(exported[2]), exported[3] or "", int(exported[1]))
    example = next(iter(names), f"img{dataset.indices[0]:06d}.jpg")
    raise DatasetError(
        f"{row.where}: expected filename as the dataset names its images, such as {example}, as "
        f"its export does, or img{dataset.indices[0]:06d}.jpg, got {shown(name)}"
    )


def _of_one_scene(
    rows: list[tuple[ImageNamed, RigidTransform, CsvRow]], chosen: int | None
) -> list[tuple[ImageNamed, RigidTransform, CsvRow]]:
    """Return the rows of the dataset's scene, where names tell scenes."""
    there = sorted({image.scene for image, _, _ in rows if image.scene is not None})
    if not there:
        return rows
    if chosen is None and len(there) > 1:
        told = ", ".join(map(str, there[:5]))
        raise rows[0][2].refusal(
            "filename", "of the same scene in all rows", f"{told}; choose one by --scene"
        )
    if chosen is not None and chosen not in there:
        raise DatasetError(
            f"{rows[0][2].where}: expected an image of scene {chosen}, got none; see --scene"
        )
    return [each for each in rows if each[0].scene in (None, chosen or there[0])]


def _judged_stream(rows: list[tuple[ImageNamed, RigidTransform, CsvRow]], dataset: Dataset) -> str:
    """Return the stream whose poses are the frames': the last, or the only one that is named."""
    own = [each.name for each in dataset.info.image_streams]
    for image, _, row in rows:
        if image.stream and image.stream not in own:
            raise row.refusal(
                "filename", f"of one of the streams {', '.join(own)}", shown(image.stream)
            )
    named = {image.stream for image, _, _ in rows if image.stream}
    return next(iter(named)) if len(named) == 1 else (own[-1] if own else "")
