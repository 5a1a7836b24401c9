"""Files that a scenario names, read into it: of them a resolved scenario needs a mesh alone.

A ``target`` of one's own, ``camera.file``, ``motion.file`` and ``markers`` lie beside the scenario.
What they say then stands in the scenario itself, so its fingerprint covers it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeVar

from models.arm.arm_file import is_urdf, own_arm, read_arm_lines
from models.camera import Camera
from models.dataset.marker_file import read_markers
from models.errors import DatasetError, ScenarioError
from models.motion.pose_table import PoseTable, pose_table, read_pose_lines
from models.pose import RigidTransform
from models.reading.toml_file import read_toml
from renders.scenario.camera_tables import CameraTable
from renders.scenario.own_target import with_own_target_read

Read = TypeVar("Read")
BESIDE_A_FILE = ("file", "rendered_width")  # keys of [camera] that say nothing of the camera


def with_files_read(table: dict[str, Any], path: Path) -> dict[str, Any]:
    """Return a scenario's table with the files that it names read into it.

    Values of a wrong kind are left for the tables to refuse.

    Parameters
    ----------
    table : dict
        As its file has it.
    path : Path
        The scenario's file; others are named from its folder.

    Raises
    ------
    ScenarioError
        If a file cannot be read, or says what the scenario says as well.
    """
    table = {key: dict(value) if isinstance(value, dict) else value for key, value in table.items()}
    with_own_target_read(table, path)
    if "camera" in table:
        table["camera"] = with_camera_read(table["camera"], path)
    if isinstance(table.get("markers"), str):
        file = path.parent / table["markers"]
        _read(lambda: read_markers(file))
        table["markers"] = _read(lambda: read_toml(file))
    _read_poses(table, path)
    _read_arm(table, path)
    motion, sun = table.get("motion"), table.setdefault("sun", {})
    if isinstance(motion, dict) and "epoch_utc" in motion and isinstance(sun, dict):
        sun.setdefault("default", "epoch")
    if sun == {}:
        del table["sun"]
    return table


def with_camera_read(camera: Any, path: Path) -> Any:
    """Return a table of a camera with the file that it names read into it; others as they are.

    Parameters
    ----------
    camera : Any
        As a file has it.
    path : Path
        That file; the camera's is named from its folder.

    Raises
    ------
    ScenarioError
        If it cannot be read, or the table says what it says as well.
    """
    if not isinstance(camera, dict) or not isinstance(camera.get("file"), str):
        return camera
    twice = [key for key in CameraTable.model_fields if key in camera and key not in BESIDE_A_FILE]
    if twice:
        raise ScenarioError(
            f"{path}: expected camera.file alone, or the keys of a camera, got file = "
            f"{camera['file']!r} and {', '.join(twice)}; leave one of them out"
        )
    rest = {key: value for key, value in camera.items() if key != "file"}
    own = asdict(Camera.from_toml(path.parent / camera["file"]))
    sides = ("width", "height")
    return rest | {name: x if name in sides else float(x) for name, x in own.items()}


def _read_arm(table: dict[str, Any], path: Path) -> None:
    arm = table.get("arm")
    if not isinstance(arm, dict) or not isinstance(arm.get("file"), str):
        return
    file = path.parent / arm.pop("file")
    if "lines" in arm:
        raise ScenarioError(
            f"{path}: expected arm.file or arm.lines, got both; leave one of them out"
        )
    arm["kind"] = "urdf" if is_urdf(file) else "toml"
    arm["lines"] = _read(lambda: read_arm_lines(file))
    _read(lambda: own_arm(arm["lines"], file, RigidTransform.identity()))


def _read_poses(table: dict[str, Any], path: Path) -> None:
    motion = table.get("motion")
    if not isinstance(motion, dict):
        return
    if isinstance(motion.get("file"), str):
        if "table" in motion:
            raise ScenarioError(
                f"{path}: expected motion.file or motion.table, got both; leave one of them out"
            )
        file = path.parent / motion.pop("file")
        motion["table"] = lines = _read(lambda: read_pose_lines(file))
        poses = _read(lambda: pose_table(lines, file))
    else:
        typed = motion.get("table")
        if not isinstance(typed, list) or not all(type(line) is str for line in typed):
            return
        poses = _read(lambda: pose_table(typed, f"{path}: motion.table"))
    _say_what_follows(table, motion, poses)


def _say_what_follows(table: dict[str, Any], motion: dict[str, Any], poses: PoseTable) -> None:
    """Let a table's span, Sun and exposures stand where nothing else is typed."""
    motion.setdefault("start_s", float(poses.times_s[0]))
    motion.setdefault("end_s", float(poses.times_s[-1]))
    given = {
        ("sun", "default"): poses.sun_dirs_in_target is not None,
        ("exposure", "mode"): poses.exposures_ms is not None,
    }
    for (name, key), is_given in given.items():
        inner = table.get(name, {})
        if is_given and isinstance(inner, dict):
            table[name] = {key: "table", **inner}


def _read(read: Callable[[], Read]) -> Read:
    try:
        return read()
    except DatasetError as error:
        raise ScenarioError(str(error)) from error
