"""Files of scenarios, and the cases that ship with the bench; none is read as a scenario here."""

from __future__ import annotations

import difflib
from pathlib import Path

from models.errors import ScenarioError
from models.reading.bounds import MOST_NAME
from models.reading.regular_file import MEGABYTE
from models.reading.shown import shown
from models.reading.toml_file import read_toml

MOST_SCENARIO_BYTES = 32 * MEGABYTE  # a table of poses among it
CASES = Path(__file__).resolve().parents[2] / "bench" / "cases"


def case_names() -> list[str]:
    """Return the names of the cases that ship with the bench."""
    return sorted(path.stem for path in CASES.glob("*.toml"))


def case_path(case: str) -> Path:
    """Return the file of a case, by name or path.

    Raises
    ------
    ScenarioError
        If there is none; the message lists the cases and suggests the nearest.
    """
    path = CASES / f"{case}.toml"
    if path.is_file() and "/" not in case:
        return path
    if case.endswith(".toml"):
        if Path(case).is_file():
            return Path(case)
        raise ScenarioError(f"expected a scenario file at {case}, found none")
    near = difflib.get_close_matches(case[:MOST_NAME], case_names(), n=1)
    hint = f"; perhaps you meant {near[0]}" if near else ""
    raise ScenarioError(
        f"expected a case among {', '.join(case_names())}, or a path to a .toml file, "
        f"got {shown(case)}{hint}"
    )


def case_description(name: str) -> str:
    """Return what the case of a name is of, in its file's own words, on one line."""
    table = read_toml(CASES / f"{name}.toml", MOST_SCENARIO_BYTES)
    return " ".join(table.get("description", "").split())
