"""Estimates as other tools write them, by rules of their own: none of the house's readers."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from models.pose import RigidTransform

DIGITS = ".17g"
Said = Iterable[tuple[int, float, RigidTransform]]  # frame, its time in s, cam_from_target


def words(values: Iterable[float]) -> str:
    """Return numbers apart by spaces, every digit kept."""
    return " ".join(format(float(value), DIGITS) for value in values)


def wxyz(rotation: np.ndarray) -> np.ndarray:
    """Return a rotation's quaternion, scalar first, by its largest eigenvector (Bar-Itzhack 2000).

    Not by SciPy, by which the readers make it a matrix.
    """
    r = rotation
    k = np.array(
        [
            [r[0, 0] - r[1, 1] - r[2, 2], r[1, 0] + r[0, 1], r[2, 0] + r[0, 2], r[2, 1] - r[1, 2]],
            [r[1, 0] + r[0, 1], r[1, 1] - r[0, 0] - r[2, 2], r[2, 1] + r[1, 2], r[0, 2] - r[2, 0]],
            [r[2, 0] + r[0, 2], r[2, 1] + r[1, 2], r[2, 2] - r[0, 0] - r[1, 1], r[1, 0] - r[0, 1]],
            [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], np.trace(r)],
        ]
    )
    x, y, z, w = np.linalg.eigh(k)[1][:, -1]
    return np.array([w, x, y, z])


def write_bop(path: Path, said: Said, scene: int = 1, target: int = 1) -> Path:
    """Write BOP results: rotations row by row, places in mm."""
    rows = ["scene_id,im_id,obj_id,score,R,t,time"]
    for frame, _, pose in said:
        rotation, place_mm = words(pose.rotation.ravel()), words(1e3 * pose.translation)
        rows.append(f"{scene},{frame},{target},0.9,{rotation},{place_mm},0.25")
    path.write_text("\n".join(rows) + "\n")
    return path


def write_speed(path: Path, said: Said) -> Path:
    """Write a SPEED submission, scalar first, as that format's images are named."""
    rows = []
    for frame, _, pose in said:
        numbers = words([*wxyz(pose.rotation), *pose.translation]).replace(" ", ",")
        rows.append(f"img{frame:06d}.jpg,{numbers}")
    path.write_text("\n".join(rows) + "\n")
    return path


def write_tum(path: Path, said: Said, of: str = "camera") -> Path:
    """Write a trajectory, scalar last: the camera's in the target frame, or the other way round."""
    rows = ["# timestamp tx ty tz qx qy qz qw"]
    for _, time_s, pose in said:
        rotation, place = pose.rotation, pose.translation
        if of == "camera":
            rotation, place = pose.rotation.T, -pose.rotation.T @ pose.translation
        w, x, y, z = wxyz(rotation)
        rows.append(f"{time_s!r} {words([*place, x, y, z, w])}")
    path.write_text("\n".join(rows) + "\n")
    return path


def write_own(path: Path, said: Said) -> Path:
    """Write our own format by hand."""
    lines = [{"format": "rvbench-estimates", "version": 2}]
    for frame, time_s, pose in said:
        told = {
            "R_cam_from_target": pose.rotation.tolist(),
            "t_cam_from_target_m": pose.translation.tolist(),
        }
        lines.append({"frame": frame, "time_s": time_s, "pose": told})
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    return path


WRITERS = {"bop": write_bop, "speed": write_speed, "tum": write_tum, "rvbench": write_own}
ENDINGS = {"bop": "csv", "speed": "csv", "tum": "txt", "rvbench": "jsonl"}
