"""Joint angles that bring the end effector to a pose: damped least squares within the limits.

Each step solves ``(J J^T + damping I) y = error`` and moves the joints by ``J^T y`` (Nakamura and
Hanafusa 1986; Wampler 1986); the damping follows Marquardt's rule. A joint that stands at a limit
and would be moved beyond it is held, and the step is solved again without it (Rosen 1960). What is
found depends on where the search begins, so it begins at several postures.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from models.arm.arm import Arm
from models.arm.kinematics import chain, jacobian_of
from models.arrays import Floats, Mask
from models.pose import RigidTransform

STARTS = 60  # postures from which a search begins
STEPS = 80
FOUND = 1e-10  # of rad, and of the arm's reach: beyond this a pose is not met
FIRST_DAMPING, LEAST_DAMPING, MOST_DAMPING = 1e-2, 1e-12, 1e6  # the least keeps off singular
STALLED = 1e-14  # relative gain of a step
SEED = 0xA12


@dataclass(frozen=True, eq=False)
class Attempt:
    """How near one search has come.

    Attributes
    ----------
    angles_rad : (n,) array, rad
        Within the limits.
    turn_rad, shift_m : float
        What is left to the pose asked for.
    pushes : (n,) array
        By how much the error would fall with a joint, rad, were it not held by its limit; zero for
        joints that are free. Above zero at the upper limit, below at the lower.
    found : bool
    """

    angles_rad: Floats
    turn_rad: float
    shift_m: float
    pushes: Floats
    found: bool


def solutions(
    arm: Arm,
    base_from_tool: RigidTransform,
    near_rad: ArrayLike | None = None,
    starts: int = STARTS,
) -> Iterator[Floats]:
    """Yield joint angles that meet a pose, as searches find them; the same in every run.

    Parameters
    ----------
    arm : Arm
    base_from_tool : RigidTransform
        The pose of the end effector that is asked for.
    near_rad : (n,) array, rad, optional
        Where the first search begins; the middle of the limits unless given.
    starts : int
        How many searches there are.

    Yields
    ------
    (n,) array, rad
    """
    for start in start_postures(arm, near_rad, starts):
        attempt = search(arm, base_from_tool, start)
        if attempt.found:
            yield attempt.angles_rad


def start_postures(arm: Arm, near_rad: ArrayLike | None, starts: int) -> Iterator[Floats]:
    """Yield where searches begin: as told, in the middle, then drawn evenly.

    Parameters
    ----------
    arm : Arm
    near_rad : (n,) array, rad, optional
    starts : int
        How many are drawn.

    Yields
    ------
    (n,) array, rad
    """
    if near_rad is not None:
        yield np.clip(np.asarray(near_rad, dtype=np.float64), arm.lower_rad, arm.upper_rad)
    yield arm.middle_rad
    draws = np.random.default_rng(SEED).random((starts, len(arm.joints)))
    yield from arm.lower_rad + draws * (arm.upper_rad - arm.lower_rad)


def search(arm: Arm, base_from_tool: RigidTransform, start_rad: ArrayLike) -> Attempt:
    """Search from one posture.

    Parameters
    ----------
    arm : Arm
    base_from_tool : RigidTransform
    start_rad : (n,) array, rad
        Within the limits.
    """
    aim, length = base_from_tool.matrix(), max(arm.reach_m, 1e-9)
    angles = np.clip(np.asarray(start_rad, dtype=np.float64), arm.lower_rad, arm.upper_rad)
    links = chain(arm, angles)
    error, damping = _error(aim, links[-1], length), FIRST_DAMPING
    for _ in range(STEPS):
        if np.linalg.norm(error) < FOUND:
            break
        slope = _scaled(jacobian_of(links), length)
        held = _held(arm, angles, slope.T @ error)
        step = _step(slope, error, damping, held, arm, angles)
        moved = np.clip(angles + step, arm.lower_rad, arm.upper_rad)
        links_there = chain(arm, moved)
        error_there = _error(aim, links_there[-1], length)
        before, after = float(error @ error), float(error_there @ error_there)
        if after < before:
            angles, links, error = moved, links_there, error_there
            damping = max(0.1 * damping, LEAST_DAMPING)
            if before - after < STALLED * before:
                break
        else:
            damping *= 10.0
            if damping > MOST_DAMPING:
                break
    pull = _scaled(jacobian_of(links), length).T @ error
    turn, shift = float(np.linalg.norm(error[:3])), float(length * np.linalg.norm(error[3:]))
    found = bool(np.linalg.norm(error) < FOUND)
    return Attempt(angles, turn, shift, np.where(_held(arm, angles, pull), pull, 0.0), found)


def _error(aim: Floats, is_at: Floats, length: float) -> Floats:
    """Return what is left to the aim, (6,): a rotation vector, and a way over the arm's reach."""
    turn = aim[:3, :3] @ is_at[:3, :3].T
    return np.concatenate([rotation_vector(turn), (aim[:3, 3] - is_at[:3, 3]) / length])


def rotation_vector(rotation: Floats) -> Floats:
    """Return the rotation vector of a (3, 3) rotation, rad.

    Below half a turn from the matrix itself, which costs a tenth of what SciPy's checks do.
    """
    axis = 0.5 * np.array(
        [
            rotation[2, 1] - rotation[1, 2],
            rotation[0, 2] - rotation[2, 0],
            rotation[1, 0] - rotation[0, 1],
        ]
    )
    sine = float(np.sqrt(axis @ axis))
    cosine = 0.5 * (float(np.trace(rotation)) - 1.0)
    if sine < 1e-6 and cosine < 0.0:  # half a turn: its axis is the column of R + 1 that is longest
        from scipy.spatial.transform import Rotation

        return Rotation.from_matrix(rotation).as_rotvec()
    return axis if sine < 1e-9 else axis * (np.arctan2(sine, cosine) / sine)


def _scaled(slope: Floats, length: float) -> Floats:
    return np.concatenate([slope[:3], slope[3:] / length])


def _held(arm: Arm, angles: Floats, pull: Floats) -> Mask:
    """Return which joints stand at a limit and are pulled beyond it, (n,)."""
    return np.asarray(
        ((angles <= arm.lower_rad) & (pull < 0.0)) | ((angles >= arm.upper_rad) & (pull > 0.0))
    )


def _step(
    slope: Floats, error: Floats, damping: float, held: Mask, arm: Arm, angles: Floats
) -> Floats:
    """Return the damped step of the joints that are not held, (n,), rad."""
    held = held.copy()
    while True:
        free = np.where(held, 0.0, slope)
        step = free.T @ np.linalg.solve(free @ free.T + damping * np.eye(6), error)
        beyond = ((angles <= arm.lower_rad) & (step < 0.0)) | (
            (angles >= arm.upper_rad) & (step > 0.0)
        )
        if not (beyond & ~held).any():
            return np.asarray(step)
        held |= beyond
