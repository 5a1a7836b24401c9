"""The page of a run on white dots: that of all markers, and which second poses there were."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from bench.report.numbers import NONE, number
from bench.report.pairs.page import marker_report
from bench.report.parts import ReportInput, ReportParts, Section, TitledTable
from bench.report.table import Table
from bench.scoring.score import shown_labels
from models.dataset.detector_file import PLAIN
from models.onboard import needed


def report(given: ReportInput) -> ReportParts:
    """Return the page's parts."""
    detector = needed(given.records.onboard.detector, "detector.toml", "the report")
    taken = "in grey, as taken" if detector.mosaic == PLAIN else "in colour, as taken"
    parts = marker_report(given, "colour images", "the grasping point", taken)
    return replace(parts, later=[*parts.later, _rivals(given.score)])


def _rivals(score: dict[str, Any]) -> Section:
    head = [
        "", "poses", "of the outline", "with a rival", "nearest rival, deg", "least lead, chi2",
        "rival was right",
    ]  # fmt: skip
    rows = []
    for label in shown_labels(score):
        own = score["pipelines"][label]["parts"]["rivals"]
        lead = own["least_lead"]
        rows.append(
            [
                label,
                str(own["poses"]),
                str(own["from_outline"]),
                str(own["with_rival"]),
                NONE if own["nearest_deg"] is None else number(own["nearest_deg"]),
                NONE if lead is None else number(lead),
                str(own["rival_was_right"]),
            ]
        )
    return Section(
        "Poses that fit as well",
        tables=(TitledTable("Poses that fit as well", Table(head, rows, {}, {})),),
        note=(
            "Three dots fit up to four poses exactly. The prediction, of the prior and of the "
            "poses before, decides; the lead is how much further from it the closest other pose "
            "lies, in sigmas squared. A pose that leads by less than 13.8 is not said."
        ),
    )
