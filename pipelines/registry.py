"""Every pipeline there is: ours, and those that other packages bring.

A package brings one by an entry point of the group ``rvbench.pipelines`` that names a
``RegisteredPipeline``.
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
    "uncooperative": "pipelines.uncooperative.registered",
}
"""The module of each of ours; loaded when it is asked for."""

NAME = re.compile(r"[a-z][a-z0-9_-]{0,63}")


def pipeline_names() -> list[str]:
    """Return the names of all pipelines, ours first; nothing is loaded."""
    return [*OURS, *sorted(_foreign())]


def is_ours(name: str) -> bool:
    """Tell whether a pipeline is of the house."""
    return name in OURS


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
    point = _foreign().get(name)
    if point is None:
        near = difflib.get_close_matches(name, pipeline_names(), n=1)
        hint = f"; perhaps you meant {near[0]}" if near else ""
        raise ScenarioError(
            f"expected a pipeline among {', '.join(pipeline_names())}, got {name!r}{hint}"
        )
    try:
        loaded = point.load()
    except Exception as error:  # anybody's code, which may fail in any way
        raise ScenarioError(
            f"pipeline {name} ({point.value}): expected it to be loaded, "
            f"got {type(error).__name__}: {error}; mend or uninstall its package"
        ) from error
    if not isinstance(loaded, RegisteredPipeline) or loaded.name != name:
        raise ScenarioError(
            f"pipeline {name}: expected {point.value} to be a RegisteredPipeline of that name "
            f"(pipelines.pipeline), got {loaded!r:.120}"
        )
    return loaded


def _foreign() -> dict[str, EntryPoint]:
    """Return the entry points of other packages, by name; names of ours and odd ones are left."""
    found = {point.name: point for point in entry_points(group=GROUP)}
    return {name: found[name] for name in found if name not in OURS and NAME.fullmatch(name)}
