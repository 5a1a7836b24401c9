"""The spacecraft there are, by name; naming them loads no mesh."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING

from models.errors import ScenarioError
from models.loading import lazily

if TYPE_CHECKING:
    from models.spacecraft.part import Spacecraft

SPACECRAFT: dict[str, Callable[[], Spacecraft]] = {
    "maxar1300": lazily("models.spacecraft.maxar1300:maxar1300"),
    "maxar1300_grasp": lazily("models.spacecraft.grasp_markers:maxar1300_grasp"),
    "maxar1300_unmarked": lazily("models.spacecraft.maxar1300_unmarked:maxar1300_unmarked"),
    "xmm": lazily("models.spacecraft.xmm:xmm"),
    "hispasat": lazily("models.spacecraft.hispasat:hispasat"),
    "chaser": lazily("models.spacecraft.chaser:chaser"),
}
TARGETS = {
    "maxar1300": "10 markers of radius 12.7 mm, 34 named parts",
    "maxar1300_grasp": "3 markers of radius 10.0 mm, 35 named parts",
    "maxar1300_unmarked": "no markers; a wireframe of 26 landmarks, 29 edges, 33 named parts",
    "xmm": "no markers; a wireframe of 30 landmarks, 37 edges, 19 named parts",
    "hispasat": "no markers; a wireframe of 20 landmarks, 24 edges, 20 named parts",
}
"""Those that a case may look at, in words: counting would build them, which takes seconds."""


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
