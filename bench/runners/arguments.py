"""A verb and its options as what one would type, for another process to parse."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any, get_type_hints

from tyro.conf import Positional


def typed_arguments(name: str, verb: Any, without: Collection[str] = ()) -> list[str]:
    """Return the command line that parses into a verb; paths are made absolute.

    Parameters
    ----------
    name : str
        Of the verb, as typed.
    verb : dataclass
    without : collection of str
        Fields that are left out.
    """
    hints = get_type_hints(type(verb), include_extras=True)
    positional, options = [], []
    for field in fields(verb):
        value = getattr(verb, field.name)
        if field.name in without or (field.default is not MISSING and value == field.default):
            continue
        texts = _texts(value)
        if Positional in getattr(hints[field.name], "__metadata__", ()):
            positional += texts
        else:
            options += [f"--{field.name.replace('_', '-')}", *texts]
    return [name, *positional, *options]


def _texts(value: Any) -> list[str]:
    if value is True:  # a switch
        return []
    if isinstance(value, tuple):
        return [text for each in value for text in _texts(each)]
    return [str(value.absolute()) if isinstance(value, Path) else str(value)]
