"""The label records of an export, kept one a file while it is made, and read one at a time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from bench.export.plan import Plan, Shot
from bench.export.record import Record, record_from_json
from models.atomic_file import write_text
from models.errors import DatasetError, UnreadableError, cause
from models.reading.regular_file import read_text

HIDDEN = ".rvbench-export"
"""Folder of what an export keeps for itself until it is done."""


@dataclass(frozen=True, eq=False)
class Records:
    """The records of an export being made.

    Attributes
    ----------
    plan : Plan
    folder : Path
        Of the export.
    """

    plan: Plan
    folder: Path

    def path(self, shot: Shot) -> Path:
        """Return where a record lies; a thousand of them share a folder."""
        return self.folder / HIDDEN / "records" / f"{shot.frame // 1000:04d}" / f"{shot.key}.json"

    def get(self, shot: Shot) -> Record | None:
        """Return a record; None where there is none yet, or none that is whole."""
        try:
            return record_from_json(read_text(self.path(shot)), self.path(shot))
        except DatasetError:
            return None

    def put(self, shot: Shot, record: Record) -> None:
        """Keep a record; it is the last file of its image to be written.

        Raises
        ------
        StorageError
            If it cannot be written.
        """
        write_text(self.path(shot), record.to_json())

    def of(
        self, split: str | None = None, scene: int | None = None, stream: str | None = None
    ) -> Iterator[Record]:
        """Walk the records in the order of the plan, or those of a split, dataset or stream.

        Parameters
        ----------
        split, scene, stream
            Any of them, unless given.

        Raises
        ------
        DatasetError
            If one is missing.
        """
        for shot in self.plan.shots:
            if (
                split in (None, shot.split)
                and scene in (None, shot.scene)
                and stream in (None, shot.stream)
            ):
                yield record_from_json(self._text(shot), self.path(shot))

    def _text(self, shot: Shot) -> str:
        try:
            return read_text(self.path(shot))
        except UnreadableError as error:
            raise DatasetError(
                f"expected the label record {self.path(shot)}, got: {cause(error)}; export again"
            ) from error
