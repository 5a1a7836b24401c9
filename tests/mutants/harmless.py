"""What may survive: slips that provably change nothing, and numbers that are judgements."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tests.mutants.slips import ONE_PERCENT

LIST = Path(__file__).with_name("harmless.toml")
EQUIVALENT, JUDGEMENT, HOLE = "equivalent", "judgement", "hole"


def read_harmless(path: Path = LIST) -> dict[str, list[dict[str, Any]]]:
    """Return the lists of ``harmless.toml``."""
    return tomllib.loads(path.read_text())


def kind_of(survivor: Mapping[str, Any], harmless: Mapping[str, list[dict[str, Any]]]) -> str:
    """Tell what it means that a mutant survived.

    Returns
    -------
    str
        `EQUIVALENT` if its very change is listed with a reason; `JUDGEMENT` if it changes a number
        by a hundredth on a line that is listed; else `HOLE`.
    """
    change = (survivor["file"], survivor["before"], survivor["after"])
    for each in harmless.get("equivalent", ()):
        if change == (each["file"], each["before"], each["after"]):
            return EQUIVALENT
    if survivor["slip"] == ONE_PERCENT:
        for each in harmless.get("judgement", ()):
            listed = any(line in survivor["before"] for line in each["lines"])
            if each["file"] == survivor["file"] and listed:
                return JUDGEMENT
    return HOLE
