"""``truth/arm.jsonl``: how the arm stood at each exposure, and where both cameras were."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from models.arrays import Floats
from models.errors import DatasetError, UnreadableError
from models.pose import RigidTransform
from models.reading.bounds import ANGLE_DEG, FRAME, LENGTH_M, TIME_S
from models.reading.fields import Fields
from models.reading.json_file import read_json_lines
from models.reading.regular_file import MEGABYTE
from renders.world.world import World

ARM_TRUTH = "truth/arm.jsonl"
MOST_BYTES = 400 * MEGABYTE


@dataclass(frozen=True, eq=False)
class ArmTruth:
    """The arm at one exposure.

    Attributes
    ----------
    frame, band : int
    time_s : float, s
        Middle of the exposure.
    joints_deg : (n,) array, deg
    chaser_from_target : RigidTransform
        Of the camera that is fixed to the chaser.
    hand_from_target : RigidTransform
        Of the camera that the arm carries.
    """

    frame: int
    band: int
    time_s: float
    joints_deg: Floats
    chaser_from_target: RigidTransform
    hand_from_target: RigidTransform


def arm_truth_lines(world: World) -> str | None:
    """Return the text of ``arm.jsonl``; None where the chaser has no arm that moves."""
    arm = world.arm
    if arm is None:
        return None
    lines = []
    for exposure in world.exposures:
        chaser = arm.chaser.cam_from_target(exposure.time_s)
        hand = arm.hand_from_chaser(exposure.time_s) @ chaser
        line = {
            "frame": exposure.frame,
            "band": exposure.band,
            "time_s": exposure.time_s,
            "joints_deg": arm.motion.angles_at(exposure.time_s).tolist(),
            "R_chaser_from_target": chaser.rotation.tolist(),
            "t_chaser_from_target_m": chaser.translation.tolist(),
            "R_hand_from_target": hand.rotation.tolist(),
            "t_hand_from_target_m": hand.translation.tolist(),
        }
        lines.append(json.dumps(line) + "\n")
    return "".join(lines)


def read_arm_truths(folder: Path) -> dict[tuple[int, int], ArmTruth]:
    """Read the arm's truth of a dataset, by (frame, band).

    Raises
    ------
    DatasetError
        If there is none, or a line of it cannot be.
    """
    path = folder / ARM_TRUTH
    found = {}
    try:
        for number, table in read_json_lines(path, MOST_BYTES):
            row = Fields(table, f"{path}:{number}")
            truth = ArmTruth(
                row.whole("frame", *FRAME),
                row.whole("band", 0, 100_000),
                row.number("time_s", *TIME_S),
                row.vector("joints_deg", None, *ANGLE_DEG),
                row.pose("R_chaser_from_target", "t_chaser_from_target_m", *LENGTH_M),
                row.pose("R_hand_from_target", "t_hand_from_target_m", *LENGTH_M),
            )
            found[truth.frame, truth.band] = truth
    except UnreadableError as error:
        raise DatasetError(
            f"expected the truth of an arm at {path}, got: {error.reason}; only datasets whose "
            "scenario has [arm] have one"
        ) from error
    return found
