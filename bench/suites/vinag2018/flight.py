"""The paper's flights: a case's orbit in the real field, its attitude, its receiver."""

from __future__ import annotations

from bench.suites.vinag2018.cases import Case
from models.gnss.constellation import gps_and_galileo
from models.gnss.link_budget import LinkBudget, ReceiveAntenna
from models.gnss.reception import Receiver
from models.motion.gravity_gradient import GravityGradientAttitude
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.perturbed_orbit import Ball, Manoeuvre, PerturbedOrbit
from models.sky.sun_ephemeris import epoch_of
from renders.flight.flight import SETTLE_S, Flight

EPOCH = "2026-03-20T12:00:00Z"


def flight_of(case: Case, duration_s: float, manoeuvres: tuple[Manoeuvre, ...] = ()) -> Flight:
    """Return a flight.

    Parameters
    ----------
    case : Case
    duration_s : float, s
    manoeuvres : tuple of Manoeuvre
    """
    orbit = orbit_of(case, duration_s, manoeuvres)
    antenna = ReceiveAntenna(case.gain_dbi, case.edge_deg, boresight_in_body=case.boresight_in_body)
    return Flight(
        orbit.epoch,
        orbit,
        GravityGradientAttitude(orbit, case.moments_kg_m2, case.off_deg),
        duration_s,
        Receiver(
            antenna,
            case.sensitivity_dbhz,
            link=LinkBudget(losses_db=case.losses_db, azimuth_averaged=case.azimuth_averaged),
        ),
        gps_and_galileo(case.galileo_spares),
    )


def orbit_of(
    case: Case, duration_s: float, manoeuvres: tuple[Manoeuvre, ...] = ()
) -> PerturbedOrbit:
    """Return a case's orbit, from its circle's ascending node.

    Parameters
    ----------
    case, duration_s, manoeuvres : as for ``flight_of``
    """
    start = KeplerOrbit.from_elements_deg(
        a_km=case.axis_km,
        e=0.0,
        i_deg=case.inclination_deg,
        raan_deg=0.0,
        argument_of_perigee_deg=0.0,
        true_anomaly_deg=0.0,
    ).state(0.0)
    return PerturbedOrbit(
        epoch_of(EPOCH),
        start.position_in_inertial,
        start.velocity_in_inertial,
        duration_s + SETTLE_S,
        Ball(case.mass_kg, case.area_m2),
        case.degree,
        manoeuvres,
    )
