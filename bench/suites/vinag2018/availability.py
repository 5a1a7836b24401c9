"""How many satellites there are: Figures 9 and 10, and what the receive antenna's gain decides."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from bench.suites.units import Outcome
from bench.suites.vinag2018.cases import Case
from bench.suites.vinag2018.flight import flight_of
from models.gnss.signal_path import OPAQUE_HEIGHT_M, lowest_height_m

STEP_S = 60.0
STATES = 4  # place and clock: as many satellites give them at once


@dataclass(frozen=True)
class AvailabilityTask:
    """A case with its antenna.

    Attributes
    ----------
    case : Case
    mask_height_m : float, m
        Below which the filter takes no signal.
    duration_s : float, s
    tables : str
        Hash of the patterns.
    """

    case: Case
    mask_height_m: float
    duration_s: float
    tables: str


def availability(task: AvailabilityTask) -> Outcome:
    """Count satellites once a minute.

    Returns
    -------
    Outcome
        ``time_s``; ``visible``, in sight of the antenna's place; ``tracked``, above the receiver's
        sensitivity; ``used``, above the mask too, (n,) each. Seconds of one core.
    """
    began = time.process_time()
    flight = flight_of(task.case, task.duration_s)
    times_s = np.arange(STEP_S, task.duration_s + 0.5, STEP_S)
    received = flight.reception(times_s)
    places = flight.orbit.states(times_s)[:, None, :3]
    heights = lowest_height_m(places, flight.constellation.states(times_s)[..., :3])
    used = received.tracked & (received.lowest_height_m > task.mask_height_m)
    values = {
        "time_s": times_s,
        "visible": (heights > OPAQUE_HEIGHT_M).sum(axis=1),
        "tracked": received.tracked.sum(axis=1),
        "used": used.sum(axis=1),
    }
    return Outcome(values, np.array([time.process_time() - began]))
