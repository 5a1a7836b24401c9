"""What flights came to: errors beside bounds, and whether stated covariances are honest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.suites.consistency import Consistency, consistency
from bench.suites.units import Outcome
from models.arrays import Floats

SETTLED = 0.1  # of a flight is left out: the filter starts a kilometre off
ORBIT_DOF, TURN_DOF, WHOLE_DOF = 8, 6, 17


@dataclass(frozen=True)
class FlightSummary:
    """Errors of some runs after the first tenth.

    Attributes
    ----------
    runs : int
    std_m : list of 3 float
        Standard deviation of the position error on inertial axes, over runs and time.
    rms_along_m : list of 3 float
        Root mean square along radial, track and normal.
    rms_m, rms_m_s : float
        Of the whole position and velocity error.
    attitude_deg, attitude_most_deg : float
        Root mean square and largest of the attitude error, three axes.
    orbit, attitude : Consistency
        NEES of position, velocity and clock, and of attitude and gyro bias, over their numbers.
    whole : Consistency or None
        Of all 17 states, where the truth knows them.
    satellites : float
        Used, in the mean.
    edited : float
        Satellites left out, an epoch.
    refused, doubts : int
        Star frames refused, and times that a filter doubted itself.
    unseen : int
        Star frames in which a camera found no attitude.
    """

    runs: int
    std_m: list[float]
    rms_along_m: list[float]
    rms_m: float
    rms_m_s: float
    attitude_deg: float
    attitude_most_deg: float
    orbit: Consistency
    attitude: Consistency
    whole: Consistency | None
    satellites: float
    edited: float
    refused: int
    doubts: int
    unseen: int = 0


@dataclass(frozen=True)
class BoundSummary:
    """The bound after the first tenth, root mean square over time.

    Attributes
    ----------
    inertial_m, along_m : list of 3 float
    position_m : float
        Of all three axes.
    attitude_deg : float
        Of all three axes.
    """

    inertial_m: list[float]
    along_m: list[float]
    position_m: float
    attitude_deg: float


def stacked(outcomes: Sequence[Outcome], name: str) -> Floats:
    """Return a value of all runs, (n, runs, ...)."""
    return np.concatenate([each.values[name].astype(np.float64) for each in outcomes], axis=1)


def settled(count: int) -> slice:
    """Return which of so many records count."""
    return slice(int(SETTLED * count), None)


def along_axes(outcomes: Sequence[Outcome]) -> Floats:
    """Return position errors along radial, track and normal, (n, runs, 3), m."""
    return np.einsum(
        "nji,nbj->nbi",
        outcomes[0].values["axes"].astype(np.float64),
        stacked(outcomes, "position_m"),
    )


def flight_summary(outcomes: Sequence[Outcome], modelled: bool = False) -> FlightSummary:
    """Summarise some runs.

    Parameters
    ----------
    outcomes : sequence of Outcome
    modelled : bool
        Whether the truth was drawn from the filter's model.
    """
    own = settled(len(outcomes[0].values["time_s"]))
    position, velocity = (stacked(outcomes, name)[own] for name in ("position_m", "velocity_m_s"))
    along, turn = along_axes(outcomes)[own], stacked(outcomes, "attitude_rad")[own]
    turned = np.sum(turn**2, axis=-1)

    def honest(name: str, dof: int) -> Consistency:
        return consistency(stacked(outcomes, name)[own].T, dof)

    return FlightSummary(
        runs=position.shape[1],
        std_m=position.std(axis=(0, 1)).tolist(),
        rms_along_m=np.sqrt(np.mean(along**2, axis=(0, 1))).tolist(),
        rms_m=float(np.sqrt(np.mean(np.sum(position**2, axis=-1)))),
        rms_m_s=float(np.sqrt(np.mean(np.sum(velocity**2, axis=-1)))),
        attitude_deg=float(np.rad2deg(np.sqrt(np.mean(turned)))),
        attitude_most_deg=float(np.rad2deg(np.sqrt(np.max(turned)))),
        orbit=honest("nees_orbit", ORBIT_DOF),
        attitude=honest("nees_attitude", TURN_DOF),
        whole=honest("nees_whole", WHOLE_DOF) if modelled else None,
        satellites=float(outcomes[0].values["used"][own].mean()),
        edited=float(stacked(outcomes, "edited")[own].mean()),
        refused=int(sum(each.values["refused"].sum() for each in outcomes)),
        doubts=int(sum(each.values["doubts"].sum() for each in outcomes)),
        unseen=int(sum(each.values["unseen"].sum() for each in outcomes)),
    )


def bound_summary(outcome: Outcome) -> BoundSummary:
    """Summarise a bound."""
    values = outcome.values
    own = settled(len(values["time_s"]))
    mean = values["position_m2"][own].mean(axis=0)
    turn = np.sum(values["attitude_rad"][own] ** 2, axis=1)
    return BoundSummary(
        inertial_m=np.sqrt(np.diagonal(mean)).tolist(),
        along_m=np.sqrt(np.mean(values["along_m"][own] ** 2, axis=0)).tolist(),
        position_m=float(np.sqrt(np.trace(mean))),
        attitude_deg=float(np.rad2deg(np.sqrt(turn.mean()))),
    )
