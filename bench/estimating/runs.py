"""The runs of a dataset: the same frames and truth, another detector seed and another prior.

::

    DIR/estimates/best.jsonl, best.runtime.csv          run 0
        seeds/001/prior.toml, camera.toml               run 1: what it was given
        seeds/001/times.csv                             if its clock is told otherwise
        seeds/001/estimates/best.jsonl, ...
        seeds/001/run.json                              written last: whose frames it saw
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from glob import escape
from pathlib import Path
from typing import Any

from bench.estimating.run_times import times_of
from models.dataset.dataset import Dataset
from models.dataset.estimates_file import read_estimates, read_runtimes
from models.errors import DatasetError, UnreadableError
from models.estimate import Estimate
from models.reading.json_file import read_json_table

PREFERRED = "best"
SAME_INSTANT_S = 1e-6


@dataclass(frozen=True)
class Run:
    """What one pipeline variant said in one run.

    Attributes
    ----------
    number : int
    label : str
        Of the pipeline.
    estimates : dict
        By frame; one for every frame of the dataset.
    runtime_ms : dict
        By frame; empty if nobody measured.
    """

    number: int
    label: str
    estimates: dict[int, Estimate]
    runtime_ms: dict[int, float]


def run_folder(folder: Path, number: int) -> Path:
    """Return where a run keeps its own files; run 0 is the dataset itself."""
    return folder if number == 0 else folder / "seeds" / f"{number:03d}"


def estimates_path(folder: Path, number: int, variant: str) -> Path:
    """Return the estimates file of one variant in one run.

    Parameters
    ----------
    folder : Path
        The dataset.
    number : int
        Of the run.
    variant : str
        Label of the pipeline.
    """
    return run_folder(folder, number) / "estimates" / f"{variant}.jsonl"


def runtimes_path(folder: Path, number: int, variant: str) -> Path:
    """Return the runtimes file of one variant in one run.

    Parameters
    ----------
    folder, number, variant : as for ``estimates_path``
    """
    return run_folder(folder, number) / "estimates" / f"{variant}.runtime.csv"


def stamp_path(folder: Path, number: int) -> Path:
    """Return the file that says of which dataset, and with which settings, a run was made."""
    return run_folder(folder, number) / "run.json"


def read_stamp(folder: Path, number: int) -> dict[str, Any]:
    """Return a run's stamp; empty if it has none or it cannot be read."""
    try:
        return read_json_table(stamp_path(folder, number))
    except UnreadableError:
        return {}


def spoken_variants(folder: Path) -> tuple[str, ...]:
    """Return the variants that have estimates of run 0, in order of name; perhaps none."""
    return tuple(sorted(path.stem for path in (folder / "estimates").glob("*.jsonl")))


def found_variants(folder: Path) -> tuple[str, ...]:
    """Return the variants that have estimates of run 0.

    Raises
    ------
    DatasetError
        If there are none.
    """
    variants = spoken_variants(folder)
    if not variants:
        raise DatasetError(
            f"expected estimates at {folder / 'estimates'}/*.jsonl, found none; "
            f"run `rvbench estimate {folder}` first"
        )
    return variants


def spoken_variant(folder: Path, variant: str | None = None) -> str | None:
    """Return a variant if it has estimates of run 0, None if none has.

    Parameters
    ----------
    folder : Path
    variant : str, optional
        Unless given, ``best`` where it has spoken, else the first that has.

    Raises
    ------
    DatasetError
        If others have, but not this one.
    """
    spoken = spoken_variants(folder)
    if variant is None:
        return PREFERRED if PREFERRED in spoken else next(iter(spoken), None)
    if spoken and variant not in spoken:
        raise DatasetError(
            f"{folder}: expected a variant with estimates, {' or '.join(spoken)}, got {variant!r}"
        )
    return variant if spoken else None


def found_runs(folder: Path, variant: str) -> list[int]:
    """Return the numbers of the runs that have estimates of a variant, in order."""
    others = (folder / "seeds").glob(f"[0-9][0-9][0-9]/estimates/{escape(variant)}.jsonl")
    numbers = sorted(int(path.parent.parent.name) for path in others)
    own = estimates_path(folder, 0, variant)  # a link to nothing is there, too: reading says so
    return [0, *numbers] if own.exists() or own.is_symlink() else numbers


def by_frame(
    dataset: Dataset,
    said: Iterable[Estimate],
    path: Path,
    mend: str,
    times_s: Mapping[int, float] | None = None,
) -> dict[int, Estimate]:
    """Return estimates by frame, held against the dataset's frames.

    Parameters
    ----------
    dataset : Dataset
    said : iterable of Estimate
    path : Path
        Their file, for messages.
    mend : str
        What to do.
    times_s : mapping of int to float, optional, s
        Of the frames, where a run has times of its own.

    Raises
    ------
    DatasetError
        If they are not one for every frame, of its time.
    """
    estimates = {estimate.frame: estimate for estimate in said}
    wanted = set(dataset.indices)
    if set(estimates) != wanted:
        missing, extra = sorted(wanted - set(estimates)), sorted(set(estimates) - wanted)
        raise DatasetError(
            f"{path}: expected one estimate for each of the {len(wanted)} frames; "
            f"{len(missing)} missing{f' (first: {missing[0]})' if missing else ''}, "
            f"{len(extra)} of no frame{f' (first: {extra[0]})' if extra else ''}; {mend}"
        )
    for entry in dataset.entries:
        said_s = estimates[entry.index].time_s
        there_s, where = entry.time_s, "frames.csv"
        if times_s is not None:
            there_s, where = times_s[entry.index], "times.csv"
        if abs(said_s - there_s) > SAME_INSTANT_S:
            raise DatasetError(
                f"{path}: expected an estimate of frame {entry.index} at {there_s} s, as "
                f"{where} has it, got one at {said_s} s; {mend}"
            )
    return estimates


def read_run(dataset: Dataset, number: int, label: str) -> Run:
    """Read a run and hold it against the dataset's frames.

    Parameters
    ----------
    dataset : Dataset
    number : int
    label : str
        Of the pipeline.

    Raises
    ------
    DatasetError
        If the estimates are not one for every frame, of its time, or the run was made on other
        frames.
    """
    folder = dataset.folder
    path = estimates_path(folder, number, label)
    mend = (
        f"run `rvbench estimate {folder}` again"
        if number == 0
        else f"delete {run_folder(folder, number)}, or run again with --seeds"
    )
    fingerprint = dataset.fingerprint()
    if read_stamp(folder, number).get("dataset", fingerprint) != fingerprint:
        raise DatasetError(f"{path}: expected estimates of this dataset, got another's; {mend}")
    times_s = times_of(dataset, run_folder(folder, number))
    said = read_estimates(path)
    estimates = by_frame(dataset, said, path, f"the frames have changed since: {mend}", times_s)
    try:
        spent = read_runtimes(runtimes_path(folder, number, label))
    except DatasetError as error:
        raise DatasetError(f"{error}; delete it: no score but the runtime needs it") from error
    return Run(number, label, estimates, spent)
