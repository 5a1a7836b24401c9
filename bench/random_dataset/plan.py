"""Every frame of a random dataset, drawn before anything is rendered."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from bench.random_dataset.draws import (
    Aim,
    DrawnPose,
    draw_exposure_ms,
    draw_pose,
    draw_sun,
    rng_of,
)
from bench.random_dataset.parts import Part, parts_of, row_text
from bench.random_dataset.spec_tables import Spec
from bench.runners.chunks import runs_in_order
from models.arrays import Floats
from renders.scenario.scenario import Scenario

PART_OF_POSE, SPLIT = 21, 22  # purposes that key the draws
TRAIN, VAL, TEST = SPLITS = ("train", "val", "test")
LEAST_GAP_S = 1.0  # from one frame of a part to the next


@dataclass(frozen=True, eq=False)
class Shot:
    """One frame.

    Attributes
    ----------
    number : int
        Of the whole dataset, from 0.
    part : int
    frame : int
        In its part.
    pose_number : int
    pose : DrawnPose
    sun_dir_in_target : (3,) array
    exposure_ms : float, ms
    split : str
        train, val or test.
    """

    number: int
    part: int
    frame: int
    pose_number: int
    pose: DrawnPose
    sun_dir_in_target: Floats
    exposure_ms: float
    split: str

    @property
    def phase_deg(self) -> float:
        """Angle between Sun and camera as the target sees them."""
        cosine = float(np.clip(self.sun_dir_in_target @ self.pose.to_camera, -1.0, 1.0))
        return float(np.rad2deg(np.arccos(cosine)))


@dataclass(frozen=True, eq=False)
class Plan:
    """A whole dataset as drawn.

    Attributes
    ----------
    spec : Spec
    parts : list of Part
    shots : list of Shot
        In the order of their numbers.
    refused : Counter
        Draws that were refused, by reason.
    """

    spec: Spec
    parts: list[Part]
    shots: list[Shot]
    refused: Counter[str]

    @property
    def used(self) -> list[Part]:
        """Parts that have frames."""
        numbers = {shot.part for shot in self.shots}
        return [part for part in self.parts if part.number in numbers]

    def of_part(self, part: Part) -> list[Shot]:
        """Return the shots of a part, by frame."""
        return [shot for shot in self.shots if shot.part == part.number]

    def scenario(self, part: Part) -> Scenario:
        """Return a part's scenario.

        Raises
        ------
        ScenarioError
            If it cannot be rendered.
        """
        gap_s = max(LEAST_GAP_S, 2e-3 * self.spec.exposure.exposure_ms[1])
        return part.scenario([_row(shot, gap_s) for shot in self.of_part(part)])


def make_plan(spec: Spec, where: Path) -> Plan:
    """Draw a dataset.

    Parameters
    ----------
    spec : Spec
    where : Path
        Its file.

    Raises
    ------
    ScenarioError
        If no pose or Sun is found that is not refused.
    """
    parts = parts_of(spec, where)
    splits, refused = splits_of(spec), Counter[str]()
    shots: list[Shot] = []
    frames: Counter[int] = Counter()
    for number in range(spec.poses):
        part = parts[part_of_pose(spec, len(parts), number)]
        for shot in _shots_of_pose(spec, part.aim, part, number, refused):
            frame = frames[part.number]
            frames[part.number] += 1
            pose, sun, exposure_ms = shot
            shots.append(
                Shot(len(shots), part.number, frame, number, pose, sun, exposure_ms, splits[number])
            )
            if len(shots) == spec.frames:
                break
    return Plan(spec, parts, shots, refused)


def shots_by_chunk(plan: Plan, chunks: int) -> list[list[Shot]]:
    """Return the shots of each chunk: whole poses, and few parts each, so few scenes to build.

    Parameters
    ----------
    plan : Plan
    chunks : int
    """
    by_pose: dict[tuple[int, int], list[Shot]] = {}
    for shot in plan.shots:
        by_pose.setdefault((shot.part, shot.pose_number), []).append(shot)
    cut = runs_in_order([by_pose[pose] for pose in sorted(by_pose)], chunks)
    return [[shot for pose in poses for shot in pose] for poses in cut]


def part_of_pose(spec: Spec, parts: int, number: int) -> int:
    """Return which part a pose is of: each once in a row of as many poses, in a drawn order.

    Parameters
    ----------
    spec : Spec
    parts : int
        How many there are.
    number : int
        Of the pose.
    """
    turn, place = divmod(number, parts)
    return int(rng_of(spec, PART_OF_POSE, turn).permutation(parts)[place])


def splits_of(spec: Spec) -> list[str]:
    """Return each pose's split: poses in a drawn order, cut where the shares end."""
    order = np.random.default_rng([spec.split.seed, SPLIT]).permutation(spec.poses)
    shares = np.cumsum([spec.split.train, spec.split.val, spec.split.test])
    ends = np.rint(shares * spec.poses).astype(int)
    found = [""] * spec.poses
    for rank, number in enumerate(order.tolist()):
        found[number] = SPLITS[min(int(np.searchsorted(ends, rank, side="right")), 2)]
    return found


def _shots_of_pose(
    spec: Spec, aim: Aim, part: Part, number: int, refused: Counter[str]
) -> list[tuple[DrawnPose, Floats, float]]:
    pose = draw_pose(spec, aim, part.camera, number, refused)
    suns = [draw_sun(spec, pose, number, k, refused) for k in range(spec.suns_per_pose)]
    each = spec.exposures_per_sun
    return [
        (pose, suns[k // each], draw_exposure_ms(spec, number, k))
        for k in range(spec.frames_per_pose)
    ]


def _row(shot: Shot, gap_s: float) -> str:
    pose = shot.pose
    wxyz = Rotation.from_matrix(pose.cam_from_target.rotation).as_quat(scalar_first=True)
    values = [
        *pose.cam_from_target.translation,
        *wxyz,
        *shot.sun_dir_in_target,
        shot.exposure_ms,
        *pose.earth_dir_in_target,
    ]
    return row_text(shot.frame * gap_s, values, pose.background)
