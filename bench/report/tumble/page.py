"""What single images of a free target add to the report."""

from __future__ import annotations

from typing import Any

from bench.pictures.wireframe_overlay import wireframe_of
from bench.report.numbers import number, share
from bench.report.parts import Card, Figure, ReportInput, ReportParts, Section, TitledTable
from bench.report.plot import svg_address
from bench.report.table import length
from bench.report.tumble import figures, tables
from bench.report.tumble.plots import plots
from bench.scoring.score import shown_labels
from models.onboard import needed


def report(given: ReportInput) -> ReportParts:
    """Return the page's parts."""
    score, rows = given.score, given.headline["per_frame"]
    onboard = given.records.onboard
    camera, target = needed(onboard.camera, "camera.toml", "the report"), wireframe_of(onboard)
    judged = sorted(
        (row for row in rows if row["attitude_error_deg"] is not None),
        key=lambda row: row["attitude_error_deg"],
    )
    hero = judged[len(judged) // 2] if judged else rows[0]
    return ReportParts(
        lead=(
            f"{target.name}, {score['frames']} images of {camera.width} × {camera.height}; "
            f"{len(target)} landmarks, no markers, no prior pose"
        ),
        cards=_cards(given.headline),
        hero=hero["frame"],
        hero_words="the frame of median attitude error, with the wireframe at the estimated pose",
        headline=tables.headline_table(score),
        after=[_errors(score), _starts(score)],
        later=[_limits(given)],
        shown=[row["frame"] for row in rows if row["wrong"] or row["reason"]],
        plots=plots(score, given.label),
    )


def _cards(own: dict[str, Any]) -> list[Card]:
    core, parts = own["core"], own["parts"]
    position, attitude, starts = (
        core["position_error_mm"],
        core["attitude_error_deg"],
        parts["starts"],
    )
    cards = [
        Card(length(position["median"]), "", "position error, median",
             f"95 % below {length(position['p95'])}"),
        Card(number(attitude["median"]), "deg", "attitude error, median",
             f"95 % below {number(attitude['p95'])} deg"),
    ]  # fmt: skip
    if starts is not None:
        cards.append(
            Card(f"{starts['within']} of {starts['starts']}", "starts",
                 "acquired rightly without a prior",
                 f"{starts['first_image']} on the first image, {starts['wrong']} wrong")
        )  # fmt: skip
    corners = parts["corners"]
    return [
        *cards,
        Card(share(parts["state"]["lost_share"]), "", "of the images lost once acquired",
             f"longest run of wrong poses: {core['wrong']['longest']} frames"),
        Card(share(corners["repeatability"]), "", "of the visible landmarks found",
             f"within 3 px, rms {number(corners['rms_px'])} px"),
    ]  # fmt: skip


def _errors(score: dict[str, Any]) -> Section:
    return Section(
        "Errors over time",
        figures=(Figure(svg_address(figures.error_figure(score)), "Errors against time"),),
    )


def _starts(score: dict[str, Any]) -> Section:
    return Section(
        "Acquisition without a prior, all over the tumble",
        text=(
            "Each start knows nothing, looks at one image and, where that gives no pose, at those "
            "that follow. Right is within the case's limits of a wrong pose."
        ),
        tables=(TitledTable("Starts", tables.starts_table(score), wide=True),),
        nothing="None was tried.",
    )


def _limits(given: ReportInput) -> Section:
    return Section(
        "What limits it",
        text=(
            "The images sorted into quarters by what they show; errors are of the image's own pose."
        ),
        figures=(
            Figure(
                svg_address(figures.corner_figure(given.score, given.label)),
                f"Landmarks visible, sunlit and found, {given.label}",
            ),
        ),
        tables=tuple(
            TitledTable(label, tables.limit_table(given.score, label), folded=label != given.label)
            for label in shown_labels(given.score)
        ),
    )
