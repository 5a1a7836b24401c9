"""Rerun's SDK, an extra, ``rvbench[rerun]``: what we take of it, or what to install."""

from __future__ import annotations

import importlib
import re
from typing import Any

from models.errors import ScenarioError

OLDEST = (0, 30)


def loaded_rerun() -> tuple[Any, Any]:
    """Return ``rerun`` and ``rerun.blueprint``.

    Raises
    ------
    ScenarioError
        If it is not installed, or is too old.
    """
    try:
        rerun = importlib.import_module("rerun")
        blueprint = importlib.import_module("rerun.blueprint")
    except ImportError as error:
        raise ScenarioError(
            "expected the package rerun-sdk for --rerun, found none; `pip install rerun-sdk`, or "
            "leave the option out: the page opens in the browser"
        ) from error
    version = getattr(rerun, "__version__", "0")
    if tuple(map(int, re.findall(r"\d+", version)[:2])) < OLDEST:
        raise ScenarioError(
            f"expected rerun-sdk {'.'.join(map(str, OLDEST))} or later for --rerun, found "
            f"{version}; `pip install --upgrade rerun-sdk`"
        )
    return rerun, blueprint
