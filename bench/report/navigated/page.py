"""The target's page, and what the chaser knows of itself."""

from __future__ import annotations

from dataclasses import replace

from bench.report.flights.page import HONEST, axes_table, axis_plots
from bench.report.numbers import NONE, count, number
from bench.report.parts import ReportInput, ReportParts, Section, TitledTable
from bench.report.table import Table, title_of
from bench.report.tumble.page import report as tumble_report


def report(given: ReportInput) -> ReportParts:
    """Return the page's parts."""
    own = tumble_report(given)
    section = Section(
        "What the chaser knows of itself",
        text=(
            "GNSS, gyroscopes and stars, up to each image; the relative filters take this state "
            "as their chaser."
        ),
        tables=(
            TitledTable("Errors by axis", axes_table(given.score), wide=True),
            TitledTable("Protection levels of the relative position", _relative(given), wide=True),
        ),
        note=HONEST,
    )
    return replace(own, after=[*own.after, section], plots=[*own.plots, *axis_plots(given.score)])


def _relative(given: ReportInput) -> Table:
    rows = []
    for label, own in given.score["pipelines"].items():
        held = own["parts"].get("relative_integrity")
        if held is None or not held["told"]:
            continue
        rows.append(
            [
                title_of(label),
                *(f"{number(each)} m" for each in held["mean_m"] or [None] * 3),
                f"{count(held['missed'])} of {count(held['told'])}" if held["told"] else NONE,
            ]
        )
    return Table(["", "radial", "along", "normal", "beyond"], rows, {}, {})
