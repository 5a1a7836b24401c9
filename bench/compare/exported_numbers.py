"""The numbers by which an export names a dataset: its scene, its object, the frames of a split.

Only what lies in the export is read: ``export.json`` and ``tables/labels.csv``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from bench.estimating.foreign_estimates.said_poses import Choices
from models.dataset.dataset import Dataset
from models.errors import DatasetError
from models.reading.bounds import FRAME
from models.reading.csv_table import read_csv
from models.reading.fields import Fields
from models.reading.json_file import read_json_table
from models.reading.shown import shown

MARK, LABELS = "export.json", Path("tables", "labels.csv")
FORMAT = "rvbench-export"
MOST_LABELS_BYTES = 1_000_000_000
MOST_SCENE = 999_999


@dataclass(frozen=True)
class ExportedAs:
    """An export that estimates go by.

    Attributes
    ----------
    folder : Path
    split : str, optional
        Whose frames are judged; all of them unless given.
    """

    folder: Path
    split: str | None = None


@dataclass(frozen=True)
class ExportedNumbers:
    """What an export calls a dataset.

    Attributes
    ----------
    scene, target : int
    frames : frozenset of int, or None
        Of the split; None where none is named.
    """

    scene: int
    target: int
    frames: frozenset[int] | None

    def completed(self, choices: Choices) -> Choices:
        """Return choices with the numbers that they leave open."""
        return replace(
            choices,
            scene=self.scene if choices.scene is None else choices.scene,
            target=self.target if choices.target is None else choices.target,
        )


def exported_numbers(exported: ExportedAs, dataset: Dataset) -> ExportedNumbers:
    """Find a dataset in an export, by the hash of its public half.

    Parameters
    ----------
    exported : ExportedAs
    dataset : Dataset

    Raises
    ------
    DatasetError
        If the folder is no export of ours, the dataset is not in it, or the split has none of its
        frames.
    """
    path = exported.folder / MARK
    if not path.is_file():
        raise DatasetError(
            f"expected an export of rvbench in {exported.folder}, with an {MARK}; found none"
        )
    told = Fields(read_json_table(path), path)
    if told.value("format") != FORMAT:
        raise told.refusal("format", f"as {FORMAT!r}", shown(told.value("format")))
    names, scene = [], None
    fingerprint = dataset.content_fingerprint()
    listed = told.value("datasets")
    for number, own in enumerate(listed if isinstance(listed, list) else [], start=1):
        row = Fields(own, f"{path}: dataset {number}") if isinstance(own, dict) else None
        if row is None:
            raise told.refusal("datasets", "as a list of tables", shown(own))
        names.append(row.text("target"))
        if scene is None and row.text("public_half") == fingerprint:
            scene = number
    if scene is None:
        raise DatasetError(
            f"expected an export of {dataset.folder} in {exported.folder}, got one of "
            f"{len(names)} other datasets, or of this one before it was rendered anew"
        )
    target = 1 + list(dict.fromkeys(names)).index(names[scene - 1])
    frames = None if exported.split is None else _frames_of(exported, scene)
    return ExportedNumbers(scene, target, frames)


def _frames_of(exported: ExportedAs, scene: int) -> frozenset[int]:
    from bench.export.tables import LABEL_COLUMNS  # what exports are made with is slow to load

    path = exported.folder / LABELS
    rows = read_csv(path, LABEL_COLUMNS, most_bytes=MOST_LABELS_BYTES)
    by_split: dict[str, set[int]] = {}
    for row in rows:
        if row.whole("scene", 1, MOST_SCENE) == scene:
            by_split.setdefault(row.text("split"), set()).add(row.whole("frame", *FRAME))
    frames = by_split.get(str(exported.split))
    if not frames:
        raise DatasetError(
            f"{path}: expected a split with frames of scene {scene}, one of "
            f"{', '.join(map(shown, by_split)) or 'none'}, got {shown(exported.split)}"
        )
    return frozenset(frames)
