"""Where a suite gets its pipeline from: a module with ``options_for`` and ``Uncooperative``."""

from __future__ import annotations

from importlib import import_module
from typing import Any, Protocol

from models.estimate import Estimate
from models.frame import Frame
from models.motion.relative_state import RelativeState
from pipelines.uncooperative.knowledge import UncooperativeKnowledge

OURS = "pipelines.uncooperative.pipeline"


class Navigator(Protocol):
    """A pipeline that is fed frame after frame."""

    def process(self, frame: Frame) -> Estimate:
        """Take one frame."""


def navigator(
    module: str,
    variant: str,
    knowledge: UncooperativeKnowledge,
    start: RelativeState | None = None,
) -> Navigator:
    """Return a pipeline that has seen no frame yet.

    Parameters
    ----------
    module : str
        Full name of a module like ``pipelines.uncooperative.pipeline``.
    variant : str
        Of its ``options_for``.
    knowledge : UncooperativeKnowledge
    start : RelativeState, optional
        The state to start from; without one it acquires.
    """
    found: Any = import_module(module)
    made: Navigator = found.Uncooperative(knowledge, found.options_for(variant), start)
    return made


def options_text(module: str, variant: str) -> str:
    """Return every setting of a variant as text: part of what shapes a result."""
    return repr(import_module(module).options_for(variant))
