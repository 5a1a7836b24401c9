"""The relative state of a target seen from a chaser: where it is, how it moves, how it turns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.errors import DatasetError
from models.estimate import Estimate, NamedState
from models.frame import TableReading
from models.pose import RigidTransform

CHASER_ORBIT_COLUMNS = ("x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s")
TRANSLATION, ROTATION = "relative_translation", "relative_rotation"
"""The two states of a target's relative motion in an ``Estimate``.

Their covariances are of (rho, rho_dot) in the local frame, m and m/s (for an H-infinity filter a
bound, not a covariance), and of (small turn, omega) in the target frame, rad and rad/s:
``R_true = R exp([turn]x)``.
"""
STATE_SIZE = 6
SHAPES: dict[str, dict[str, tuple[int, ...]]] = {
    TRANSLATION: {"rho_in_lvlh_m": (3,), "rho_dot_in_lvlh_m_s": (3,)},
    ROTATION: {
        "R_lvlh_from_target": (3, 3),
        "omega_target_wrt_lvlh_in_target_rad_s": (3,),
    },
}

STATE_SHAPES: dict[str, dict[str, tuple[int, ...]]] = {
    TRANSLATION: {"rho_in_lvlh_m": (3,), "rho_dot_in_lvlh_m_s": (3,)},
    ROTATION: {"R_lvlh_from_target": (3, 3), "omega_target_wrt_lvlh_in_target_rad_s": (3,)},
}
STATE_COVARIANCE_SHAPE = (6, 6)


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

    def named(
        self, translation_covariance: Floats | None, rotation_covariance: Floats | None
    ) -> dict[str, NamedState]:
        """Return the two states of an ``Estimate``.

        Parameters
        ----------
        translation_covariance : (6, 6) array or None, m and m/s
        rotation_covariance : (6, 6) array or None, rad and rad/s
        """
        return {
            TRANSLATION: NamedState(
                {
                    "rho_in_lvlh_m": self.rho_in_lvlh,
                    "rho_dot_in_lvlh_m_s": self.rho_dot_in_lvlh,
                },
                translation_covariance,
            ),
            ROTATION: NamedState(
                {
                    "R_lvlh_from_target": self.R_lvlh_from_target,
                    "omega_target_wrt_lvlh_in_target_rad_s": self.omega_target_wrt_lvlh_in_target,
                },
                rotation_covariance,
            ),
        }


def relative_state(estimate: Estimate) -> RelativeState | None:
    """Return the relative motion that an estimate tells, or None.

    Raises
    ------
    DatasetError
        If it has states of these names that are something else.
    """
    if TRANSLATION not in estimate.states or ROTATION not in estimate.states:
        return None
    found = []
    for name, shapes in SHAPES.items():
        state = estimate.states[name]
        for key, shape in shapes.items():
            value = state.values.get(key)
            if value is None or value.shape != shape:
                came = "none" if value is None else f"one of shape {value.shape}"
                raise _refused(estimate, f"{name}.values.{key} of shape {shape}, got {came}")
            found.append(value)
        if state.covariance is not None and state.covariance.shape != (STATE_SIZE, STATE_SIZE):
            came = f"one of shape {state.covariance.shape}"
            raise _refused(estimate, f"{name}.covariance of shape {(STATE_SIZE,) * 2}, got {came}")
    return RelativeState(estimate.time_s, *found)


def _refused(estimate: Estimate, told: str) -> DatasetError:
    return DatasetError(
        f"frame {estimate.frame}: expected the state {told}; estimate again, or name it otherwise"
    )


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

    def reading(self) -> TableReading:
        """Return it as the one row of a table stream."""
        row = np.concatenate([self.position_in_inertial, self.velocity_in_inertial])
        return TableReading(CHASER_ORBIT_COLUMNS, np.array([self.time_s]), row[None])
