"""How long a pipeline may take for a frame."""

from __future__ import annotations

from math import inf

from models.errors import ScenarioError


def checked_limit(limit_s: float | None) -> float | None:
    """Return a limit, if a frame could keep it.

    Parameters
    ----------
    limit_s : float or None, s

    Raises
    ------
    ScenarioError
        If it is not above zero.
    """
    if limit_s is not None and not 0.0 < limit_s < inf:
        raise ScenarioError(
            f"expected --time-limit-s above zero, got {limit_s:g}; leave it out for no limit of "
            "our own pipelines"
        )
    return limit_s
