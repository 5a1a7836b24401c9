"""Plots of a free target's images against time, to be explored."""

from __future__ import annotations

from typing import Any

from bench.report.time_plot import TimeLine, TimePlot, values_of
from bench.scoring.score import shown_labels

ERRORS = (
    ("position error", "m", "position_m", "raw_position_m", "sigma_position_m"),
    ("attitude error", "deg", "attitude_deg", "raw_attitude_deg", "sigma_attitude_deg"),
)
COUNTS = {"visible": "visible landmarks", "lit": "sunlit, of those"}


def plots(score: dict[str, Any], leading: str) -> list[TimePlot]:
    """Return errors of the state and of the image alone, and numbers of landmarks.

    Parameters
    ----------
    score : dict
    leading : str
        The pipeline whose landmarks are counted as seen and lit.
    """
    labels = shown_labels(score)
    found = [
        TimePlot(
            what,
            unit,
            tuple(
                line
                for label in labels
                for line in (
                    TimeLine(f"{label}: pose alone", label, "dots",
                             values_of(score, label, "error", raw)),
                    TimeLine(f"{label}: 1 sigma stated", label, "level",
                             values_of(score, label, "error", sigma)),
                    TimeLine(f"{label}: filtered", label, "line",
                             values_of(score, label, "error", filtered)),
                )
            ),
        )
        for what, unit, filtered, raw, sigma in ERRORS
    ]  # fmt: skip
    counts = [
        *(
            TimeLine(words, "", "steps", values_of(score, leading, "corners", name))
            for name, words in COUNTS.items()
        ),
        *(
            TimeLine(f"{label}: found", label, "steps", values_of(score, label, "corners", "found"))
            for label in labels
        ),
    ]
    return [*found, TimePlot("landmarks", "", tuple(counts))]
