"""SPEED's score of a pose: relative position error plus attitude error, in rad.

For one image ``e_t = |t - t_true| / |t_true|`` and ``e_q = 2 acos |<q, q_true>|``; the score is the
mean over images of ``e_t + e_q`` (Kisantal et al. 2020, equations 3 to 6). SPEED+ sets a term to
zero where it is below what its testbed can tell, each term for itself (Park et al. 2022; the
published baselines disagree, and this is how the later one, spnv2, computes it).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from models.pose import RigidTransform

FLOOR_POSITION = 2.173e-3  # of the range: calibration of the SPEED+ testbed
FLOOR_ATTITUDE_DEG = 0.169
LOST_POSITION = 1.0  # what an estimate at the camera itself would have
LOST_ATTITUDE_RAD = math.pi  # no turn is larger


@dataclass(frozen=True)
class SpeedError:
    """The two terms of one image.

    Attributes
    ----------
    position : float
        Over the true range.
    attitude_rad : float, rad
    """

    position: float
    attitude_rad: float

    @property
    def score(self) -> float:
        """Their sum, no floor."""
        return self.position + self.attitude_rad

    @property
    def score_floored(self) -> float:
        """Their sum, a term below the testbed's floor being zero."""
        position = self.position if self.position >= FLOOR_POSITION else 0.0
        floor_rad = math.radians(FLOOR_ATTITUDE_DEG)
        return position + (self.attitude_rad if self.attitude_rad >= floor_rad else 0.0)


LOST = SpeedError(LOST_POSITION, LOST_ATTITUDE_RAD)
"""What a lost frame counts as, 1 + pi: SPEED knows no lost frames, and none may be dropped."""


def speed_error(estimate: RigidTransform, truth: RigidTransform) -> SpeedError:
    """Return the two terms of one image.

    The angle is that of the turn from one attitude to the other, which is SPEED's and keeps its
    digits near zero, where an arc cosine has lost them.

    Parameters
    ----------
    estimate, truth : RigidTransform
        ``cam_from_target``.

    Raises
    ------
    ValueError
        If the true range is zero.
    """
    range_m = float(np.linalg.norm(truth.translation))
    if not range_m > 0.0:
        raise ValueError("expected a target away from the camera, got one at range 0")
    turn = Rotation.from_matrix(estimate.rotation @ truth.rotation.T)
    moved_m = float(np.linalg.norm(estimate.translation - truth.translation))
    return SpeedError(moved_m / range_m, float(turn.magnitude()))
