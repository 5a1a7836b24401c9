"""Recall: the share of all frames, lost ones too, whose error is below a threshold."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bench.scoring.metrics.add import USUAL_SHARES
from models.arrays import Floats

CENTIMETRES_AND_DEGREES = ((1.0, 1.0), (2.0, 2.0), (5.0, 5.0), (10.0, 10.0))
"""Of table-top objects: position within so many cm and attitude within so many deg."""

OF_RANGE_AND_DEGREES = ((0.001, 0.1), (0.002, 0.2), (0.005, 0.5), (0.01, 1.0), (0.05, 5.0))
"""For approaches: a hundredth of the range is what rendezvous asks of relative navigation."""

ABSOLUTE_M = (0.01, 0.05, 0.1, 0.5, 1.0)
ATTITUDE_DEG = (0.1, 0.5, 1.0, 5.0, 10.0)
SURFACE_M = (0.05, 0.1, 0.5, 1.0)
"""Of every point of the target (MSSD): what a gripper, or a keep-out zone, cares for."""


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors by frame, (n,) each: infinite where a frame is lost, NaN where nothing is known.

    Attributes
    ----------
    position_m, attitude_deg, range_m : (n,) arrays
    add_m, add_s_m, mssd_m : (n,) arrays, m
    diameter_m : float or None, m
        None where the target's shape is not known.
    """

    position_m: Floats
    attitude_deg: Floats
    range_m: Floats
    add_m: Floats
    add_s_m: Floats
    mssd_m: Floats
    diameter_m: float | None


@dataclass(frozen=True)
class Recall:
    """The share of frames within a threshold.

    Attributes
    ----------
    kind : str
        ``usual`` or ``spacecraft``.
    what : str
    share : float
    """

    kind: str
    what: str
    share: float


def share_below(errors: Floats, threshold: Floats | float) -> float:
    """Return the share of (n,) errors below a threshold, one for all or (n,)."""
    return float(np.mean(errors < threshold)) if len(errors) else 0.0


def recalls(errors: Errors) -> list[Recall]:
    """Return every recall that the errors allow, in the order of the tables above."""
    found: list[Recall] = []

    def tell(kind: str, what: str, passed: Any) -> None:
        found.append(Recall(kind, what, float(np.mean(passed)) if len(passed) else 0.0))

    position, attitude = errors.position_m, errors.attitude_deg
    for cm, deg in CENTIMETRES_AND_DEGREES:
        tell("usual", f"{cm:g} cm and {deg:g} deg", (position < 0.01 * cm) & (attitude < deg))
    if errors.diameter_m is not None:
        for name, own in (("ADD", errors.add_m), ("ADD-S", errors.add_s_m)):
            for share in USUAL_SHARES:
                tell("usual", f"{name} below {share:g} d", own < share * errors.diameter_m)
    over_range = position / errors.range_m
    for share, deg in OF_RANGE_AND_DEGREES:
        what = f"{100.0 * share:g} % of the range and {deg:g} deg"
        tell("spacecraft", what, (over_range < share) & (attitude < deg))
    _each(tell, "position within {:g} m", position, ABSOLUTE_M)
    _each(tell, "attitude within {:g} deg", attitude, ATTITUDE_DEG)
    if errors.diameter_m is not None:
        _each(tell, "every point within {:g} m", errors.mssd_m, SURFACE_M)
    return found


def _each(
    tell: Callable[[str, str, Any], None], what: str, errors: Floats, limits: Sequence[float]
) -> None:
    for limit in limits:
        tell("spacecraft", what.format(limit), errors < limit)
