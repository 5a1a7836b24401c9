"""Options as they are typed: each with its range or its choices, told before anything is begun."""

from __future__ import annotations

import math
from collections.abc import Collection

from models.errors import ScenarioError
from models.reading.shown import shown


def check_choice(name: str, value: object, choices: Collection[object]) -> None:
    """Refuse what is none of some choices; None was not typed.

    Parameters
    ----------
    name : str
        As it is typed: ``--as``.
    value : object
    choices : collection
        In the order in which they are told.

    Raises
    ------
    ScenarioError
    """
    if value is not None and value not in choices:
        raise ScenarioError(
            f"expected {name} as one of {', '.join(map(str, choices))}, got {shown(value)}"
        )


def check_option(
    name: str, value: float | None, low: float, high: float, *, whole: bool = False, hint: str = ""
) -> None:
    """Refuse a number out of its range; None was not typed.

    Parameters
    ----------
    name : str
        As it is typed: ``--seed``.
    value : float or None
    low, high : float
        Both allowed; ``high`` may be infinite.
    whole : bool
    hint : str
        What else could be done.

    Raises
    ------
    ScenarioError
    """
    if value is None:
        return
    kinds = int if whole else (int, float)
    fits = isinstance(value, kinds) and not isinstance(value, bool) and low <= value <= high
    if not fits:
        kind = "a whole number " if whole and not isinstance(value, int) else ""
        low_text, high_text = (str(x) if whole else f"{x:g}" for x in (low, high))
        span = (
            f"from {low_text} to {high_text}" if math.isfinite(high) else f"of at least {low_text}"
        )
        raise ScenarioError(
            f"expected {name} {kind}{span}, got {shown(value)}" + (f"; {hint}" if hint else "")
        )
