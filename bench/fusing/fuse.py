"""Estimates of a chaser's fixed camera and of the one in its arm's hand, of one flight, as one."""

from __future__ import annotations

import bisect
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.estimating.estimates_place import is_ours
from models.arm.onboard_arm import ARM_FILE, ARM_JOINTS, OnboardArm
from models.atomic_file import sweep_beside
from models.dataset.dataset import Dataset, open_dataset
from models.dataset.estimates_file import read_estimates, write_estimates
from models.dataset.sensor_table import read_table
from models.errors import DatasetError
from models.estimate import Estimate
from models.frame import Frame, Reading, TableReading
from models.output_folder import check_place
from models.pose import RigidTransform
from models.spacecraft.grasp_markers import GRASPING_POINT_M
from pipelines.two_cameras.over_time import TwoCamerasOverTime
from pipelines.two_cameras.pipeline import CHASER_POSE, HAND_POSE, TwoCameras

SAME_INSTANT_S, SAME_JOINT_DEG = 1e-6, 1e-6
BETWEEN_TARGETS = {("maxar1300", "maxar1300_grasp"): GRASPING_POINT_M}
"""Origins of the hand camera's target frame in that of the chaser-fixed one's, by their names."""
MODES = {
    "both": "by both cameras",
    "rival": "by both, the second pose that fits three dots being right",
    "hand": "by the hand camera alone",
    "chaser": "by the chaser-fixed camera alone",
    "carried": "by the frames before",
    "": "without a pose",
}


@dataclass(frozen=True)
class Fused:
    """What came of it.

    Attributes
    ----------
    file : Path
    frames_by : dict of str to int
        How many frames have a pose by whom.
    """

    file: Path
    frames_by: dict[str, int]


def fuse(
    hand: Path,
    chaser: Path,
    out: Path,
    label: str = "best",
    origin_m: tuple[float, float, float] | None = None,
    over_time: bool = False,
) -> Fused:
    """Write the hand camera's poses as both cameras have them; its dataset is only read.

    Parameters
    ----------
    hand, chaser : Path
        Datasets of one flight, estimated: of the camera in the arm's hand, and of the other.
    out : Path
        The estimates file.
    label : str
        Whose estimates.
    origin_m : (3,) tuple, optional, m
        Origin of the hand camera's target frame in that of the other's, axes being parallel; of the
        house's targets it is known.
    over_time : bool
        Whether one state lasts from frame to frame, or each frame stands for itself.

    Raises
    ------
    DatasetError
        If one is not of an arm, not estimated, or they are of two flights.
    """
    one, other = open_dataset(hand), open_dataset(chaser)
    arms = [_arm(each) for each in (one, other)]
    if not arms[0].carries_camera or arms[1].carries_camera:
        raise DatasetError(
            f"expected first a dataset of the hand camera, then one of the chaser-fixed camera, "
            f"got {arm_camera(arms[0])} ({hand}) and {arm_camera(arms[1])} ({chaser})"
        )
    joints = [_joints(each) for each in (one, other)]
    _check_one_flight(one, other, joints)
    place = _origin(one, other) if origin_m is None else np.array(origin_m)
    between = RigidTransform(np.eye(3), np.asarray(place, dtype=np.float64))
    said = {each.frame: each for each in _estimates(one, label)}
    beside = sorted(_estimates(other, label), key=lambda each: each.time_s)
    told = (arms[0], one.onboard.sigmas, between)
    if over_time:
        fused = _over_time(TwoCamerasOverTime(*told), one, joints[0], said, beside)
    else:
        fused = _frame_by_frame(TwoCameras(*told), one, joints[0], said, beside)
    check_place(out.parent)
    if (out.exists() or out.is_symlink()) and not is_ours(out):
        raise DatasetError(
            f"expected {out} to be new, or estimates that rvbench wrote, got another file; "
            "name another with --out"
        )
    sweep_beside(out)
    write_estimates(out, fused)
    counts = Counter(each.mode for each in fused)
    return Fused(out, {told: counts[mode] for mode, told in MODES.items() if counts[mode]})


def _frame_by_frame(
    fusing: TwoCameras,
    hand: Dataset,
    joints: Mapping[int, TableReading],
    said: Mapping[int, Estimate],
    beside: Sequence[Estimate],
) -> list[Estimate]:
    """Give each frame the chaser-fixed camera's last word, however old."""
    fused = []
    for entry in hand.entries:
        readings = _readings(entry.index, joints, said)
        last = _until(beside, entry.time_s + SAME_INSTANT_S)
        if last:
            readings[CHASER_POSE] = beside[last - 1]
        fused.append(fusing.process(Frame(entry.index, entry.time_s, readings)))
    return fused


def _over_time(
    fusing: TwoCamerasOverTime,
    hand: Dataset,
    joints: Mapping[int, TableReading],
    said: Mapping[int, Estimate],
    beside: Sequence[Estimate],
) -> list[Estimate]:
    """Give all that the chaser-fixed camera says, each at its time."""
    fused, taken = [], 0
    for entry in hand.entries:
        readings = _readings(entry.index, joints, said)
        before = _until(beside, entry.time_s - SAME_INSTANT_S)
        for each in beside[taken:before]:
            fusing.take_in(each)
        taken = _until(beside, entry.time_s + SAME_INSTANT_S)
        if taken > before:
            readings[CHASER_POSE] = beside[taken - 1]
        fused.append(fusing.process(Frame(entry.index, entry.time_s, readings)))
    return fused


def _readings(
    frame: int, joints: Mapping[int, TableReading], said: Mapping[int, Estimate]
) -> dict[str, Reading]:
    readings: dict[str, Reading] = {ARM_JOINTS: joints[frame]}
    if frame in said:
        readings[HAND_POSE] = said[frame]
    return readings


def _until(said: Sequence[Estimate], time_s: float) -> int:
    return bisect.bisect_right(said, time_s, key=lambda each: each.time_s)


def arm_camera(arm: OnboardArm) -> str:
    """Return whose images they are, in words."""
    return "the hand camera" if arm.carries_camera else "the chaser-fixed camera"


def _arm(dataset: Dataset) -> OnboardArm:
    table = dataset.onboard.tables.get(ARM_FILE)
    if table is None:
        raise DatasetError(
            f"{dataset.folder}: expected a dataset of a chaser with an arm, got none on board; "
            "give its scenario a table [arm]"
        )
    return OnboardArm.of_table(table)


def _joints(dataset: Dataset) -> dict[int, TableReading]:
    stream = dataset.info.stream(ARM_JOINTS)
    return read_table(stream.path(dataset.folder), stream.columns, dataset.entries)


def _check_one_flight(one: Dataset, other: Dataset, joints: list[dict[int, TableReading]]) -> None:
    """Refuse datasets whose arms are read otherwise at one instant, or that share none."""
    times_s = {entry.time_s: entry.index for entry in other.entries}
    shared = [
        (entry, near)
        for entry in one.entries
        for near in times_s
        if abs(entry.time_s - near) < SAME_INSTANT_S
    ]
    if not shared:
        raise DatasetError(
            f"expected two datasets of one flight with frames at the same times, got "
            f"{one.entries[0].time_s:g} to {one.entries[-1].time_s:g} s and "
            f"{other.entries[0].time_s:g} to {other.entries[-1].time_s:g} s; give both scenarios "
            "one motion"
        )
    for entry, near in shared:
        own, theirs = joints[0][entry.index].rows[-1], joints[1][times_s[near]].rows[-1]
        if own.shape != theirs.shape or np.abs(own - theirs).max() > SAME_JOINT_DEG:
            raise DatasetError(
                f"expected two datasets of one flight, got joints that are read otherwise at "
                f"{near:g} s in {one.folder} and {other.folder}; give both scenarios one motion, "
                "one [arm] and one [told.arm]"
            )


def _origin(one: Dataset, other: Dataset) -> tuple[float, float, float]:
    names = (other.info.target, one.info.target)
    if names[0] == names[1]:
        return (0.0, 0.0, 0.0)
    if names in BETWEEN_TARGETS:
        return BETWEEN_TARGETS[names]
    raise DatasetError(
        f"expected datasets of one target, or of maxar1300 and maxar1300_grasp, got {names[0]} and "
        f"{names[1]}; tell with --origin-m where the latter's frame has its origin in the former's"
    )


def _estimates(dataset: Dataset, label: str) -> list[Estimate]:
    path = dataset.folder / "estimates" / f"{label}.jsonl"
    if not path.is_file():
        raise DatasetError(
            f"{dataset.folder}: expected estimates of {label}, got none; run "
            f"`rvbench estimate {dataset.folder}`, or name others with --variant"
        )
    return read_estimates(path)
