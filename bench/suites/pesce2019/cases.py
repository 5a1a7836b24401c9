"""The cases of Pesce et al. 2019 and the numbers of its tables, as ``reference/pesce2019.toml``."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from bench.report.pairs.published import REFERENCE
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.tumble import Tumble

Row3 = tuple[float, float, float]


@dataclass(frozen=True)
class Orbit:
    """Elements as the tables print them.

    Attributes
    ----------
    a_km, e : float
    i_deg, raan_deg, argument_of_perigee_deg : float, deg
    true_anomaly_deg : float, deg
        At time zero; the paper leaves it open.
    """

    a_km: float
    e: float
    i_deg: float
    raan_deg: float
    argument_of_perigee_deg: float
    true_anomaly_deg: float


@dataclass(frozen=True)
class Case:
    """One column of Table 4, or VINAG's relative case; plain numbers only.

    Attributes
    ----------
    key, name : str
    target : str
        Of ``models.spacecraft.wireframes``.
    orbit : Orbit
        The chaser's.
    rho0_m, rho_dot0_m_s : tuple of 3 floats, m and m/s
        In the chaser's local frame.
    omega_t0_deg_s : tuple of 3 floats, deg/s
        In the target frame.
    inertia_kg_m2 : tuple of 3 tuples of 3 floats, kg m2
    """

    key: str
    name: str
    target: str
    orbit: Orbit
    rho0_m: Row3
    rho_dot0_m_s: Row3
    omega_t0_deg_s: Row3
    inertia_kg_m2: tuple[Row3, Row3, Row3]


@cache
def published() -> dict[str, Any]:
    """Return the reference file's tables."""
    return tomllib.loads((REFERENCE / "pesce2019.toml").read_text())


@cache
def case(key: str) -> Case:
    """Return a case by its key: ``1`` to ``5``, or ``vinag``.

    Raises
    ------
    KeyError
        If the reference file has none of that key.
    """
    reference = published()
    row = reference["cases"][key]
    anomalies = reference["settled"]["true_anomaly_deg"]
    if "orbit" in row:
        elements = {**reference["orbits"][row["orbit"]]}
        elements["true_anomaly_deg"] = anomalies[row["orbit"]]
    else:  # VINAG's circle: the node and the place on it are as good as any other
        elements = {
            "a_km": row["orbit_a_km"],
            "e": row["orbit_e"],
            "i_deg": row["orbit_i_deg"],
            "raan_deg": 0.0,
            "argument_of_perigee_deg": 0.0,
            "true_anomaly_deg": anomalies["LEO"],
        }
    inertia = [tuple(map(float, line)) for line in reference["inertia_kg_m2"][row["target"]]]
    return Case(
        key=key,
        name=row["name"],
        target=row["target"].lower(),
        orbit=Orbit(**{name: float(value) for name, value in elements.items()}),
        rho0_m=_row(row["rho0_m"]),
        rho_dot0_m_s=_row(row["rho_dot0_m_s"]),
        omega_t0_deg_s=_row(row["omega_t0_deg_s"]),
        inertia_kg_m2=(_row(inertia[0]), _row(inertia[1]), _row(inertia[2])),
    )


@cache
def tumble_of(case: Case, duration_s: float) -> Tumble:
    """Return the true motion of a case; one is made per process and duration."""
    orbit = case.orbit
    return Tumble.from_case(
        KeplerOrbit.from_elements_deg(
            a_km=orbit.a_km,
            e=orbit.e,
            i_deg=orbit.i_deg,
            raan_deg=orbit.raan_deg,
            argument_of_perigee_deg=orbit.argument_of_perigee_deg,
            true_anomaly_deg=orbit.true_anomaly_deg,
        ),
        rho0_m=case.rho0_m,
        rho_dot0_m_s=case.rho_dot0_m_s,
        omega_t0_deg_s=case.omega_t0_deg_s,
        inertia_kg_m2=case.inertia_kg_m2,
        duration_s=duration_s,
    )


def _row(values: Any) -> Row3:
    x, y, z = np.asarray(values, dtype=np.float64).tolist()
    return x, y, z
