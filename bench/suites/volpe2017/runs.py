"""What each run of a case came to at its end, for the tables of the page to lead to."""

from __future__ import annotations

from bench.report.run_table import RunTable, run_table
from bench.suites.volpe2017.cases import Case
from bench.suites.volpe2017.results import Outcomes
from bench.suites.volpe2017.suite_tables import NAMES
from bench.suites.volpe2017.summaries import QUANTITIES

AT_THE_END = tuple(QUANTITIES)


def runs_of(outcomes: Outcomes, case: Case, variant: str = "best") -> RunTable:
    """Return the errors at the end of each run of a case.

    Parameters
    ----------
    outcomes : Outcomes
    case : Case
    variant : str
    """
    runs = outcomes.runs(case, variant)
    columns = {NAMES[name]: runs.size(name)[:, -1] for name in AT_THE_END}
    columns["points"] = runs.scalar("points")[:, -1]
    return run_table(
        f"{case.name}, {'no range' if case.range_to == 'none' else 'with range'}: {variant}",
        f"Errors at the end; run n draws by (seed {outcomes.plan.sizes.seed}, n)",
        columns,
    )
