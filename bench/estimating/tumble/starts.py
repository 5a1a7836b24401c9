"""Acquisition tried at many moments of a tumble, each time as if nothing had been seen before.

It reads the public half of a dataset and writes what came of it beside the estimates::

    DIR/estimates/starts/best.json      what came of every start
                         best/          the same as units, so that a killed trial goes on
"""

from __future__ import annotations

import json
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench.suites.spread import do_units
from bench.suites.units import Outcome, WorkUnit, done_outcome
from models.atomic_file import sweep_beside, write_text
from models.dataset.dataset import Dataset, open_dataset
from models.errors import DatasetError, UnreadableError, cause
from models.plain_console import plain_console
from models.pose import RigidTransform
from models.reading.json_file import read_json_table
from pipelines.pipeline import RegisteredPipeline
from pipelines.registry import registered_pipeline

OURS = "uncooperative"
STARTS = 50
MOST_IMAGES = 5
CHUNK = 5  # starts of one unit
IMAGE_S = 2.0  # until one was timed


@dataclass(frozen=True)
class StartsTask:
    """Some starts on a dataset by one variant.

    Attributes
    ----------
    folder : str
    dataset : str
        Hash of its public half.
    pipeline, variant, settings : str
        Name of the pipeline, its variant, and a hash of all settings.
    frames : tuple of tuples of int
        By start: the frames that it may look at, in order.
    """

    folder: str
    dataset: str
    pipeline: str
    variant: str
    settings: str
    frames: tuple[tuple[int, ...], ...]


@dataclass(frozen=True, eq=False)
class Start:
    """What came of one.

    Attributes
    ----------
    frame : int
        The first that it looked at.
    images : int
        How many it looked at until one gave a pose; 0 if none did.
    cam_from_target : RigidTransform or None
        Of the last of those images.
    pose_frame : int or None
        Which that is.
    seconds : float
    reason : str
        What the last image without a pose was said to lack.
    """

    frame: int
    images: int
    cam_from_target: RigidTransform | None
    pose_frame: int | None
    seconds: float
    reason: str


def starts_path(folder: Path, variant: str) -> Path:
    """Return the file of one variant's starts."""
    return folder / "estimates" / "starts" / f"{variant}.json"


def chosen_starts(
    indices: list[int], starts: int = STARTS, most_images: int = MOST_IMAGES
) -> tuple[tuple[int, ...], ...]:
    """Return, by start, the frames that it may look at: starts evenly spread over a dataset.

    The last starts have images left to go on to, where the dataset has enough.

    Parameters
    ----------
    indices : list of int
        Of the dataset's frames.
    starts : int
        How many; fewer where the dataset has no other places for them.
    most_images : int
        That each may look at.
    """
    last = max(0, len(indices) - most_images)
    places = dict.fromkeys(np.linspace(0, last, starts).round().astype(int).tolist())
    return tuple(tuple(indices[place : place + most_images]) for place in places)


def try_starts(
    dataset: Dataset,
    workers: int = 1,
    starts: int = STARTS,
    most_images: int = MOST_IMAGES,
    pipeline: str = OURS,
) -> list[Path]:
    """Try what is not tried yet, by all variants, and write what came of it.

    Parameters
    ----------
    dataset : Dataset
        Of single images; its truth half is not read.
    workers : int
    starts, most_images : int
        How many starts, and images that each may look at.
    pipeline : str
        Name of the pipeline.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    DatasetError
        If the public half cannot be read.
    """
    frames = chosen_starts(dataset.indices, starts, most_images)
    home = dataset.folder / "estimates" / "starts"
    content = dataset.content_fingerprint()
    registered = registered_pipeline(pipeline)
    units = {
        registered.labelled(variant): _units(dataset.folder, content, registered, variant, frames)
        for variant in registered.variants
    }
    do_units([unit for own in units.values() for unit in own], home, workers,
             plain_console(stderr=True))  # fmt: skip
    return [
        _write(dataset.folder, label, most_images, [done_outcome(home, unit) for unit in own])
        for label, own in units.items()
    ]


def _units(
    folder: Path,
    dataset: str,
    pipeline: RegisteredPipeline,
    variant: str,
    frames: tuple[tuple[int, ...], ...],
) -> list[WorkUnit]:
    return [
        WorkUnit(
            name=f"{pipeline.labelled(variant)}/from_{frames[first][0]:06d}",
            work=tried,
            task=StartsTask(
                folder=str(folder.resolve()),
                dataset=dataset,
                pipeline=pipeline.name,
                variant=variant,
                settings=pipeline.settings_hash(variant),
                frames=frames[first : first + CHUNK],
            ),
            kind=f"starts, {pipeline.labelled(variant)}",
            expected_s=CHUNK * IMAGE_S,
            modules=(pipeline.make.__module__,),
        )
        for first in range(0, len(frames), CHUNK)
    ]


def tried(task: StartsTask) -> Outcome:
    """Try some starts."""
    dataset = open_dataset(Path(task.folder))
    rows: list[list[float]] = []
    poses, seconds, reasons = [], [], []
    for frames in task.frames:
        pipeline = registered_pipeline(task.pipeline).make(dataset.onboard, task.variant)
        spent_s, images, pose, reason = 0.0, 0, np.full((3, 4), np.nan), ""
        for place, index in enumerate(frames, start=1):
            frame = dataset.frame(index)
            began = time.process_time()
            said = pipeline.process(frame)
            spent_s += time.process_time() - began
            if said.pose is not None:
                images = place
                pose = said.pose.cam_from_target.matrix()[:3]
                break
            reason = said.reason or ""
        rows.append([frames[0], images, frames[images - 1] if images else -1])
        poses.append(pose)
        seconds.append(spent_s)
        reasons.append(reason)
    table = np.array(rows, dtype=np.int64)
    values = {
        "frame": table[:, 0],
        "images": table[:, 1],
        "pose_frame": table[:, 2],
        "cam_from_target": np.array(poses),
        "reason": np.array(reasons, dtype=np.str_),
    }
    return Outcome(values, np.array(seconds))


def _write(folder: Path, variant: str, most_images: int, outcomes: list[Outcome]) -> Path:
    listed: list[dict[str, Any]] = []
    for outcome in outcomes:
        for place, frame in enumerate(outcome.values["frame"].tolist()):
            images = int(outcome.values["images"][place])
            pose = outcome.values["cam_from_target"][place]
            listed.append(
                {
                    "frame": frame,
                    "images": images,
                    "pose_frame": int(outcome.values["pose_frame"][place]) if images else None,
                    "cam_from_target": pose.tolist() if images else None,
                    "reason": str(outcome.values["reason"][place]),
                    "seconds": float(outcome.seconds[place]),
                }
            )
    path = starts_path(folder, variant)
    document = {"variant": variant, "most_images": most_images, "starts": listed}
    sweep_beside(path)
    write_text(path, json.dumps(document, indent=1) + "\n")
    return path


def read_starts(folder: Path, variant: str) -> tuple[int, list[Start]]:
    """Read one variant's starts: how many images each might look at, and what came of each.

    A dataset on which none were tried has none.

    Raises
    ------
    DatasetError
        If the file is there and cannot be read.
    """
    path = starts_path(folder, variant)
    if not path.is_file():
        return 0, []
    try:
        document = read_json_table(path)
        starts = [
            Start(
                frame=int(each["frame"]),
                images=int(each["images"]),
                cam_from_target=_pose(each["cam_from_target"]),
                pose_frame=None if each["pose_frame"] is None else int(each["pose_frame"]),
                seconds=float(each["seconds"]),
                reason=str(each["reason"]),
            )
            for each in document["starts"]
        ]
        return int(document["most_images"]), starts
    except (UnreadableError, KeyError, TypeError, ValueError) as error:
        raise DatasetError(
            f"{path}: expected the starts that were tried, got: {cause(error)}; "
            "delete it and estimate again: only what is missing is done"
        ) from error


def _pose(rows: list[list[float]] | None) -> RigidTransform | None:
    if rows is None:
        return None
    matrix = np.array(rows, dtype=np.float64).reshape(3, 4)
    return RigidTransform(matrix[:, :3], matrix[:, 3])
