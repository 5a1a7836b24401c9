"""The tables of the suite's page: rows of text."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from bench.report.numbers import NONE, count, number, share
from bench.report.table import TITLES, Table
from bench.suites.volpe2017.cases import published
from bench.suites.volpe2017.plan import VARIANTS
from bench.suites.volpe2017.results import PaperResults, StepTime, StudiedCase
from bench.suites.volpe2017.summaries import AgainstBound, CaseSummary

SHOWN = tuple(reversed(VARIANTS))  # best first, as on every page
NAMES = {
    "first_from_chaser_m": "first point from the chaser, m",
    "first_from_centre_m": "first point from the centre of mass, m",
    "shape_m": "all points from the centre of mass, rms, m",
    "attitude_deg": "attitude, deg",
    "rate_deg_s": "angular velocity, deg/s",
    "position_m": "relative position, m",
    "velocity_m_s": "relative velocity, m/s",
    "inertia_kg_m2": "inertia, kg m²",
    "inertia_percent": "inertia over its trace, %",
}
TOLD_AS = {
    "position_m": "position", "velocity_m_s": "velocity", "rate_deg_s": "rate",
    "first_from_centre_m": "points", "shape_m": "points", "inertia_kg_m2": "inertia",
}  # fmt: skip
EXACT = 1e-6  # an error at the beginning that is none: the choice of axes made it so
SMALL = 1e-3  # below it numbers are written with their power of ten


def small(value: float | None, digits: int = 3) -> str:
    """Write a number that may be very small.

    Parameters
    ----------
    value : float or None
    digits : int
        Significant ones.
    """
    if value is None or value == 0.0 or abs(value) >= SMALL:
        return number(value, digits)
    return f"{value:.{digits - 1}e}".replace("e-0", "e-").replace("-", "\N{MINUS SIGN}")


def component_table(paper: PaperResults) -> Table:
    """Return Table 1: errors in components at the end of run 0."""
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    for variant in SHOWN:
        sections[len(rows)] = TITLES[variant]
        for name, values in paper.table1[variant].items():
            told = [small(value) for value in values]
            rows.append([NAMES[name], *told, *[""] * (6 - len(told))])
    head = ["", "1 or 11", "2 or 22", "3 or 33", "12", "13", "23"]
    return Table(head, rows, {}, sections)


def improvement_table(paper: PaperResults) -> Table:
    """Return Table 2: norms at the beginning and at the end, and what the paper says of them."""
    orders = published()["orders"]
    head = [
        "", "at the beginning", "at the end", "orders of magnitude", "the paper's",
        "run 0, beginning", "run 0, end",
    ]  # fmt: skip
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    for variant in SHOWN:
        sections[len(rows)] = (
            f"{TITLES[variant]}: {paper.runs[variant]} runs, "
            f"{paper.astray[variant] or 'none'} of which end worse than they began"
        )
        for row in paper.table2[variant]:
            told = TOLD_AS.get(row.quantity)
            rows.append(
                [
                    NAMES[row.quantity],
                    small(row.first),
                    small(row.last),
                    number(row.orders, 2) if row.first > EXACT else NONE,
                    NONE if told is None else count(orders[told]),
                    small(row.first_of_run_0),
                    small(row.last_of_run_0),
                ]
            )
    return Table(head, rows, {}, sections)


def bound_table(ends: Sequence[AgainstBound]) -> Table:
    """Set errors at the end beside the bound, quantity by quantity."""
    rows = [
        [
            NAMES[end.quantity],
            small(end.error),
            small(end.bound),
            NONE if end.error is None else number(end.error / end.bound),
            number(end.limit / end.bound),
            _verdict(end.holds),
        ]
        for end in ends
    ]
    terms = {
        NAMES["shape_m"]: "Root mean square over runs and points of the distance to the true one.",
        NAMES["inertia_percent"]: "Root mean square over the nine entries of the matrix.",
    }
    head = ["", "rms error at the end", "bound", "error / bound", "asked", ""]
    return Table(head, rows, terms, {})


def _verdict(holds: bool | None) -> str:
    return NONE if holds is None else "holds" if holds else "does not hold"


def observability_table(cases: Iterable[StudiedCase]) -> Table:
    """List what each motion makes observable, each beside its bound."""
    head = [
        "", "position, m", "bound", "velocity, m/s", "bound", "rate, deg/s", "bound", "shape, m",
        "bound", "shape but for scale, m", "scale", "bound", "told lost", "inertia, %", "bound",
        "ratios told lost",
    ]  # fmt: skip
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    last = ""
    for own in cases:
        if own.case.name != last:
            sections[len(rows)] = last = own.case.name
        one, ends = own.summary, _by_quantity(own.summary)
        pairs = [
            text
            for name in ("position_m", "velocity_m_s", "rate_deg_s", "shape_m")
            for text in (small(ends[name].error), small(ends[name].bound))
        ]
        inertia = ends["inertia_percent"]
        rows.append(
            [
                "without range" if own.case.range_to == "none" else "with range",
                *pairs,
                small(one.scaled_shape_m),
                share(one.scale_error),
                share(one.scale_bound),
                f"in {share(one.scale_lost)}",
                small(inertia.error),
                small(inertia.bound),
                number(one.lost_ratios, 2) if one.lost_ratios else "none",
            ]
        )
    return Table(head, rows, {}, sections)


def track_table(cases: Iterable[StudiedCase]) -> Table:
    """List what imperfect tracks and ranges cost."""
    head = [
        "", "position, m", "bound", "worst run", "velocity, m/s", "bound", "rate, deg/s", "bound",
        "shape, m", "bound", "points", "NEES, second half", "at the end", "95 % of an honest one",
    ]  # fmt: skip
    rows = []
    for own in cases:
        one, ends = own.summary, _by_quantity(own.summary)
        rows.append(
            [
                own.case.name,
                small(ends["position_m"].error),
                small(ends["position_m"].bound),
                small(one.worst_position_m),
                small(ends["velocity_m_s"].error),
                small(ends["velocity_m_s"].bound),
                small(ends["rate_deg_s"].error),
                small(ends["rate_deg_s"].bound),
                small(ends["shape_m"].error),
                small(ends["shape_m"].bound),
                number(one.points),
                number(one.nees.mean),
                number(one.last_nees),
                f"{number(one.nees.bounds[0])} to {number(one.nees.bounds[1])}",
            ]
        )
    return Table(head, rows, {}, {})


def speed_table(steps: Iterable[StepTime]) -> Table:
    """List how long a frame takes."""
    head = ["points", "frames", "median, ms", "95 % below, ms", "longest, ms", "mean, ms"]
    rows = [
        [
            count(step.points),
            count(step.frames),
            number(step.median_ms),
            number(step.p95_ms),
            number(step.largest_ms),
            number(step.mean_ms),
        ]
        for step in steps
    ]
    return Table(head, rows, {}, {})


def _by_quantity(summary: CaseSummary) -> dict[str, AgainstBound]:
    return {end.quantity: end for end in summary.ends}
