"""What the score of an absolute navigation adds: errors by axis, honesty, protection."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bench.scoring.flights.judged_instants import JudgedInstant

Judged = Sequence[Sequence[JudgedInstant]]
ORBIT_DOF, ATTITUDE_DOF = 6, 3


@dataclass(frozen=True)
class Navigation:
    """Errors over all runs.

    Attributes
    ----------
    along_rms_m : list of 3 float or None
        Along radial, track and normal.
    speed_rms_m_s, attitude_rms_deg : float or None
    orbit_nees, attitude_nees : float or None
        Mean, over their degrees of freedom: 1 is honest.
    """

    along_rms_m: list[float] | None
    speed_rms_m_s: float | None
    attitude_rms_deg: float | None
    orbit_nees: float | None
    attitude_nees: float | None


@dataclass(frozen=True)
class Protection:
    """How protection levels held.

    Attributes
    ----------
    told : int
        Instants with levels.
    missed : int
        Of those, with an error beyond a level: the user was not warned.
    mean_m : list of 3 float or None
        The levels along radial, track and normal.
    """

    told: int
    missed: int
    mean_m: list[float] | None


def navigation(judged: Judged, truth: Any, label: str) -> Navigation:
    """Summarise the errors of one pipeline.

    Parameters
    ----------
    judged : sequence of sequences of JudgedInstant
    truth, label
        Not needed.
    """
    there = [each for run in judged for each in run if not each.lost]
    if not there:
        return Navigation(None, None, None, None, None)
    along = np.array([each.along_m for each in there])
    return Navigation(
        np.sqrt(np.mean(along**2, axis=0)).tolist(),
        _rms([each.speed_m_s for each in there]),
        _rms([each.attitude_deg for each in there]),
        _mean([each.orbit_nees for each in there], ORBIT_DOF),
        _mean([each.attitude_nees for each in there], ATTITUDE_DOF),
    )


def integrity(judged: Judged, truth: Any, label: str) -> Protection:
    """Count where protection levels held.

    Parameters
    ----------
    judged : sequence of sequences of JudgedInstant
    truth, label
        Not needed.
    """
    pairs = [
        (np.abs(each.along_m or [0.0]), np.array(each.protection_m))
        for run in judged
        for each in run
        if not each.lost and each.protection_m is not None and len(each.protection_m) == 3
    ]
    if not pairs:
        return Protection(0, 0, None)
    missed = sum(bool((error > level).any()) for error, level in pairs)
    return Protection(len(pairs), missed, np.mean([level for _, level in pairs], axis=0).tolist())


def frame_rows(judged: Judged, truth: Any) -> list[dict[str, Any]]:
    """Return what each frame of run 0 adds.

    Parameters
    ----------
    judged : sequence of sequences of JudgedInstant
    truth
        Not needed.
    """
    return [
        {"along_m": each.along_m, "protection_m": each.protection_m, "speed_m_s": each.speed_m_s}
        for each in judged[0]
    ]


def _rms(values: list[float | None]) -> float | None:
    there = [each for each in values if each is not None]
    return float(np.sqrt(np.mean(np.square(there)))) if there else None


def _mean(values: list[float | None], freedom: int) -> float | None:
    there = [each for each in values if each is not None]
    return float(np.mean(there)) / freedom if there else None
