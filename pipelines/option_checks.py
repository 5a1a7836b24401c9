"""What all settings of pipelines are held to: numbers that are sizes, a variant that there is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any, TypeVar

import numpy as np

from models.errors import ScenarioError

Options = TypeVar("Options")


def check_sizes(options: Any, what: str, signed: tuple[str, ...] = ()) -> None:
    """Refuse settings whose numbers are not finite, or below zero.

    Parameters
    ----------
    options : dataclass
        Its fields that are floats are looked at.
    what : str
        Whose they are, as the message begins.
    signed : tuple of str
        Names of those that may be below zero.

    Raises
    ------
    ScenarioError
    """
    for each in fields(options):
        value = getattr(options, each.name)
        if not isinstance(value, float):
            continue
        if not (np.isfinite(value) and (each.name in signed or value >= 0.0)):
            raise ScenarioError(
                f"{what}: expected {each.name} finite and not below zero, got {value}"
            )


def variant_among(known: Mapping[str, Options], variant: str, what: str = "pipeline") -> Options:
    """Return the settings of a variant.

    Parameters
    ----------
    known : mapping of str to settings
    variant : str
    what : str
        Of what it is a variant.

    Raises
    ------
    ScenarioError
        If no variant has that name; the message lists those there are.
    """
    if variant not in known:
        raise ScenarioError(f"expected a {what} variant among {', '.join(known)}, got {variant!r}")
    return known[variant]
