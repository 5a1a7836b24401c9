"""A tumbling target that a chaser circles and looks at: the truth of Volpe et al. 2017.

The target's orbit is circular, the chaser's motion about it linear (Clohessy and Wiltshire), the
target turns under the gravity gradient, and the chaser keeps its camera on the target's centre of
mass (``models.motion.boresight_pointing``).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models.arrays import Floats
from models.motion.boresight_pointing import cam_from_lvlh
from models.motion.clohessy_wiltshire import mean_motion, propagate
from models.motion.gravity_gradient_rotation import GravityGradientRotation
from models.pose import RigidTransform


@dataclass(frozen=True, eq=False)
class WatchedState:
    """Where both are at one time.

    Attributes
    ----------
    time_s : float, s
    rho_in_lvlh, rho_dot_in_lvlh : (3,) array, m and m/s
        From the target's centre of mass to the chaser, in the target's local frame.
    R_lvlh_from_target : (3, 3) array
    omega_in_target : (3,) array, rad/s
        The target's inertial rate, in its own axes.
    R_cam_from_lvlh : (3, 3) array
        The camera's attitude, as the chaser's attitude determination has it.
    """

    time_s: float
    rho_in_lvlh: Floats
    rho_dot_in_lvlh: Floats
    R_lvlh_from_target: Floats
    omega_in_target: Floats
    R_cam_from_lvlh: Floats

    @property
    def cam_from_target(self) -> RigidTransform:
        """The target's pose: its origin is its centre of mass."""
        return RigidTransform(
            self.R_cam_from_lvlh @ self.R_lvlh_from_target,
            -self.R_cam_from_lvlh @ self.rho_in_lvlh,
        )


@dataclass(frozen=True, eq=False)
class WatchedTumble:
    """The motion; every state is a pure function of time.

    Attributes
    ----------
    semi_major_axis_m : float, m
        Of the target's circular orbit.
    start : (6,) array, m and m/s
        The chaser with respect to the target at time zero, local frame.
    omega0_in_target : (3,) array, rad/s
    inertia_kg_m2 : (3, 3) array, kg m2
    duration_s : float, s

    The target's axes are the camera's at time zero (section 3.3 of the paper), so that nobody has
    to be told them.
    """

    semi_major_axis_m: float
    start: Floats
    omega0_in_target: Floats
    inertia_kg_m2: Floats
    duration_s: float

    @property
    def mean_motion_rad_s(self) -> float:
        """Of the target's orbit, rad/s."""
        return mean_motion(self.semi_major_axis_m)

    def state(self, time_s: float) -> WatchedState:
        """Return where both are at a time from zero to the duration."""
        moved = propagate(self.start, self.mean_motion_rad_s, time_s)
        return WatchedState(
            time_s,
            moved[:3],
            moved[3:],
            self._rotation.lvlh_from_body(time_s),
            self._rotation.omega_at(time_s),
            cam_from_lvlh(moved[:3]),
        )

    @cached_property
    def _rotation(self) -> GravityGradientRotation:
        return GravityGradientRotation(
            self.inertia_kg_m2,
            np.asarray(self.omega0_in_target, dtype=np.float64),
            cam_from_lvlh(self.start[:3]).T,
            self.mean_motion_rad_s,
            self.duration_s,
        )
