"""The relative state of a target seen from a chaser: where it is, how it moves, how it turns."""

from __future__ import annotations

from dataclasses import dataclass

from models.arrays import Floats
from models.pose import RigidTransform


@dataclass(frozen=True, eq=False)
class RelativeState:
    """A target's state in the chaser's local frame (LVLH: x radial, y along track, z normal).

    Attributes
    ----------
    time_s : float, s
    rho_in_lvlh : (3,) array, m
        From the chaser's centre of mass to the target's.
    rho_dot_in_lvlh : (3,) array, m/s
        Its rate, as seen in the turning frame.
    R_lvlh_from_target : (3, 3) array
        Attitude of the target.
    omega_target_wrt_lvlh_in_target : (3,) array, rad/s
        ``d/dt R_lvlh_from_target = R_lvlh_from_target [omega]x``.
    """

    time_s: float
    rho_in_lvlh: Floats
    rho_dot_in_lvlh: Floats
    R_lvlh_from_target: Floats
    omega_target_wrt_lvlh_in_target: Floats

    @property
    def lvlh_from_target(self) -> RigidTransform:
        """The pose in the chaser's local frame; the target frame's origin is its centre of mass."""
        return RigidTransform(self.R_lvlh_from_target, self.rho_in_lvlh)

    def cam_from_target(self, cam_from_lvlh: RigidTransform) -> RigidTransform:
        """Return the pose that a camera mounted at ``cam_from_lvlh`` sees."""
        return cam_from_lvlh @ self.lvlh_from_target


@dataclass(frozen=True, eq=False)
class ChaserState:
    """The chaser's own orbit, true or as its absolute navigation has it.

    Attributes
    ----------
    time_s : float, s
    position_in_inertial : (3,) array, m
    velocity_in_inertial : (3,) array, m/s
    """

    time_s: float
    position_in_inertial: Floats
    velocity_in_inertial: Floats
