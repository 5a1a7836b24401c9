"""Every pipeline there is: ours, those that other packages bring, and those named by hand.

A package brings one by an entry point of the group ``rvbench.pipelines`` that names a
``RegisteredPipeline``; a chain of another package, or a notebook, by ``register``. A pipeline that
is not ours is known by its place, ``module:attribute``, until it is asked for: whoever lists
pipelines runs none of its code.
"""

from __future__ import annotations

import difflib
import re
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points

from models.errors import ScenarioError
from pipelines.pipeline import RegisteredPipeline

GROUP = "rvbench.pipelines"
OURS = {
    "chaser_fixed": "pipelines.chaser_fixed.registered",
    "eye_in_hand": "pipelines.eye_in_hand.registered",
    "uncooperative": "pipelines.uncooperative.registered",
    "unknown_target": "pipelines.unknown_target.registered",
    "absolute": "pipelines.absolute.registered",
    "integrated": "pipelines.integrated.registered",
}
"""The module of each of ours; loaded when it is asked for."""

NAME = re.compile(r"[a-z][a-z0-9_-]{0,63}")
PLACE = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_][\w.]*")
_REGISTERED: dict[str, str] = {}


def register(name: str, place: str) -> None:
    """Make a pipeline known in this process by where it stands.

    Parameters
    ----------
    name : str
        Small letters, digits, ``_`` and ``-``.
    place : str
        ``module:attribute`` of a ``RegisteredPipeline``. It runs in a process of its own, which
        imports it from there.

    Raises
    ------
    ScenarioError
        If the name is one of ours or cannot be a name, or the place is none.
    """
    if wrong := _unusable(name):
        raise ScenarioError(f"pipeline {name!r}: {wrong}")
    if not PLACE.fullmatch(place):
        raise ScenarioError(
            f"pipeline {name}: expected its place as module:attribute, got {place!r}"
        )
    _REGISTERED[name] = place


def pipeline_names() -> list[str]:
    """Return the names of all pipelines, ours first; nothing is loaded."""
    return [*OURS, *sorted(foreign_places())]


def is_ours(name: str) -> bool:
    """Tell whether a pipeline is of the house."""
    return name in OURS


def foreign_places() -> dict[str, str]:
    """Return where each pipeline that is not ours stands, by name."""
    found = {
        name: places[0]
        for name, places in _installed().items()
        if not _unusable(name) and len(places) == 1
    }
    return {**found, **_REGISTERED}


def unusable_entry_points() -> list[str]:
    """Say what keeps entry points of other packages from being pipelines."""
    remarks = []
    for name, places in sorted(_installed().items()):
        if wrong := _unusable(name):
            remarks.append(f"entry point {name!r} ({places[0]}): {wrong}")
        elif len(places) > 1 and name not in _REGISTERED:
            remarks.append(
                f"pipeline {name}: expected one package to bring it, got {' and '.join(places)}; "
                "uninstall all but one"
            )
    return remarks


@cache
def registered_pipeline(name: str) -> RegisteredPipeline:
    """Return a pipeline by name.

    Raises
    ------
    ScenarioError
        If there is none, or it cannot be loaded.
    """
    if name in OURS:
        found: RegisteredPipeline = import_module(OURS[name]).PIPELINE
        return found
    place = foreign_places().get(name)
    if place is None:
        near = difflib.get_close_matches(name, pipeline_names(), n=1)
        hint = f"; perhaps you meant {near[0]}" if near else ""
        raise ScenarioError(
            f"expected a pipeline among {', '.join(pipeline_names())}, got {name!r}{hint}"
        )
    return pipeline_at(name, place)


def pipeline_at(name: str, place: str) -> RegisteredPipeline:
    """Load a pipeline from where it stands; this runs its package's code.

    Parameters
    ----------
    name, place : str
        As ``foreign_places`` has them.

    Raises
    ------
    ScenarioError
        If it cannot be loaded, or is none of that name.
    """
    try:
        loaded = EntryPoint(name, place, GROUP).load()
    except (Exception, SystemExit) as error:  # anybody's code, which may fail in any way
        raise ScenarioError(
            f"pipeline {name} ({place}): expected it to be loaded, "
            f"got {type(error).__name__}: {error}; mend or uninstall its package"
        ) from error
    if not isinstance(loaded, RegisteredPipeline) or loaded.name != name:
        got = loaded.name if isinstance(loaded, RegisteredPipeline) else type(loaded).__name__
        raise ScenarioError(
            f"pipeline {name}: expected {place} to be a RegisteredPipeline of that name "
            f"(pipelines.pipeline), got {got!r}"
        )
    return loaded


def _installed() -> dict[str, list[str]]:
    """Return the places of the entry points of all packages, by name."""
    found: dict[str, list[str]] = {}
    for point in entry_points(group=GROUP):
        places = found.setdefault(point.name, [])
        if point.value not in places:  # one package may be found twice on the path
            places.append(point.value)
    return found


def _unusable(name: str) -> str:
    if name in OURS:
        return "expected a name of its own, got one of ours; rename it"
    if not NAME.fullmatch(name):
        return "expected a name of small letters, digits, _ and -, beginning with a letter"
    return ""
