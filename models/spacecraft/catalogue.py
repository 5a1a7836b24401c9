"""The spacecraft there are, by name."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from models.errors import ScenarioError
from models.spacecraft.chaser import chaser
from models.spacecraft.hispasat import hispasat
from models.spacecraft.maxar1300 import maxar1300
from models.spacecraft.part import Spacecraft
from models.spacecraft.xmm import xmm

SPACECRAFT: dict[str, Callable[[], Spacecraft]] = {
    "maxar1300": maxar1300,
    "xmm": xmm,
    "hispasat": hispasat,
    "chaser": chaser,
}


def spacecraft_by_name(name: str) -> Spacecraft:
    """Return a spacecraft by name, built once a process: it is frozen, and takes two seconds.

    Raises
    ------
    ScenarioError
        If none has that name; the message lists those there are.
    """
    if name not in SPACECRAFT:
        raise ScenarioError(
            f"expected a spacecraft among {', '.join(sorted(SPACECRAFT))}, got {name!r}"
        )
    return _built(name)


@cache
def _built(name: str) -> Spacecraft:
    return SPACECRAFT[name]()
