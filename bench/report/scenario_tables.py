"""What a dataset was rendered from, as tables for a report."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from models.errors import DatasetError, UnreadableError, cause
from models.reading.toml_file import read_toml
from renders.scenario.case_files import MOST_SCENARIO_BYTES


def scenario_tables(folder: Path) -> dict[str, dict[str, Any]]:
    """Return the scenario's tables; its prose and single keys come first, without a title.

    Empty where there is no truth half.

    Raises
    ------
    DatasetError
        If the file cannot be read.
    """
    path = folder / "truth" / "scenario.toml"
    if not path.is_file():
        return {}
    try:
        table = read_toml(path, MOST_SCENARIO_BYTES)
    except UnreadableError as error:
        raise DatasetError(
            f"{path}: expected a scenario as TOML, got: {cause(error)}; "
            "render again: only what is missing is rendered, and this file is written anew"
        ) from error
    single = {key: value for key, value in table.items() if not isinstance(value, dict)}
    nested = {key: value for key, value in table.items() if isinstance(value, dict)}
    return {"scenario": single, **nested}
