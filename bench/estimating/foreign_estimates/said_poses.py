"""Poses as a foreign file says them, one a frame, and what its reader has to know to read it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.dataset.dataset import Dataset
from models.errors import DatasetError
from models.pose import RigidTransform
from models.reading.bounds import LENGTH_M
from models.reading.fields import Fields

TrajectoryOf: TypeAlias = Literal["camera", "target"]
UNIT_TOLERANCE = 1e-3  # a quaternion typed with four digits is one
MOST_NAMED = 5
LEAVE_OUT = "leave out the rows of frames without a pose"


@dataclass(frozen=True)
class Choices:
    """What a file leaves open.

    Attributes
    ----------
    scene, target : int or None
        Of BOP results: which scene is this dataset, which object its target; the only one in the
        file unless given.
    trajectory_of : str
        Of a TUM trajectory: ``camera``, in the target frame, or ``target``, in the camera's.
    """

    scene: int | None = None
    target: int | None = None
    trajectory_of: TrajectoryOf = "camera"


@dataclass(eq=False)
class SaidPoses:
    """What a file says of a dataset's frames, gathered row by row.

    Attributes
    ----------
    path : Path
    dataset : Dataset
    poses : dict of int to RigidTransform
        ``cam_from_target`` by frame.
    runtime_ms : dict of int to float
        By frame, where told.
    remarks : list of str
        What was left out, in words.
    """

    path: Path
    dataset: Dataset
    poses: dict[int, RigidTransform] = field(default_factory=dict)
    runtime_ms: dict[int, float] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)
    _where: dict[int, str] = field(default_factory=dict)
    _known: frozenset[int] = frozenset()

    def __post_init__(self) -> None:
        self._known = frozenset(self.dataset.indices)

    def check_frame(self, frame: int, where: object) -> None:
        """Refuse a frame that the dataset has not.

        Parameters
        ----------
        frame : int
        where : object
            The file with its line, for the message.

        Raises
        ------
        DatasetError
        """
        if frame not in self._known:
            indices = self.dataset.indices
            raise DatasetError(
                f"{where}: expected one of the {len(indices)} frames of {self.dataset.folder} "
                f"({indices[0]} to {indices[-1]}), got {frame}; is it of another dataset?"
            )

    def add(self, frame: int, cam_from_target: RigidTransform, where: object) -> None:
        """Take one frame's pose.

        Parameters
        ----------
        frame : int
        cam_from_target : RigidTransform
        where : object
            The file with its line, for messages.

        Raises
        ------
        DatasetError
            If the dataset has no such frame, or it came before.
        """
        self.check_frame(frame, where)
        if frame in self.poses:
            raise DatasetError(
                f"{where}: expected each frame once, got frame {frame} again, after "
                f"{self._where[frame]}; which of the two is meant?"
            )
        self.poses[frame] = cam_from_target
        self._where[frame] = str(where).removeprefix(f"{self.path}:")


def quaternion(row: Fields, keys: tuple[str, str, str, str]) -> Floats:
    """Return a rotation from a quaternion, (3, 3), made exact.

    Parameters
    ----------
    row : Fields
    keys : tuple of 4 str
        Its w, x, y and z.

    Raises
    ------
    DatasetError
        If a part is no number, or its length is not one to three digits.
    """
    wxyz = np.array([row.number(key, -2.0, 2.0) for key in keys])
    length = float(np.linalg.norm(wxyz))
    if not abs(length - 1.0) <= UNIT_TOLERANCE:
        raise row.refusal(
            f"{keys[0]}, {keys[1]}, {keys[2]}, {keys[3]}",
            "as a quaternion of length 1",
            f"length {length:.6g}; {LEAVE_OUT}",
        )
    return np.asarray(Rotation.from_quat(wxyz / length, scalar_first=True).as_matrix())


def place(row: Fields, keys: tuple[str, str, str]) -> Floats:
    """Return a place, (3,) m, from three columns.

    Raises
    ------
    DatasetError
        If one is no number, or farther than a target is ever seen.
    """
    return np.array([row.number(key, *LENGTH_M, unit="m") for key in keys])
