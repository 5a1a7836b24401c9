"""Plots of image pairs against time, to be explored."""

from __future__ import annotations

from typing import Any

from bench.report.time_plot import TimeLine, TimePlot, values_of
from bench.scoring.score import shown_labels

ERRORS = (
    ("position along", "mm", "position_mm", "sigma_position_mm", "bound_position_mm"),
    ("attitude about", "deg", "rotation_vector_deg", "sigma_rotation_deg", "bound_rotation_deg"),
)


def plots(score: dict[str, Any]) -> list[TimePlot]:
    """Return errors by axis with what is stated and what is possible, and numbers of markers."""
    labels = shown_labels(score)
    found = [
        TimePlot(
            f"{what} {'xyz'[axis]}",
            unit,
            tuple(
                line
                for label in labels
                for line in (
                    TimeLine(f"{label}: 3 sigma stated", label, "band",
                             _thrice(values_of(score, label, sigma, axis))),
                    TimeLine(f"{label}: 3 sigma of the bound", label, "bound",
                             _thrice(values_of(score, label, bound, axis))),
                    TimeLine(f"{label}: error", label, "line",
                             values_of(score, label, error, axis)),
                )
            ),
        )
        for what, unit, error, sigma, bound in ERRORS
        for axis in range(3)
    ]  # fmt: skip
    counts = [
        TimeLine("lit and in view", "", "steps", values_of(score, labels[0], "whole")),
        *(
            TimeLine(f"{label}: used", label, "steps", values_of(score, label, "used"))
            for label in labels
        ),
    ]
    return [*found, TimePlot("markers", "", tuple(counts))]


def _thrice(values: list[float | None]) -> list[float | None]:
    return [None if value is None else 3.0 * value for value in values]
