"""How a free target and its chaser move in a scenario, and what tells of the chaser's orbit."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.perturbed_orbit import Ball
from models.motion.perturbed_tumble import PerturbedTumble
from models.motion.tumble import Tumble
from models.sky.earth_pointing import rotation_from_wxyz
from renders.flight.flight import SETTLE_S
from renders.scenario.navigation_tables import SENSORS, NavigationTable
from renders.scenario.scenario import Scenario
from renders.scenario.sun_choice import epoch_in
from renders.scenario.tumble_tables import TumbleTable
from renders.world.own_navigation import SensorsAboard
from renders.world.table_sensors import ChaserNavigation, TableSensor
from renders.world.trajectory import FreeMotion

SHORTEST_S = 1.0  # a motion of one frame lasts, too


def free_motion(scenario: Scenario, table: TumbleTable) -> FreeMotion:
    """Return how both move: about a round Earth, or in the real field if the chaser navigates."""
    orbit = KeplerOrbit.from_elements_deg(**table.orbit.model_dump())
    duration_s = max(scenario.motion.end_s, SHORTEST_S)
    attitude = rotation_from_wxyz(table.q_lvlh_from_target_wxyz)
    if scenario.navigation is not None:
        return FreeMotion(
            _perturbed(scenario, scenario.navigation, table, orbit, duration_s, attitude)
        )
    return FreeMotion(
        Tumble(
            orbit,
            np.array(table.rho0_m),
            np.array(table.rho_dot0_m_s),
            np.deg2rad(table.omega0_deg_s),
            np.array(table.inertia_kg_m2),
            duration_s,
            attitude,
        )
    )


def _perturbed(
    scenario: Scenario,
    navigation: NavigationTable,
    table: TumbleTable,
    orbit: KeplerOrbit,
    duration_s: float,
    attitude: Floats,
) -> PerturbedTumble:
    """Return the same from the same start, with both satellites in the real field."""
    return PerturbedTumble.from_start(
        epoch_in(scenario),
        orbit.state(0.0),
        rho0_m=table.rho0_m,
        rho_dot0_m_s=table.rho_dot0_m_s,
        omega0_rad_s=np.deg2rad(table.omega0_deg_s),
        inertia_kg_m2=np.array(table.inertia_kg_m2),
        R_lvlh_from_target=attitude,
        duration_s=duration_s,
        chaser=Ball(navigation.chaser_mass_kg, navigation.chaser_area_m2),
        target=Ball(navigation.target_mass_kg, navigation.target_area_m2),
        degree=navigation.field_degree,
        overtime_s=SETTLE_S,
    )


def chaser_tables(
    scenario: Scenario, table: TumbleTable, motion: FreeMotion, navigation: SensorsAboard | None
) -> tuple[TableSensor, ...]:
    """Return what tells of the chaser's orbit: its own sensors, or its orbit as stated.

    Parameters
    ----------
    scenario : Scenario
    table : TumbleTable
    motion : FreeMotion
    navigation : SensorsAboard or None
    """
    if navigation is not None:
        return navigation.streams()
    told = table.onboard
    seed = scenario.render.seed
    return (ChaserNavigation(motion, seed, told.chaser_sigma_m, told.chaser_sigma_m_s),)


def own_navigation(scenario: Scenario, motion: FreeMotion) -> SensorsAboard | None:
    """Return the chaser's sensors; None where its orbit is told."""
    table, epoch = scenario.navigation, scenario.motion.epoch_utc
    if table is None or table.by != SENSORS or epoch is None:
        return None
    if not isinstance(motion.tumble, PerturbedTumble):
        raise TypeError(f"expected orbits in the real field, got {type(motion.tumble).__name__}")
    return SensorsAboard(motion.tumble, table, epoch, scenario.render.seed)
