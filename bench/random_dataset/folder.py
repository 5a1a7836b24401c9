"""The folder of a random dataset.

::

    DIR/random_dataset.json   what was asked, every default resolved: the first file to be written
        index.csv             each frame: its folder, its number there, its pose, its split
        README.md             what it holds, and what was refused
        coverage.png          how poses, Suns and exposures are spread
        frames.png            some of its frames
        TARGET-CAMERA/        a dataset that every other verb opens, one for each target, camera and
                              specimen; its splits.csv says which frames are for what
        truth/draws.csv       what was drawn of each frame
              cases/          the scenario of each folder
"""

from __future__ import annotations

import csv
import io
import json
import re
from pathlib import Path
from typing import Any

import numpy as np

from bench.random_dataset.parts import Part
from bench.random_dataset.plan import Plan, Shot
from bench.random_dataset.spec import differences
from bench.random_dataset.spec_tables import Spec
from models.arrays import Floats
from models.atomic_file import sweep_scratch, write_text
from models.dataset.split_file import FILE_NAME as SPLITS_NAME
from models.dataset.split_file import splits_to_csv
from models.errors import DatasetError
from models.output_folder import check_empty, check_place
from models.reading.csv_table import read_csv
from models.reading.json_file import read_json_table
from models.reading.regular_file import holds_text

MARK, FORMAT, VERSION = "random_dataset.json", "rvbench-random-dataset", 1
INDEX_NAME = "index.csv"
FOLDER = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*")
MOST_SHOWN = 8
INDEX = ("number", "folder", "frame", "pose", "split")
DRAWS = (
    *("number", "folder", "frame", "pose", "split", "range_m", "phase_deg", "exposure_ms"),
    *("background", "camera_azimuth_deg", "camera_elevation_deg"),
    *("sun_azimuth_deg", "sun_elevation_deg"),
)


def check_folder(out: Path, spec: Spec) -> None:
    """Refuse a file, a folder of something else, or one of another specification.

    Raises
    ------
    DatasetError
        It names what differs; nothing was changed.
    """
    check_place(out)
    there = _read_mark(out / MARK)
    if there is None:
        check_empty(out, "a random dataset that rvbench made")
        return
    differs = differences(there, _plain(spec))
    if differs:
        more = [f"and {len(differs) - MOST_SHOWN} more"] if len(differs) > MOST_SHOWN else []
        raise DatasetError(
            f"expected {out} to be empty or to hold a dataset of this very specification; it holds "
            f"one of another: {'; '.join([*differs[:MOST_SHOWN], *more])}; nothing was changed: "
            "choose another --out, or put the specification back"
        )


def check_cases(out: Path, plan: Plan) -> None:
    """Refuse a part that cannot be rendered, or whose scenario is no longer what it was.

    Raises
    ------
    ScenarioError, DatasetError
        The message says what is wrong, or what may have changed; nothing was written.
    """
    for part in plan.used:
        path, text = case_path(out, part), plan.scenario(part).to_toml()
        if path.is_file() and not holds_text(path, text):
            raise DatasetError(
                f"expected the scenario of {part.name} as it was when {out} began; it is not: the "
                "files of its spacecraft have changed, or rvbench itself has. Nothing was changed: "
                "put them back, or choose another --out"
            )


def begin(out: Path, plan: Plan) -> None:
    """Write what tells of the whole, before anything is rendered.

    Raises
    ------
    StorageError
        If it cannot be written.
    """
    mark = {"format": FORMAT, "version": VERSION, "spec": _plain(plan.spec)}
    write_text(out / MARK, json.dumps(mark, indent=1) + "\n")
    for place in (out, out / "truth", out / "truth" / "cases"):
        sweep_scratch(place)
    write_text(out / INDEX_NAME, _index(plan))
    write_text(out / "truth" / "draws.csv", _draws(plan))
    for part in plan.used:
        write_text(case_path(out, part), plan.scenario(part).to_toml())


def has_begun(out: Path, plan: Plan) -> bool:
    """Tell whether all that ``begin`` writes is there, of a folder that was checked.

    Those who render shares of one dataset at once then write none of it anew: on a network file
    system, who reads a file that another replaces may lose it.
    """
    own = [out / MARK, out / INDEX_NAME, out / "truth" / "draws.csv"]
    return all(path.is_file() for path in (*own, *(case_path(out, part) for part in plan.used)))


def case_path(out: Path, part: Part) -> Path:
    """Return where the scenario of a part lies."""
    return out / "truth" / "cases" / f"{part.name}.toml"


def datasets_within(folder: Path) -> list[Path]:
    """Return the datasets of a random dataset's folder; of any other, the folder itself.

    Raises
    ------
    DatasetError
        If its index cannot be read.
    """
    if _read_mark(folder / MARK) is None:
        return [folder]
    rows = read_csv(folder / INDEX_NAME, INDEX)
    names = sorted({row.text("folder") for row in rows})
    strange = [name for name in names if not FOLDER.fullmatch(name)]
    if strange:
        raise DatasetError(
            f"{folder / INDEX_NAME}: expected the names of folders beside it, got {strange[0]!r}"
        )
    return [folder / name for name in names]


def write_splits(out: Path, plan: Plan, part: Part) -> None:
    """Write what each frame of a part is for, once its dataset has begun.

    Parameters
    ----------
    out : Path
        The whole dataset's folder.
    plan : Plan
    part : Part
    """
    splits = [shot.split for shot in plan.of_part(part)]
    write_text(out / part.name / SPLITS_NAME, splits_to_csv(splits))


def _plain(spec: Spec) -> dict[str, Any]:
    table: dict[str, Any] = json.loads(spec.model_dump_json())
    return table


def _read_mark(path: Path) -> dict[str, Any] | None:
    """Return the specification of a folder; None if it has none of ours."""
    if not path.is_file():
        return None
    try:
        table = read_json_table(path)
        if table["format"] != FORMAT:
            return None
        spec = table["spec"]
    except (DatasetError, ValueError, KeyError, TypeError):
        return None
    return spec if isinstance(spec, dict) else None


def _index(plan: Plan) -> str:
    return _csv(
        INDEX,
        [
            (shot.number, plan.parts[shot.part].name, shot.frame, shot.pose_number, shot.split)
            for shot in plan.shots
        ],
    )


def _draws(plan: Plan) -> str:
    return _csv(DRAWS, [_drawn(plan, shot) for shot in plan.shots])


def _drawn(plan: Plan, shot: Shot) -> tuple[Any, ...]:
    pose = shot.pose
    return (
        shot.number,
        plan.parts[shot.part].name,
        shot.frame,
        shot.pose_number,
        shot.split,
        f"{pose.range_m:.6g}",
        f"{shot.phase_deg:.6g}",
        f"{shot.exposure_ms:.6g}",
        pose.background,
        *(f"{angle:.6g}" for angle in angles_deg(pose.to_camera)),
        *(f"{angle:.6g}" for angle in angles_deg(shot.sun_dir_in_target)),
    )


def angles_deg(direction: Floats) -> tuple[float, float]:
    """Return azimuth from +x towards +y, and elevation towards +z, deg, of a (3,) direction."""
    x, y, z = direction
    elevation = np.arcsin(np.clip(z, -1.0, 1.0))
    return float(np.rad2deg(np.arctan2(y, x))), float(np.rad2deg(elevation))


def _csv(header: tuple[str, ...], rows: list[tuple[Any, ...]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return text.getvalue()
