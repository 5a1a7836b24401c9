"""What each kind of folder says of itself: files are counted, few are read, nothing is loaded.

Every file of ours is whole or absent, so one that is there is done.
"""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path

from bench.status.folder_status import FolderStatus, Stage, stage_of
from models.at_work import is_at_work, last_failure
from models.dataset.description import DatasetInfo, read_info
from models.errors import DatasetError, RvbenchError, UnreadableError
from models.folder_kinds import MARKS
from models.reading.csv_table import read_csv
from models.reading.json_file import read_json_table
from models.reading.toml_file import read_toml

INDEX_COLUMNS = ("number", "folder", "frame", "pose", "split")
ASKED_NAME = "asked.json"


def status_of(folder: Path) -> FolderStatus:
    """Return what of a folder is done, runs, failed and is left.

    Raises
    ------
    DatasetError
        If it is none of ours, or what marks it cannot be read.
    """
    if not folder.is_dir():
        raise DatasetError(f"expected a folder that rvbench writes at {folder}, found none")
    for mark, kind in MARKS.items():
        if (folder / mark).is_file():
            return READERS[kind](folder)
    raise DatasetError(
        f"expected a folder of a run, sweep, dataset, suite or export in {folder}, found none of "
        f"{', '.join(MARKS)}"
    )


def dataset_status(folder: Path) -> FolderStatus:
    """Return the status of what ``render`` or ``run`` writes."""
    info = read_info(folder)
    estimates = sorted(path.stem for path in (folder / "estimates").glob("*.jsonl"))
    seeds = sorted(path for path in (folder / "seeds").glob("[0-9]*") if path.is_dir())
    ran = {path.name for path in seeds if (path / "run.json").is_file()}
    begun = bool(estimates)
    stages = [
        _exposures(folder, info),
        Stage("estimates", len(estimates), max(1, len(estimates)), needed=False),
        Stage("score", int((folder / "score.json").is_file()), 1, needed=begun),
        Stage("report", int((folder / "report.html").is_file()), 1, needed=begun),
    ]
    if seeds:
        stages.insert(2, stage_of("more runs", [path.name for path in seeds], ran))
    failed = (*_failure(folder), *_lost(folder))
    return _told(folder, "dataset", info.case, stages, failed)


def random_dataset_status(folder: Path) -> FolderStatus:
    """Return the status of what ``dataset`` writes.

    Raises
    ------
    DatasetError
        If its index names what is no folder beside it.
    """
    mark = read_json_table(folder / "random_dataset.json")
    counted = Counter(row.text("folder") for row in read_csv(folder / "index.csv", INDEX_COLUMNS))
    stages = []
    for name, frames in sorted(counted.items()):
        if Path(name).name != name:
            raise DatasetError(f"{folder / 'index.csv'}: expected names of folders, got {name!r}")
        try:
            stages.append(_exposures(folder / name, read_info(folder / name), name))
        except DatasetError:
            stages.append(Stage(name, 0, frames))
    stages.append(Stage("pictures", int((folder / "frames.png").is_file()), 1))
    spec = mark.get("spec")
    name = str(spec.get("name")) if isinstance(spec, dict) else ""
    return _told(folder, "random dataset", name, stages, _failure(folder))


def sweep_status(folder: Path) -> FolderStatus:
    """Return the status of what ``sweep`` writes; shots are those that were asked for last."""
    asked = _asked(folder / ASKED_NAME)
    there = {path.stem for path in (folder / "shots").glob("*.json")}
    shots = _uncounted("shots", there) if asked is None else stage_of("shots", asked, there)
    written = [Stage(name, int((folder / f"sweep.{name}").is_file()), 1) for name in _TABLES]
    case = _first_name(folder / "truth" / "scenario.toml")
    return _told(folder, "sweep", case, [shots, *written], _failure(folder))


def suite_status(folder: Path) -> FolderStatus:
    """Return the status of what ``suite`` writes; units are those that were asked for last."""
    units = folder / "units"
    asked = _asked(units / ASKED_NAME)
    there = {str(path.relative_to(units).with_suffix("")) for path in units.rglob("*.npz")}
    stage = _uncounted("units", there) if asked is None else stage_of("units", asked, there)
    written = Stage("tables", int((folder / "suite.json").is_file()), 1)
    name = str(read_json_table(units / "made_by.json").get("suite"))
    return _told(folder, "suite", name, [stage, written], _failure(units), units)


def export_status(folder: Path) -> FolderStatus:
    """Return the status of what ``export`` writes."""
    mark = read_json_table(folder / "export.json")
    sources = mark.get("datasets")
    frames = [each.get("frames") for each in sources or [] if isinstance(each, dict)]
    total = sum(each for each in frames if isinstance(each, int))
    if mark.get("complete") is True:
        done = total
    else:
        records = (folder / ".rvbench-export").rglob("*.json")
        done = len({path.name[:13] for path in records})  # scene and frame
    listed = Stage("hashes", int((folder / "files.sha256").is_file()), 1)
    stages = [Stage("frames", done, total), listed]
    return _told(folder, "export", str(mark.get("as")), stages, _failure(folder))


READERS = {
    "dataset": dataset_status,
    "random dataset": random_dataset_status,
    "sweep": sweep_status,
    "suite": suite_status,
    "export": export_status,
}
_TABLES = ("csv", "json", "html")


def _told(
    folder: Path,
    kind: str,
    name: str,
    stages: list[Stage],
    failed: tuple[dict[str, str], ...],
    held: Path | None = None,
) -> FolderStatus:
    running = is_at_work(held or folder)
    return FolderStatus(str(folder), kind, name, running, tuple(stages), failed)


def _exposures(folder: Path, info: DatasetInfo, name: str = "exposures") -> Stage:
    """Count the images that are there: a folder is listed once, however many it holds."""
    listed: dict[Path, set[str]] = {}
    wanted = [
        stream.path(folder, frame) for frame in range(info.frames) for stream in info.image_streams
    ]
    for path in wanted:
        if path.parent not in listed:
            listed[path.parent] = _names(path.parent)
    there = {str(path.relative_to(folder)) for path in wanted if path.name in listed[path.parent]}
    return stage_of(name, [str(path.relative_to(folder)) for path in wanted], there)


def _names(folder: Path) -> set[str]:
    try:
        return set(os.listdir(folder))
    except OSError:
        return set()


def _uncounted(name: str, there: set[str]) -> Stage:
    """Return a stage of a folder that does not say how much was asked for: its tables tell."""
    return Stage(name, len(there), None, needed=False)


def _asked(path: Path) -> list[str] | None:
    """Return the names of what was asked for; None where it was not written down."""
    try:
        asked = read_json_table(path).get("asked")
    except UnreadableError:
        return None
    return [str(each) for each in asked] if isinstance(asked, list) else None


def _failure(folder: Path) -> tuple[dict[str, str], ...]:
    found = last_failure(folder)
    return () if found is None else (found,)


def _lost(folder: Path) -> tuple[dict[str, str], ...]:
    """Return the frames that each pipeline lost and why, as the score counts them."""
    try:
        pipelines = read_json_table(folder / "score.json")["pipelines"]
        return tuple(
            {"what": f"{count} frames of {label}", "why": str(reason)}
            for label, scored in pipelines.items()
            for reason, count in scored["core"]["lost"]["reasons"].items()
        )
    except (RvbenchError, KeyError, TypeError, AttributeError):
        return ()


def _first_name(path: Path) -> str:
    try:
        return str(read_toml(path).get("name", ""))
    except UnreadableError:
        return ""
