"""The wireframes there are, by the name of their spacecraft."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING

from models.errors import ScenarioError
from models.loading import lazily

if TYPE_CHECKING:
    from models.wireframe.wireframe import Wireframe

WIREFRAMES: dict[str, Callable[[], Wireframe]] = {
    "maxar1300_grasp": lazily("models.spacecraft.grasp_markers:grasp_board_outline"),
    "maxar1300_unmarked": lazily("models.spacecraft.maxar1300_wireframe:maxar1300_wireframe"),
    "xmm": lazily("models.spacecraft.xmm_wireframe:xmm_wireframe"),
    "hispasat": lazily("models.spacecraft.hispasat_wireframe:hispasat_wireframe"),
}


def wireframe_by_name(name: str) -> Wireframe:
    """Return a wireframe by its spacecraft's name, built once a process.

    Raises
    ------
    ScenarioError
        If that spacecraft has none; the message lists those that have.
    """
    if name not in WIREFRAMES:
        raise ScenarioError(
            f"expected a spacecraft with a wireframe among {', '.join(sorted(WIREFRAMES))}, "
            f"got {name!r}"
        )
    return _built(name)


@cache
def _built(name: str) -> Wireframe:
    return WIREFRAMES[name]()
