"""What is thought of a target before it was measured, and how well."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from models.arrays import Floats
from models.errors import ScenarioError


@dataclass(frozen=True, eq=False)
class StartGuess:
    """A first guess with its 1 sigma per axis.

    Attributes
    ----------
    rho_in_lvlh, rho_dot_in_lvlh : (3,) array, m and m/s
        From the target to the chaser, in the target's local frame.
    omega_in_target : (3,) array, rad/s
        Inertial rate, in the target axes: those of the first camera.
    sigma_m, sigma_m_s, sigma_rad_s : float
    size_m : float, m
        1 sigma per axis of where points of the target are about its centre of mass.
    inertia_kg_m2 : (3, 3) array, kg m2
        Used by ``paper`` alone: ``best`` takes a ball's, and knows no scale.
    sigma_kg_m2 : float
    """

    rho_in_lvlh: Floats
    sigma_m: float
    rho_dot_in_lvlh: Floats = field(default_factory=lambda: np.zeros(3))
    sigma_m_s: float = 0.05
    omega_in_target: Floats = field(default_factory=lambda: np.zeros(3))
    sigma_rad_s: float = 0.02
    size_m: float = 3.0
    inertia_kg_m2: Floats = field(default_factory=lambda: 800.0 * np.eye(3))
    sigma_kg_m2: float = 100.0

    def __post_init__(self) -> None:
        for name in ("sigma_m", "sigma_m_s", "sigma_rad_s", "size_m", "sigma_kg_m2"):
            if not 0.0 < getattr(self, name) < np.inf:
                raise ScenarioError(
                    f"start of an unknown target: expected {name} above zero, "
                    f"got {getattr(self, name)}"
                )
        if not np.linalg.norm(self.rho_in_lvlh) > 0.0:
            raise ScenarioError("start of an unknown target: expected a chaser away from it")
