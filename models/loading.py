"""Functions that stand in a catalogue, and whose modules load when one is called."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any


def lazily(place: str) -> Callable[..., Any]:
    """Return a function that is imported when it is first called.

    Parameters
    ----------
    place : str
        ``module:function``.
    """

    def call(*arguments: Any, **options: Any) -> Any:
        module, _, name = place.partition(":")
        return getattr(import_module(module), name)(*arguments, **options)

    return call
