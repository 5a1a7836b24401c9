"""The report of a chain that asks no more of a frame than its pose."""

from __future__ import annotations

from bench.report.numbers import number
from bench.report.parts import Card, Figure, ReportInput, ReportParts, Section
from bench.report.plot import errors_over_time, svg_address
from bench.report.summary import core_table
from bench.report.table import length
from bench.report.time_plot import size_plots
from models.onboard import needed


def report(given: ReportInput) -> ReportParts:
    """Return the page's parts."""
    core, rows = given.headline["core"], given.headline["per_frame"]
    position, attitude = core["position_error_mm"], core["attitude_error_deg"]
    ranges = [row["range_m"] for row in rows]
    with_pose = [row for row in rows if row["position_error_mm"] is not None] or rows
    camera = needed(given.records.onboard.camera, "camera.toml", "the report")
    return ReportParts(
        lead=(
            f"{given.info.target} under Sun {given.info.sun}, {len(rows)} images of "
            f"{camera.width} × {camera.height}, {number(max(ranges))} to {number(min(ranges))} m"
        ),
        cards=[
            Card(length(position["median"]), "", "position error, median",
                 f"95 % below {length(position['p95'])}"),
            Card(number(attitude["median"]), "deg", "attitude error, median",
                 f"95 % below {number(attitude['p95'])} deg"),
            Card(f"{core['estimated']} of {core['frames']}", "frames", "with a pose",
                 f"{core['wrong']['count'] or 'none'} wrong"),
        ],
        hero=with_pose[len(with_pose) // 2]["frame"],
        hero_words="as taken",
        headline=core_table(given.score),
        after=[
            Section(
                "Errors over time",
                figures=(Figure(svg_address(errors_over_time(given.score)), "Errors over time"),),
            )
        ],
        shown=core["lost"]["frames"],
        plots=size_plots(given.score),
    )  # fmt: skip
