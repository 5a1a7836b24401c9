"""Two satellites on orbits of their own, as a scenario types them, and the sky over one of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from models.arrays import Floats
from models.motion.approach import Approach
from models.motion.clohessy_wiltshire import EARTH_MU_M3_S2
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.perturbed_orbit import Ball, PerturbedOrbit
from models.motion.relative_state import ChaserState
from models.motion.two_orbits import STEADY, Orbit, RealOrbit, TwoOrbits, beside
from models.spacecraft.part import Spacecraft
from renders.scenario.orbit_tables import TWO_BODY, OrbitsTable
from renders.scenario.scenario import Scenario
from renders.scenario.sun_choice import epoch_in

OVERTIME_S = 1.0  # of a shutter that is open after the last frame


def two_orbits(scenario: Scenario, table: OrbitsTable, target: Spacecraft) -> TwoOrbits:
    """Return the motion of two satellites.

    Parameters
    ----------
    scenario : Scenario
    table : OrbitsTable
        Its ``[orbits]``.
    target : Spacecraft
        Whose centre of mass flies on the target's orbit.
    """
    own = KeplerOrbit.from_elements_deg(**table.target.model_dump()).state(0.0)
    flown = [_flown(scenario, table, own, "target")]
    if table.chaser is not None:
        start = KeplerOrbit.from_elements_deg(**table.chaser.model_dump()).state(0.0)
    else:
        place = np.array(table.chaser_from_target_m, dtype=np.float64)
        rate = np.array(table.chaser_from_target_m_s, dtype=np.float64)
        start = beside(own, _acceleration(flown[0], own), place, rate)
    flown.append(_flown(scenario, table, start, "chaser"))
    markers = target.markers
    middle = np.zeros(3) if markers is None else markers.points_in_target.mean(axis=0)
    aim = middle if table.aim_in_target_m is None else np.array(table.aim_in_target_m)
    wobble = Approach().wobble if scenario.motion.target_wobble else STEADY
    return TwoOrbits(
        flown[0], flown[1], target.centre_of_mass, aim, table.chaser_com_to_camera_m, wobble
    )


def _flown(scenario: Scenario, table: OrbitsTable, start: ChaserState, name: str) -> Orbit:
    if table.field == TWO_BODY:
        return KeplerOrbit.from_state(start)
    ball = Ball(getattr(table, f"{name}_mass_kg"), getattr(table, f"{name}_area_m2"))
    return RealOrbit(
        PerturbedOrbit(
            epoch_in(scenario),
            start.position_in_inertial,
            start.velocity_in_inertial,
            scenario.motion.end_s + OVERTIME_S,
            ball,
            table.degree,
        )
    )


def _acceleration(flown: Orbit, state: ChaserState) -> Floats:
    position = state.position_in_inertial
    if isinstance(flown, RealOrbit):
        return flown.orbit.acceleration(0.0, position, state.velocity_in_inertial)
    return np.asarray(-EARTH_MU_M3_S2 * position / np.linalg.norm(position) ** 3)


@dataclass(frozen=True, eq=False)
class OverAnOrbit:
    """The sky over a target on an orbit: a Sun that is typed stands still in target axes.

    Attributes
    ----------
    motion : TwoOrbits
    """

    motion: TwoOrbits
    suns_stand_still: ClassVar[bool] = True

    def sun_in_target(self, direction: tuple[float, float, float], time_s: float) -> list[float]:
        """Return it as typed."""
        return list(direction)

    def earth_at(self, time_s: float) -> tuple[Floats, float]:
        """Return where the Earth lies: (3,) unit vector, target frame; distance, km."""
        position = self.motion.target.state(time_s).position_in_inertial
        distance = float(np.linalg.norm(position))
        down = self.motion.target_from_inertial(time_s) @ (-position / distance)
        return np.asarray(down), 1e-3 * distance

    def target_from_icrs(self, time_s: float) -> Floats:
        """Return the (3, 3) rotation of the target among the stars."""
        return self.motion.target_from_inertial(time_s)
