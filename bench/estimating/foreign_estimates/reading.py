"""A file of estimates made elsewhere, whatever its format: the front door."""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeAlias, get_args

from bench.estimating.foreign_estimates import bop_results, speed_submission, tum_trajectory
from bench.estimating.foreign_estimates.own_estimates import read_own_estimates
from bench.estimating.foreign_estimates.said_poses import Choices, SaidPoses
from bench.estimating.runs import Run
from models.dataset.dataset import Dataset
from models.errors import DatasetError, UnreadableError
from models.estimate import Estimate, PoseEstimate
from models.reading.bounds import MOST_NAME
from models.reading.regular_file import MEGABYTE, read_beginning, read_lines
from models.reading.shown import is_plain, reads_as_written, shown

FileFormat: TypeAlias = Literal["bop", "speed", "tum", "rvbench"]
FORMATS: tuple[FileFormat, ...] = get_args(FileFormat)
NAMES: dict[FileFormat, str] = {
    "bop": "BOP results",
    "speed": "a SPEED submission",
    "tum": "a TUM trajectory",
    "rvbench": "rvbench estimates",
}
LOOKED_AT_BYTES = 65_536
MOST_LINE_CHARACTERS = 100_000
_EIGHT_APART = re.compile(r"[-+.\deE]+(?:[ \t]+[^\s,]+){7}", re.ASCII)  # the first a number


@dataclass(frozen=True, eq=False)
class ForeignEstimates:
    """What a file says of every frame of a dataset.

    Attributes
    ----------
    path : Path
    format : str
        One of ``FORMATS``.
    run : Run
        An estimate for each frame; where the file has none, a reason.
    unsaid : frozenset of int
        Frames that it says nothing of.
    remarks : tuple of str
        What was left out.
    sha256 : str
        Of the file.
    """

    path: Path
    format: FileFormat
    run: Run
    unsaid: frozenset[int]
    remarks: tuple[str, ...]
    sha256: str


def read_foreign_estimates(
    path: Path,
    dataset: Dataset,
    file_format: FileFormat | None = None,
    choices: Choices | None = None,
) -> ForeignEstimates:
    """Read a file of estimates of a dataset's frames.

    Parameters
    ----------
    path : Path
    dataset : Dataset
    file_format : str, optional
        Found by what the file holds unless given.
    choices : Choices, optional
        What the file leaves open.

    Raises
    ------
    DatasetError
        If it is none of the formats, too large, says what cannot be, names a frame twice or one
        that the dataset has not, or says nothing at all.
    """
    label = label_of(path)
    found = file_format or recognised_format(path)
    choices = choices or Choices()
    if found == "rvbench":
        estimates = read_own_estimates(path, dataset)
        return ForeignEstimates(
            path, found, Run(0, label, estimates, {}), frozenset(), (), sha256_of(path)
        )
    said = SaidPoses(path, dataset)
    lines = read_lines(path, most_line_bytes=MOST_LINE_CHARACTERS)
    if found == "bop":
        bop_results.read_bop_results(lines, said, choices)
    elif found == "speed":
        speed_submission.read_speed_submission(lines, said, choices)
    else:
        tum_trajectory.read_tum_trajectory(lines, said, choices)
    if not said.poses:
        raise DatasetError(f"{path}: expected {NAMES[found]} with a pose at least, got none")
    run = Run(0, label, _every_frame(said), said.runtime_ms)
    unsaid = frozenset(dataset.indices).difference(said.poses)
    return ForeignEstimates(path, found, run, unsaid, tuple(said.remarks), sha256_of(path))


def recognised_format(path: Path) -> FileFormat:
    """Return the format of a file, by its first line that is no remark.

    Raises
    ------
    DatasetError
        If it is none of ours, or no regular file.
    """
    try:
        text = read_beginning(path, LOOKED_AT_BYTES).decode("utf-8-sig", errors="replace")
    except UnreadableError as error:
        raise DatasetError(f"expected estimates at {path}, got: {error.told}") from error
    lines = (line.strip() for line in text.split("\n"))
    first = next((line for line in lines if line and not line.startswith("#")), "")
    if first.startswith("{"):
        return "rvbench"
    if first.replace(" ", "") == bop_results.HEADER:
        return "bop"
    if _EIGHT_APART.fullmatch(first):
        return "tum"
    if len(first.split(",")) == len(speed_submission.COLUMNS):
        return "speed"
    raise DatasetError(
        f"{path}: expected BOP results ({bop_results.HEADER}), a SPEED submission "
        f"({speed_submission.HEADER}), a TUM trajectory ({tum_trajectory.WORDS}) or rvbench "
        f"estimates ({{...}} a line), got {shown(first[:60]) if first else 'an empty file'}; "
        "see docs/formats.md, or name the format with --format"
    )


def label_of(path: Path) -> str:
    """Return what the estimates of a file are called: its name without ending.

    Raises
    ------
    DatasetError
        If that cannot be printed, or is too long.
    """
    name = path.name.removesuffix(path.suffix) or path.name
    if not (name and len(name) <= MOST_NAME and is_plain(name) and reads_as_written(name)):
        raise DatasetError(
            f"expected a file whose name is printable text of up to {MOST_NAME} characters, got "
            f"{shown(path.name)}; rename it"
        )
    return name


def sha256_of(path: Path) -> str:
    """Return a hash of a file, as hexadecimal text."""
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while block := file.read(MEGABYTE):
            digest.update(block)
    return digest.hexdigest()


def _every_frame(said: SaidPoses) -> dict[int, Estimate]:
    reason = f"no row in {said.path.name}"
    return {
        entry.index: Estimate(entry.index, entry.time_s, pose=PoseEstimate(said.poses[entry.index]))
        if entry.index in said.poses
        else Estimate(entry.index, entry.time_s, reason=reason)
        for entry in said.dataset.entries
    }
