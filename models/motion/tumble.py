"""Two satellites that drift past each other while the target turns freely: the truth of a case.

The chaser keeps its axes along its own local frame and does nothing; neither is perturbed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.integrate import OdeSolution

from models.arrays import Floats
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.relative_motion import integrate
from models.motion.relative_state import ChaserState, RelativeState
from models.motion.rigid_body_rotation import RigidBodyRotation
from models.pose import RigidTransform

# The camera looks along +y of the local frame; image down is nadir. Pesce et al. 2019 leave open
# how it is mounted, and their five targets all lie on +y.
CAM_FROM_LVLH = RigidTransform(
    np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.zeros(3)
)
OVERTIME_S = 1e-6  # rounding of a time that was counted in frames


def within(time_s: float, duration_s: float) -> float:
    """Return a time within a tumble, rounded into it.

    Parameters
    ----------
    time_s, duration_s : float, s

    Raises
    ------
    ValueError
        If it lies outside.
    """
    if not -OVERTIME_S <= time_s <= duration_s + OVERTIME_S:
        raise ValueError(
            f"expected a time between 0 and {duration_s} s, got {time_s}: give the "
            "tumble a longer duration"
        )
    return min(max(float(time_s), 0.0), duration_s)


@dataclass(frozen=True, eq=False)
class Tumble:
    """The true motion of a target about a chaser; every state is a pure function of time.

    Attributes
    ----------
    orbit : KeplerOrbit
        The chaser's.
    rho0_in_lvlh : (3,) array, m
        From the chaser's centre of mass to the target's, at time zero.
    rho_dot0_in_lvlh : (3,) array, m/s
        Its rate in the turning frame.
    omega0_in_target : (3,) array, rad/s
        The target's inertial rate at time zero, in target axes: omega_t0 of Pesce et al. 2019,
        Table 4.
    inertia_kg_m2 : (3, 3) array, kg m2
        The target's, in target axes.
    duration_s : float, s
        States exist from 0 to here.
    R_lvlh_from_target : (3, 3) array
        Attitude at time zero.
    """

    orbit: KeplerOrbit
    rho0_in_lvlh: Floats
    rho_dot0_in_lvlh: Floats
    omega0_in_target: Floats
    inertia_kg_m2: Floats
    duration_s: float
    R_lvlh_from_target: Floats = field(default_factory=lambda: np.eye(3))

    def __post_init__(self) -> None:
        if not 0.0 < self.duration_s < np.inf:
            raise ValueError(f"expected a duration in s above zero, got {self.duration_s}")
        for name in ("rho0_in_lvlh", "rho_dot0_in_lvlh", "omega0_in_target"):
            value = getattr(self, name)
            if value.shape != (3,) or not np.isfinite(value).all():
                raise ValueError(f"expected three finite numbers as {name}, got {value}")
        exact = RigidTransform(self.R_lvlh_from_target, self.rho0_in_lvlh).rotation
        object.__setattr__(self, "R_lvlh_from_target", exact)

    @classmethod
    def from_case(
        cls,
        orbit: KeplerOrbit,
        *,
        rho0_m: Sequence[float],
        rho_dot0_m_s: Sequence[float],
        omega_t0_deg_s: Sequence[float],
        inertia_kg_m2: Sequence[Sequence[float]],
        duration_s: float,
    ) -> Tumble:
        """Read a case as Pesce et al. 2019, Table 4, print it; the target starts along the axes.

        Parameters
        ----------
        orbit : KeplerOrbit
            The chaser's.
        rho0_m : 3 floats, m
            From the chaser's centre of mass to the target's at time zero, in the local frame.
        rho_dot0_m_s : 3 floats, m/s
            Its rate in that turning frame.
        omega_t0_deg_s : 3 floats, deg/s
            The target's inertial rate at time zero, in target axes.
        inertia_kg_m2 : 3 by 3 floats, kg m2
            In target axes.
        duration_s : float, s
        """
        return cls(
            orbit,
            np.array(rho0_m, dtype=np.float64),
            np.array(rho_dot0_m_s, dtype=np.float64),
            np.deg2rad(np.array(omega_t0_deg_s, dtype=np.float64)),
            np.array(inertia_kg_m2, dtype=np.float64),
            duration_s,
        )

    def state(self, time_s: float) -> RelativeState:
        """Return the true relative state.

        Raises
        ------
        ValueError
            If the time is before the start or after ``duration_s``.
        """
        time_s = self._within(time_s)
        moving = self._translation(time_s)
        inertial_from_target = self._rotation.inertial_from_body(time_s)
        attitude = self.orbit.inertial_from_lvlh(time_s).T @ inertial_from_target
        spin_of_lvlh = np.array([0.0, 0.0, self.orbit.anomaly_rate(time_s)])
        return RelativeState(
            time_s,
            moving[:3],
            moving[3:],
            attitude,
            self._rotation.omega_at(time_s) - attitude.T @ spin_of_lvlh,
        )

    def chaser_state(self, time_s: float) -> ChaserState:
        """Return the chaser's true inertial position and velocity."""
        return self.orbit.state(self._within(time_s))

    def chaser_state_beside(self, time_s: float) -> ChaserState:
        """Return the chaser's state a shutter's time before the start or after the end."""
        return self.orbit.state(time_s)

    def inertial_from_lvlh(self, time_s: float) -> Floats:
        """Return the (3, 3) rotation out of the chaser's local frame."""
        return self.orbit.inertial_from_lvlh(time_s)

    def cam_from_target(
        self, time_s: float, cam_from_lvlh: RigidTransform = CAM_FROM_LVLH
    ) -> RigidTransform:
        """Return the true pose that the camera sees."""
        return self.state(time_s).cam_from_target(cam_from_lvlh)

    def _within(self, time_s: float) -> float:
        return within(time_s, self.duration_s)

    @cached_property
    def _translation(self) -> OdeSolution:
        start = np.concatenate([self.rho0_in_lvlh, self.rho_dot0_in_lvlh])
        return integrate(self.orbit, start, (0.0, self.duration_s))

    @cached_property
    def _rotation(self) -> RigidBodyRotation:
        return RigidBodyRotation(
            self.inertia_kg_m2,
            self.omega0_in_target,
            self.orbit.inertial_from_lvlh(0.0) @ self.R_lvlh_from_target,
            self.duration_s,
        )
