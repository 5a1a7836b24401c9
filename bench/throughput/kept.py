"""Rates of a release, in yardsticks, kept beside the code: ``kept.json``."""

from __future__ import annotations

import json
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from bench.throughput.rate import Rate
from models.errors import RvbenchError

KEPT = Path(__file__).with_name("kept.json")


def rates_before(size: float, path: Path = KEPT) -> dict[str, float]:
    """Return each row's ``a_yardstick`` as it was kept, by the row's name.

    Parameters
    ----------
    size : float
        Of the commands: start-up is counted, so that another size has another rate.
    path : Path

    Returns
    -------
    dict of str to float
        Empty where none was kept, or of another size.

    Raises
    ------
    RvbenchError
        If the file is not one of rates.
    """
    if not path.exists():
        return {}
    try:
        told = json.loads(path.read_text())
        rates = {str(name): float(rate) for name, rate in told["things_a_yardstick"].items()}
        return rates if float(told["size"]) == size else {}
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise RvbenchError(
            f"{path}: expected rates as --keep writes them, got something else ({error}); "
            "take the file away"
        ) from error


def keep(rows: Sequence[Rate], size: float, path: Path = KEPT) -> None:
    """Write the rows' rates as those to be held against.

    Parameters
    ----------
    rows : sequence of Rate
    size : float
    path : Path
    """
    rates = {row.name: float(f"{row.a_yardstick:.4g}") for row in rows}
    table = {"version": version("rvbench"), "size": size, "things_a_yardstick": rates}
    path.write_text(json.dumps(table, indent=1) + "\n")
