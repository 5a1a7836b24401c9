"""Our own estimates format, of anybody's hand: looked over before any of it is parsed."""

from __future__ import annotations

from pathlib import Path

from bench.estimating.runs import by_frame
from models.dataset.dataset import Dataset
from models.dataset.estimates_file import read_estimates
from models.errors import UnreadableError
from models.estimate import Estimate
from models.reading.regular_file import MEGABYTE

MOST_LINE_BYTES = MEGABYTE  # twenty thousand detections; it takes a parser a third of a second


def read_own_estimates(path: Path, dataset: Dataset) -> dict[int, Estimate]:
    """Read an estimates file and hold it against the dataset's frames.

    Raises
    ------
    DatasetError
        If it has more lines than the dataset has frames, a line is too long or cannot be read, or
        it has not one estimate for each frame, of its time.
    """
    _look_over(path, len(dataset.entries) + 1)
    mend = "say each frame once, in order, with a reason where there is no pose"
    return by_frame(dataset, read_estimates(path), path, mend)


def _look_over(path: Path, most_lines: int) -> None:
    """Refuse a file that cannot be of the dataset, as soon as it shows."""
    line, length = 1, 0
    with path.open("rb") as file:
        while block := file.read(MEGABYTE):
            pieces = block.split(b"\n")
            for place, piece in enumerate(pieces):
                if place:
                    line, length = line + 1, 0
                length += len(piece)
                if length > MOST_LINE_BYTES:
                    raise UnreadableError(
                        path, f"more than {MOST_LINE_BYTES} bytes, the most of one line", line
                    )
                if line > most_lines and length:
                    raise UnreadableError(
                        path,
                        f"expected a head and a line for each of {most_lines - 1} frames, got more",
                        line,
                    )
