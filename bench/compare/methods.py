"""What is compared: estimates of ours and of others, each found where it lies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from bench.compare.exported_numbers import ExportedAs, exported_numbers
from bench.estimating.foreign_estimates.reading import (
    FileFormat,
    read_foreign_estimates,
    sha256_of,
)
from bench.estimating.foreign_estimates.said_poses import Choices
from bench.estimating.runs import Run, estimates_path, read_run, spoken_variants
from models.dataset.dataset import Dataset, open_dataset
from models.dataset.description import FILE_NAME
from models.errors import DatasetError

MOST_METHODS = 40


@dataclass(frozen=True, eq=False)
class Method:
    """One method's estimates of every frame.

    Attributes
    ----------
    label : str
    run : Run
    path : Path
        The file that says them.
    format : str
        As ``bench.estimating.foreign_estimates.reading.FORMATS`` has it.
    sha256 : str
        Of the file.
    unsaid : frozenset of int
        Frames that it says nothing of; they are lost.
    remarks : tuple of str
    """

    label: str
    run: Run
    path: Path
    format: FileFormat
    sha256: str
    unsaid: frozenset[int] = frozenset()
    remarks: tuple[str, ...] = ()

    @property
    def missing(self) -> int:
        """How many frames it says nothing of."""
        return len(self.unsaid)

    def of_frames(self, frames: frozenset[int]) -> Method:
        """Return what it says of some frames alone."""
        run = replace(
            self.run,
            estimates={k: said for k, said in self.run.estimates.items() if k in frames},
            runtime_ms={k: spent for k, spent in self.run.runtime_ms.items() if k in frames},
        )
        return replace(self, run=run, unsaid=self.unsaid & frames)


@dataclass(frozen=True)
class _Place:
    """A file of estimates, and the dataset's folder and run where it is one of those."""

    path: Path
    home: Path | None
    number: int = 0


def found_methods(
    arguments: Sequence[Path],
    dataset: Path | None,
    file_format: FileFormat | None = None,
    choices: Choices | None = None,
    exported: ExportedAs | None = None,
) -> tuple[Dataset, list[Method]]:
    """Read the methods that arguments name, and the dataset that they are all of.

    Parameters
    ----------
    arguments : sequence of Path
        Files of estimates; or datasets, or a run's folder in ``seeds``, for all pipelines there.
    dataset : Path or None
        That of one of the arguments unless given.
    file_format : str, optional
        Of the files that lie in no dataset.
    choices : Choices, optional
        What those leave open.
    exported : ExportedAs, optional
        An export whose numbers those go by, and which of its splits is judged.

    Returns
    -------
    Dataset, list of Method
        The dataset has the frames of the split alone, where one is named.

    Raises
    ------
    DatasetError
        If one is neither, estimates are not of the dataset, or datasets differ.
    """
    places = [place for argument in arguments for place in _places(argument)]
    homes = list(dict.fromkeys(place.home for place in places if place.home is not None))
    if dataset is not None:
        homes = [dataset, *(home for home in homes if home.resolve() != dataset.resolve())]
    if not homes:
        raise DatasetError(
            "expected a dataset whose frames these estimates are of, got none; "
            "name it with --dataset DIR"
        )
    if len(places) > MOST_METHODS:
        raise DatasetError(f"expected up to {MOST_METHODS} methods, got {len(places)}")
    opened = {home: open_dataset(home) for home in homes}
    first = opened[homes[0]]
    for home, other in opened.items():
        if other.fingerprint() != first.fingerprint():
            raise DatasetError(
                f"expected estimates of one dataset, got those of {homes[0]} and {home}, which "
                "differ; only methods on the same frames are compared"
            )
    choices = choices or Choices()
    frames: frozenset[int] | None = None
    if exported is not None:
        numbers = exported_numbers(exported, first)
        choices, frames = numbers.completed(choices), numbers.frames
    methods = [
        _foreign(place.path, first, file_format, choices)
        if place.home is None
        else _ours(place, opened[next(each for each in homes if _same(each, place.home))])
        for place in places
    ]
    if frames is not None:
        methods = [method.of_frames(frames) for method in methods]
        first = replace(first, entries=[each for each in first.entries if each.index in frames])
    return first, _named_apart(methods)


def _same(one: Path, other: Path) -> bool:
    return one.resolve() == other.resolve()


def _places(argument: Path) -> list[_Place]:
    if not argument.is_dir():
        home, number = _home(argument.parent.parent)
        ours = argument.parent.name == "estimates" and argument.suffix == ".jsonl"
        return [_Place(argument, home if ours else None, number)]
    home, number = _home(argument)
    labels = spoken_variants(argument)
    if home is None or not labels:
        raise DatasetError(
            f"expected a file of estimates, or a dataset with estimates, got the folder {argument} "
            f"with {'no estimates' if home else 'no ' + FILE_NAME}; "
            "`rvbench estimate` makes them"
        )
    return [_Place(estimates_path(home, number, label), home, number) for label in labels]


def _home(folder: Path) -> tuple[Path | None, int]:
    """Return the dataset of a run's folder, and the run's number; None where it is of none."""
    if (folder / FILE_NAME).is_file():
        return folder, 0
    seeds = folder.parent
    if seeds.name == "seeds" and folder.name.isdecimal() and (seeds.parent / FILE_NAME).is_file():
        return seeds.parent, int(folder.name)
    return None, 0


def _ours(place: _Place, dataset: Dataset) -> Method:
    label = place.path.stem
    run = read_run(dataset, place.number, label)
    named = f"{label}, run {place.number}" if place.number else label
    return Method(named, run, place.path, "rvbench", sha256_of(place.path))


def _foreign(
    path: Path, dataset: Dataset, file_format: FileFormat | None, choices: Choices | None
) -> Method:
    read = read_foreign_estimates(path, dataset, file_format, choices)
    return Method(
        read.run.label, read.run, path, read.format, read.sha256, read.unsaid, read.remarks
    )


def _named_apart(methods: list[Method]) -> list[Method]:
    """Return the methods under labels that differ: the folder is named where files are alike."""
    labels = [method.label for method in methods]
    apart: list[Method] = []
    taken: set[str] = set()
    for method in methods:
        label = method.label
        if labels.count(label) > 1:
            label = f"{label} ({method.path.resolve().parent.name})"
        number, wanted = 2, label
        while label in taken:
            label, number = f"{wanted} #{number}", number + 1
        taken.add(label)
        apart.append(replace(method, label=label))
    return apart
