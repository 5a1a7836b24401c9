"""The paper's two orbits, with what it leaves to be chosen: attitude, antennas, masses."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

REFERENCE = Path(__file__).parents[2] / "reference" / "vinag2018.toml"
EARTH_RADIUS_KM = 6378.137


@dataclass(frozen=True)
class Case:
    """An orbit, a satellite and its sensors: all that shapes a flight.

    Attributes
    ----------
    key, name : str
    regime : str
        Of the filter's settings.
    axis_km, inclination_deg : float
        Of a circle.
    degree : int
        Of the gravity field.
    mass_kg, area_m2 : float
    moments_kg_m2, off_deg : (float, float, float)
        Principal moments, and how the body stands at the start.
    gain_dbi, edge_deg : float
        Of the receive antenna.
    boresight_in_body : (float, float, float)
    sensitivity_dbhz : float
    losses_db : float
        Of the link: 1 dB of the receiver, and what the transmit panel loses of its directivity.
    azimuth_averaged : bool
        Whether transmitters are taken as round.
    galileo_spares : bool
    ionosphere_m : float
        1 sigma of Table 3.
    record_s : float, s
        Between errors kept.
    """

    key: str
    name: str
    regime: str
    axis_km: float
    inclination_deg: float
    degree: int
    mass_kg: float
    area_m2: float
    moments_kg_m2: tuple[float, float, float]
    off_deg: tuple[float, float, float]
    gain_dbi: float
    edge_deg: float
    boresight_in_body: tuple[float, float, float]
    sensitivity_dbhz: float
    losses_db: float
    azimuth_averaged: bool
    galileo_spares: bool
    ionosphere_m: float
    record_s: float


LEO = Case(
    key="leo",
    name="LEO",
    regime="leo",
    axis_km=7158.0,
    inclination_deg=98.5,
    degree=36,
    mass_kg=100.0,
    area_m2=0.8 * 1.6,
    moments_kg_m2=(26.0, 28.0, 10.7),
    off_deg=(1.0, 0.5, 0.5),
    gain_dbi=3.0,
    edge_deg=90.0,
    boresight_in_body=(0.0, 0.0, -1.0),
    sensitivity_dbhz=35.0,
    losses_db=2.3,
    azimuth_averaged=True,
    galileo_spares=False,
    ionosphere_m=10.0,
    record_s=1.0,
)
GEO = Case(
    key="geo",
    name="GEO",
    regime="geo",
    axis_km=EARTH_RADIUS_KM + 36_000.0,
    inclination_deg=0.0,
    degree=8,
    mass_kg=1000.0,
    area_m2=15.0,
    moments_kg_m2=(900.0, 1000.0, 400.0),
    off_deg=(0.2, 0.1, 0.1),
    gain_dbi=6.0,
    edge_deg=60.0,
    boresight_in_body=(0.0, 0.0, 1.0),
    sensitivity_dbhz=28.0,
    losses_db=2.3,
    azimuth_averaged=True,
    galileo_spares=False,
    ionosphere_m=0.0,
    record_s=10.0,
)
CASES = {case.key: case for case in (LEO, GEO)}
GAINS_DBI = (0.0, 3.0, 6.0, 9.0)


@cache
def published() -> dict[str, Any]:
    """Return the paper's figures, from ``bench/reference``."""
    return tomllib.loads(REFERENCE.read_text())
