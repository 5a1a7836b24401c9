"""The tables of a tumble, as rows of text made from its ``score.json``."""

from __future__ import annotations

from typing import Any

from bench.report.numbers import NONE, count, number, share
from bench.report.table import (
    CORE_TERMS,
    TIME_TERMS,
    Table,
    Term,
    core_cells,
    headline,
    time_cells,
    title_of,
    with_unit,
)
from bench.scoring.score import shown_labels

Score = dict[str, Any]

TERMS = (
    *CORE_TERMS,
    Term("first state", "The frame of the first state.", "filtered state"),
    Term(
        "lost once acquired",
        "Share of the frames from there on whose image gave no pose that was believed; the filter "
        "goes on.",
    ),
    Term("velocity error, median", "Of the filtered relative velocity, in the local frame."),
    Term("rate error, median", "Of the filtered relative angular rate, in target axes."),
    Term("wrong attitudes", "By kind: the target's symmetry, half a turn, or other."),
    Term(
        "pose alone, position",
        "Median error of the image's own pose, before any filter.",
        "image alone",
    ),
    Term("pose alone, attitude", "The same of its attitude."),
    Term(
        "NEES, translation",
        "Mean of e'P⁻¹e / 6 with the covariance that the filter states: 1 is honest, above is "
        "overconfident. For an H-infinity filter P is a bound, no covariance.",
        "consistency",
    ),
    Term("NEES, rotation", "The same of attitude and rate."),
    Term(
        "visible landmarks",
        "Mean number of the target's landmarks that an image holds unhidden.",
        "image processing",
    ),
    Term("sunlit, of those", "Share that the Sun reaches past the target's own faces."),
    Term("corners found", "Mean number of corners that the image processing gave."),
    Term(
        "repeatability",
        "Share of the visible landmarks that have a corner within 3 px of their true place.",
    ),
    Term("of the sunlit", "The same of the sunlit ones."),
    Term("of those in shadow", "The same of those in the target's own shadow or facing away."),
    Term("corner error", "Root mean square per axis of those corners' distances."),
    Term("corners that are landmarks", "Those corners, over all corners found."),
    *TIME_TERMS,
)


def headline_table(score: Score) -> Table:
    """Compare the pipelines on the same images."""
    columns = {label: _column(score["pipelines"][label]) for label in shown_labels(score)}
    return headline(score, TERMS, columns)


def _column(own: dict[str, Any]) -> list[str]:
    state, corners = own["parts"]["state"], own["parts"]["corners"]
    velocity = state["velocity_m_s"]["median"]
    return [
        *core_cells(own["core"]),
        NONE if state["first_state"] is None else count(state["first_state"]),
        share(state["lost_share"]),
        with_unit(None if velocity is None else 1e3 * velocity, "mm/s"),
        with_unit(state["rate_deg_s"]["median"], "deg/s"),
        _counted(sum(state["confusions"].values()), state["confusions"]),
        with_unit(state["raw_position_m"]["median"], "m"),
        with_unit(state["raw_attitude_deg"]["median"], "deg"),
        number(state["nees"]["translation"]["mean"]),
        number(state["nees"]["rotation"]["mean"]),
        number(corners["visible"]),
        share(corners["lit_share"]),
        number(corners["detected"]),
        share(corners["repeatability"]),
        share(corners["repeatability_lit"]),
        share(corners["repeatability_dark"]),
        with_unit(corners["rms_px"], "px"),
        share(corners["precision"]),
        *time_cells(own["core"]),
    ]


def starts_table(score: Score) -> Table:
    """List what came of the starts."""
    head = [
        "", "starts", "right on the first image", "right within all", "images each may look at",
        "wrong", "no pose", "median, m", "median, deg", "time, median s", "p95 s",
    ]  # fmt: skip
    rows = []
    for variant in shown_labels(score):
        one = score["pipelines"][variant]["parts"]["starts"]
        if one is None:
            continue
        rows.append(
            [
                title_of(variant),
                count(one["starts"]),
                f"{one['first_image']} ({share(one['first_image'] / one['starts'])})",
                f"{one['within']} ({share(one['within'] / one['starts'])})",
                count(one["most_images"]),
                _counted(one["wrong"], one["confusions"]),
                count(one["none"]),
                number(one["position_m"]["median"]),
                number(one["attitude_deg"]["median"]),
                number(one["seconds"]["median"]),
                number(one["seconds"]["p95"]),
            ]
        )
    return Table(head, rows, {}, {})


def limit_table(score: Score, variant: str) -> Table:
    """Show the image's own pose by what may limit it."""
    head = ["", "frames", "with a pose", "position, median m", "attitude, median deg"]
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    last = ""
    for one in score["pipelines"][variant]["parts"]["limits"]:
        if one["of"] != last:
            sections[len(rows)] = last = one["of"]
        low, high = (
            share(edge) if one["of"] != "visible landmarks" else number(edge)
            for edge in one["span"]
        )
        rows.append(
            [
                low if low == high else f"{low} to {high}",
                count(one["frames"]),
                count(one["poses"]),
                number(one["position_m"]),
                number(one["attitude_deg"]),
            ]
        )
    return Table(head, rows, {}, sections)


def _counted(times: int, kinds: dict[str, int]) -> str:
    told = ", ".join(f"{many} {kind}" for kind, many in kinds.items())
    return f"{times} ({told})" if told else count(times)
