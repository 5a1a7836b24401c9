"""When the frames of a run were, by its own clock: a clock that is told wrong is so run by run."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from models.atomic_file import write_text
from models.dataset.dataset import Dataset
from models.errors import UnreadableError
from models.frame import Frame
from models.reading.bounds import TIME_S
from models.reading.csv_table import read_csv

COLUMNS = ("frame", "time_s")


def times_path(run: Path) -> Path:
    """Return the file of a run's times; there is none where the dataset's own are right."""
    return run / "times.csv"


def times_of(dataset: Dataset, run: Path) -> dict[int, float] | None:
    """Return the times of a run's frames, s, by frame; None where the dataset's own are right.

    Parameters
    ----------
    dataset : Dataset
    run : Path
        Folder of the run; run 0 is the dataset itself.

    Raises
    ------
    UnreadableError
        If the run has times of its own that cannot be read.
    """
    path = times_path(run)
    if run == dataset.folder or not path.exists():
        return None
    own = {entry.index: entry.time_s for entry in dataset.entries}
    for row in read_csv(path, COLUMNS):
        frame = row.whole("frame", 0, max(own, default=0))
        if frame not in own:
            raise UnreadableError(row.where, f"expected a frame of the dataset, got {frame}")
        own[frame] = row.number("time_s", *TIME_S)
    return own


class NotedTimes:
    """Passes frames on and notes their times.

    Parameters
    ----------
    frames : iterable of Frame
    """

    def __init__(self, frames: Iterable[Frame]) -> None:
        self._frames = frames
        self._times_s: dict[int, float] = {}

    def __iter__(self) -> Iterator[Frame]:
        for frame in self._frames:
            self._times_s[frame.index] = frame.time_s
            yield frame

    def write(self, dataset: Dataset, run: Path) -> None:
        """Write them beside the run's other files, where they are not the dataset's.

        Parameters
        ----------
        dataset : Dataset
        run : Path
        """
        path = times_path(run)
        own = {entry.index: entry.time_s for entry in dataset.entries}
        if all(own.get(frame) == time_s for frame, time_s in self._times_s.items()):
            path.unlink(missing_ok=True)
            return
        lines = [",".join(COLUMNS), *(f"{k},{t!r}" for k, t in sorted(self._times_s.items()))]
        write_text(path, "\n".join(lines) + "\n")
