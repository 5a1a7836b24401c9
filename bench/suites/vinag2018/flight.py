"""A flight as it really is: orbit, attitude, and the satellites that are received."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bench.suites.vinag2018.cases import Case
from models.arrays import Floats
from models.gnss.constellation import Constellation, gps_and_galileo
from models.gnss.link_budget import LinkBudget, ReceiveAntenna
from models.gnss.reception import Receiver, Reception, reception
from models.motion.gravity_gradient import GravityGradientAttitude
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.perturbed_orbit import Ball, Manoeuvre, PerturbedOrbit
from models.quaternions import rotated
from models.sky.moon_ephemeris import moon_position_in_inertial
from models.sky.sun_ephemeris import epoch_of, sun_position_in_inertial

EPOCH = "2026-03-20T12:00:00Z"
KNOT_S = 600.0  # between places of Sun and Moon; in between they move on straight lines, to 30 km
SETTLE_S = 120.0  # by which the truth outlasts a flight


@dataclass(frozen=True, eq=False)
class Flight:
    """One flight.

    Attributes
    ----------
    case : Case
    duration_s : float, s
    manoeuvres : tuple of Manoeuvre
    """

    case: Case
    duration_s: float
    manoeuvres: tuple[Manoeuvre, ...] = ()

    @cached_property
    def orbit(self) -> PerturbedOrbit:
        """The orbit."""
        own = self.case
        start = KeplerOrbit.from_elements_deg(
            a_km=own.axis_km,
            e=0.0,
            i_deg=own.inclination_deg,
            raan_deg=0.0,
            argument_of_perigee_deg=0.0,
            true_anomaly_deg=0.0,
        ).state(0.0)
        return PerturbedOrbit(
            epoch_of(EPOCH),
            start.position_in_inertial,
            start.velocity_in_inertial,
            self.duration_s + SETTLE_S,
            Ball(own.mass_kg, own.area_m2),
            own.degree,
            self.manoeuvres,
        )

    @cached_property
    def attitude(self) -> GravityGradientAttitude:
        """How the body turns."""
        return GravityGradientAttitude(self.orbit, self.case.moments_kg_m2, self.case.off_deg)

    @property
    def constellation(self) -> Constellation:
        """The satellites."""
        return gps_and_galileo(self.case.galileo_spares)

    def bodies(self, time_s: float) -> tuple[Floats, Floats]:
        """Return where Sun and Moon are, (3,) each, m, inertial."""
        knots, sun, moon = self._ephemeris
        place = min(int(time_s / KNOT_S), len(knots) - 2)
        part = (time_s - knots[place]) / KNOT_S
        return (
            sun[place] + part * (sun[place + 1] - sun[place]),
            moon[place] + part * (moon[place + 1] - moon[place]),
        )

    def reception(self, times_s: Floats) -> Reception:
        """Return which satellites are tracked at times (m,) in s, and how well."""
        own = self.case
        receiver = Receiver(
            ReceiveAntenna(own.gain_dbi, own.edge_deg, boresight_in_body=own.boresight_in_body),
            own.sensitivity_dbhz,
            link=LinkBudget(losses_db=own.losses_db, azimuth_averaged=own.azimuth_averaged),
        )
        turns = self.attitude.quaternions(times_s)
        boresights = rotated(turns, np.broadcast_to(own.boresight_in_body, (len(times_s), 3)))
        positions = self.orbit.states(times_s)[:, :3]
        knots, sun, _ = self._ephemeris
        towards = np.stack([np.interp(times_s, knots, sun[:, k]) for k in range(3)], axis=1)
        towards /= np.linalg.norm(towards, axis=1, keepdims=True)
        return reception(receiver, self.constellation, times_s, positions, boresights, towards)

    @cached_property
    def _ephemeris(self) -> tuple[Floats, Floats, Floats]:
        knots = np.arange(0.0, self.duration_s + SETTLE_S + 2.0 * KNOT_S, KNOT_S)
        epoch = epoch_of(EPOCH)
        sun = np.array([sun_position_in_inertial(epoch, t) for t in knots.tolist()])
        moon = np.array([moon_position_in_inertial(epoch, t) for t in knots.tolist()])
        return knots, sun, moon
