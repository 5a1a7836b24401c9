"""An arm from its Denavit-Hartenberg rows, as textbooks and data sheets print them.

A row is ``Rz(theta) Tz(d) Tx(a) Rx(alpha)`` (Denavit and Hartenberg 1955; Siciliano et al. 2009,
equation 2.52), or by Craig's convention ``Rx(alpha) Tx(a) Rz(theta) Tz(d)`` with the alpha and the
a of the link before (Craig 2005, equation 3.6): the same letters, another arm.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from models.arm.arm import Joint
from models.pose import RigidTransform


@dataclass(frozen=True)
class Row:
    """One joint.

    Attributes
    ----------
    name : str
    a_m, d_m : float, m
        Along x, and along z.
    alpha_deg : float, deg
        About x.
    theta_deg : float, deg
        About z, where the joint reads zero.
    lower_deg, upper_deg : float, deg
        Where the joint stops, by what it reads.
    """

    name: str
    a_m: float
    alpha_deg: float
    d_m: float
    theta_deg: float
    lower_deg: float
    upper_deg: float


def joints_of(rows: Sequence[Row], craig: bool = False) -> tuple[tuple[Joint, ...], RigidTransform]:
    """Return the joints of an arm, and its last frame in its last link.

    Parameters
    ----------
    rows : sequence of Row
        From the base outwards.
    craig : bool
        Whether a row is Craig's.

    Returns
    -------
    joints : tuple of Joint
    last_from_flange : RigidTransform
        What the last row has beyond its joint.
    """
    joints = []
    before = RigidTransform.identity()
    for row in rows:
        across = turned("x", row.alpha_deg, (row.a_m, 0.0, 0.0))
        along = RigidTransform(np.eye(3), np.array([0.0, 0.0, row.d_m]))
        zero = turned("z", row.theta_deg)
        stands = before @ across @ zero if craig else before @ zero
        limits = np.deg2rad([row.lower_deg, row.upper_deg]).tolist()
        joints.append(Joint(row.name, stands, *limits))
        before = along if craig else along @ across
    return tuple(joints), before


def turned(
    axis: str, angle_deg: float, shift_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> RigidTransform:
    """Return a turn about x, y or z, standing at a place.

    Parameters
    ----------
    axis : str
    angle_deg : float, deg
    shift_m : (3,) tuple, m
    """
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_euler(axis, angle_deg, degrees=True).as_matrix()
    return RigidTransform(turn, np.array(shift_m))
