"""The sequences: which light, which errors, in which table of the paper."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from typing import Any

from bench.report.pairs.published import REFERENCE
from models.lights.sun import EYE_IN_HAND_SUNS_DEG, SUN_CASES_DEG, sun_direction
from models.lights.sun_grid import NamedSun, azimuth_elevation_deg
from renders.scenario.error_sets import ALONE

CHASER, HAND = "chaser_fixed", "eye_in_hand"
LAMP_SUN = "E-SB"
SUN_MAP = tuple(name for name in EYE_IN_HAND_SUNS_DEG if name != LAMP_SUN)
TOGETHER, FAR_OFF = "realistic", "realistic_prior4"
SENSITIVITY = (*ALONE, TOGETHER, FAR_OFF)


@dataclass(frozen=True)
class Flight:
    """A motion of a camera with all that is rendered in one pass of light.

    Attributes
    ----------
    key : str
    case : str
        Of the bench.
    pipeline : str
    suns : tuple of str
        The papers' names.
    """

    key: str
    case: str
    pipeline: str
    suns: tuple[str, ...]


APPROACH = Flight("approach", "maxar-approach", CHASER, tuple(SUN_CASES_DEG))
GRASP_LAMP = Flight("grasp-lamp", "grasp-approach-lamp", HAND, (LAMP_SUN,))
GRASP_SUN = Flight("grasp-sun", "grasp-approach", HAND, SUN_MAP)
FLIGHTS = (APPROACH, GRASP_LAMP, GRASP_SUN)


@dataclass(frozen=True)
class Sequence:
    """One test case of the paper.

    Attributes
    ----------
    name : str
        The paper's.
    flight : Flight
    sun : str
    errors : str
        Of ``renders.scenario.error_sets``.
    table : int
        Of the paper, where its results stand; 0 for none.
    once : bool
        Whether the paper flies it once, and not a hundred times.
    """

    name: str
    flight: Flight
    sun: str
    errors: str
    table: int
    once: bool = False


SEQUENCES: tuple[Sequence, ...] = (
    *(Sequence(sun, APPROACH, sun, "table5", 12) for sun in SUN_CASES_DEG),
    Sequence("I", APPROACH, "S7", "table8", 14),
    Sequence("C1", APPROACH, "S7", "table9_c1", 15),
    Sequence("C2", APPROACH, "S7", "table9_c2", 15),
    Sequence("M1", APPROACH, "S7", "table10", 16),
    Sequence("E-SB", GRASP_LAMP, LAMP_SUN, "table5", 17),
    Sequence("E-I", GRASP_LAMP, LAMP_SUN, "table8", 18),
    Sequence("E-C1", GRASP_LAMP, LAMP_SUN, "table9_c1", 19),
    Sequence("E-C2", GRASP_LAMP, LAMP_SUN, "table9_c2", 19),
    Sequence("E-M1", GRASP_LAMP, LAMP_SUN, "table10", 20),
    *(Sequence(sun, GRASP_SUN, sun, "table5", 0, once=True) for sun in SUN_MAP),
)
BY_NAME = {own.name: own for own in SEQUENCES}
STUDIED = ("S2", "S7", "E-SB")
"""Sequences that are flown under each error by itself, too."""


def studies(name: str) -> list[Sequence]:
    """Return a sequence under exact knowledge, each error alone, all, and all from a worse start.

    Parameters
    ----------
    name : str
        Of the sequence.
    """
    own = BY_NAME[name]
    return [Sequence(f"{name}/{each}", own.flight, own.sun, each, 0) for each in SENSITIVITY]


def named_sun(name: str) -> NamedSun:
    """Return a Sun of the papers, as a sweep has it."""
    return NamedSun(name, name, *azimuth_elevation_deg(sun_direction(name)))


@cache
def published() -> dict[str, Any]:
    """Return the reference file's tables."""
    return tomllib.loads((REFERENCE / "opromolla2022.toml").read_text())
