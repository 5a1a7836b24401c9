"""The folder of a sweep.

::

    DIR/sweep.csv, sweep.json     the table, see ``bench.sweep.table``
        sweep.html                both maps, the table, the extremes: opens offline
        sun_map.png               or sun_map_1.png and so on, one for each setting
        extremes/best_1.png       and best_2 to harshest_3, the 850 nm frames at full size
        shots/                    what each shot came to, see ``bench.sweep.shots``
        asked.json                which shots were asked for last
        truth/scenario.toml       the scenario with every default resolved
              pose_285.000.json   what each pose truly was
              depth_285.000_850.exr    where a lens with a focus needs it
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from bench.status.readers import ASKED_NAME
from bench.sweep.plan import SweepPlan, SweepPose
from bench.sweep.shots import Shot, shot_path
from models.arrays import Radiance
from models.atomic_file import write_text
from models.errors import DatasetError
from models.output_folder import check_empty, check_place
from models.reading.fields import Fields
from models.reading.json_file import read_json_table
from renders.scenario.scenario import read_scenario
from renders.store.radiance_store import KEY
from renders.store.sealed_exr import read_exr, write_exr

if TYPE_CHECKING:
    from bench.sweep.pose_work import PoseWork

PoseTruth: TypeAlias = dict[str, Any]
"""The sealed record of a pose's last exposure under each Sun, by ``--sun`` text."""


def check_folder(plan: SweepPlan) -> None:
    """Refuse a file, a dataset, a sweep of another scenario, or what is not ours.

    The scenario is the first file to be written, so that a sweep killed at any moment goes on.
    Poses, Suns, exposures, lamp powers and pipelines may be others than last time: what is there
    of them is used again.

    Raises
    ------
    DatasetError
        Nothing was changed.
    """
    out = plan.request.out
    check_place(out)
    if (out / "dataset.json").exists():
        raise DatasetError(
            f"expected {out} to be empty or to hold this very sweep, it holds a dataset; "
            "nothing was changed: choose another --out"
        )
    there = scenario_path(out)
    if not there.is_file():
        check_empty(out, "a sweep that rvbench made")
        return
    scenario = read_scenario(there)
    if scenario.fingerprint() != plan.scenario.fingerprint():
        differs = [
            name
            for name, value in plan.scenario.model_dump().items()
            if scenario.model_dump()[name] != value
        ]
        raise DatasetError(
            f"expected {out} to be empty or to hold a sweep of this very scenario; it holds one of "
            f"another ({', '.join(differs)} differ); nothing was changed: choose another --out"
        )


def scenario_path(out: Path) -> Path:
    """Return where the resolved scenario lies: it holds the motion, so behind the wall."""
    return out / "truth" / "scenario.toml"


def write_asked(out: Path, shots: Sequence[Shot]) -> None:
    """Write down which shots were asked for last, for ``rvbench status``.

    Parameters
    ----------
    out : Path
        The sweep's folder.
    shots : sequence of Shot
    """
    names = [shot_path(out, shot).stem for shot in shots]
    write_text(out / ASKED_NAME, json.dumps({"asked": names}) + "\n")


def read_pose_truth(out: Path, work: PoseWork, key: str) -> PoseTruth | None:
    """Read the truth of a pose; None if it is absent, of another scene, or lacks a Sun.

    Parameters
    ----------
    out : Path
        The sweep's folder.
    work : PoseWork
    key : str
        Hash of what shaped it.
    """
    path, truth = _truth_path(out, work.pose), work.light.studio.world.truth
    try:
        table: dict[str, Any] = read_json_table(path)
        if table["key"] != key:
            return None
        return {
            sun.text: truth.read(Fields(table["records"][sun.text], path))
            for sun in work.light.suns
        }
    except (DatasetError, ValueError, KeyError, TypeError, AttributeError):
        return None


def write_pose_truth(out: Path, pose: SweepPose, key: str, found: PoseTruth) -> None:
    """Write the truth of a pose.

    Parameters
    ----------
    out : Path
        The sweep's folder.
    pose : SweepPose
    key : str
        Hash of what shaped it.
    found : dict of str to SealedRecord
        By ``--sun`` text.
    """
    records = {text: record.to_json() for text, record in found.items()}
    write_text(_truth_path(out, pose), json.dumps({"key": key, "records": records}) + "\n")


def depth_path(out: Path, pose: SweepPose, band: int) -> Path:
    """Return where the depth of one exposure's pixels lies.

    Parameters
    ----------
    out : Path
        The sweep's folder.
    pose : SweepPose
    band : int, nm
        800 or 850.
    """
    return out / "truth" / f"depth_{pose.time_s:.3f}_{band}.exr"


def has_depth(path: Path, key: str) -> bool:
    """Tell whether a depth is there, whole, and of the geometry that ``key`` names."""
    return read_exr(path, {KEY: key}) is not None


def write_depth(path: Path, key: str, depth_m: Radiance) -> None:
    """Write the depth of one exposure's pixels.

    Parameters
    ----------
    path : Path
    key : str
        Hash of what shaped it.
    depth_m : (height, width) array, m
    """
    write_exr(path, {"Z": depth_m}, {KEY: key})


def _truth_path(out: Path, pose: SweepPose) -> Path:
    return out / "truth" / f"pose_{pose.time_s:.3f}.json"
