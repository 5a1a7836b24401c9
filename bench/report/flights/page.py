"""What the report of an absolute navigation shows: errors by axis over time, honesty."""

from __future__ import annotations

from typing import Any

from bench.pictures.frame_record import FrameRecord
from bench.report.numbers import NONE, count, number
from bench.report.parts import Card, Figure, ReportInput, ReportParts, Section, TitledTable
from bench.report.plot import errors_over_time, svg_address
from bench.report.summary import core_table
from bench.report.table import Table, length, title_of
from bench.report.time_plot import TimeLine, TimePlot, size_plots, values_of
from bench.scoring.flights.judged_instants import ORBIT

HONEST = (
    "NEES over its degrees of freedom: 1 is honest. Beyond: instants at which an error was beyond "
    "its protection level."
)


def report(given: ReportInput) -> ReportParts:
    """Return the page's parts."""
    core, rows = given.headline["core"], given.headline["per_frame"]
    position, attitude = core["position_error_mm"], core["attitude_error_deg"]
    return ReportParts(
        lead=f"{given.info.target}, {len(rows)} instants, GNSS, gyroscopes and stars",
        cards=[
            Card(length(position["median"]), "", "position error, median",
                 f"95 % below {length(position['p95'])}"),
            Card(number(attitude["median"], 2), "deg", "attitude error, median",
                 f"95 % below {number(attitude['p95'], 2)} deg"),
            Card(f"{core['estimated']} of {core['frames']}", "instants", "with a state",
                 f"{core['wrong']['count'] or 'none'} wrong"),
        ],
        hero=rows[len(rows) // 2]["frame"],
        hero_words="in the middle",
        headline=core_table(given.score),
        after=[
            Section(
                "Errors over time",
                figures=(Figure(svg_address(errors_over_time(given.score)), "Errors over time"),),
                tables=(TitledTable("Errors by axis", axes_table(given.score), wide=True),),
                note=HONEST,
            )
        ],
        plots=[*size_plots(given.score), *axis_plots(given.score)],
    )  # fmt: skip


def axis_plots(score: dict[str, Any]) -> list[TimePlot]:
    """Plot the error along each axis with the protection level about it."""
    labels = [label for label, own in score["pipelines"].items() if "navigation" in own["parts"]]
    return [
        TimePlot(
            f"position error, {name}",
            "m",
            tuple(
                line
                for label in labels
                for line in (
                    TimeLine(f"{label}: protection level", label, "band",
                             values_of(score, label, "protection_m", axis)),
                    TimeLine(f"{label}: error", label, "line",
                             values_of(score, label, "along_m", axis)),
                )
            ),
        )
        for axis, name in enumerate(("radial", "along", "normal"))
        if labels
    ]  # fmt: skip


def axes_table(score: dict[str, Any]) -> Table:
    """Return each pipeline's errors of orbit and attitude, and how honest it is."""
    rows = []
    for label, own in score["pipelines"].items():
        parts = own["parts"]
        if "navigation" not in parts or parts["navigation"]["along_rms_m"] is None:
            continue
        found, held = parts["navigation"], parts["integrity"]
        rows.append(
            [
                title_of(label),
                *(f"{number(each)} m" for each in found["along_rms_m"]),
                f"{number(found['speed_rms_m_s'])} m/s",
                f"{number(found['attitude_rms_deg'], 2)} deg",
                number(found["orbit_nees"]),
                number(found["attitude_nees"]),
                f"{count(held['missed'])} of {count(held['told'])}" if held["told"] else NONE,
            ]
        )
    head = ["", "radial", "along", "normal", "velocity", "attitude", "NEES, orbit",
            "NEES, attitude", "beyond"]  # fmt: skip
    return Table(head, rows, {}, {})


def no_picture(record: FrameRecord, width_px: int = 0) -> None:
    """Return nothing: there is no image.

    Parameters
    ----------
    record : FrameRecord
    width_px : int, px
    """
    return


def verdict(record: FrameRecord) -> str:
    """Return one line of what is said of an instant."""
    said = record.estimate
    if said is None or ORBIT not in said.states:
        return "no state" if said is None or said.reason is None else said.reason
    return said.mode
