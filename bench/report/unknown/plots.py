"""Plots of an unknown target's motion and tracks against time, to be explored."""

from __future__ import annotations

from typing import Any

from bench.report.time_plot import TimeLine, TimePlot, Values, values_of
from bench.scoring.score import shown_labels


def plots(score: dict[str, Any]) -> list[TimePlot]:
    """Return the errors of distance, attitude, rate and spin axis, and the numbers of tracks."""
    labels = shown_labels(score)

    def errors(title: str, unit: str, error: Any, sigma: Any) -> TimePlot:
        lines: list[TimeLine] = []
        for label in labels:
            lines.append(TimeLine(f"{label}: error", label, "line", error(label)))
            if sigma is not None:
                lines.append(TimeLine(f"{label}: 1 sigma stated", label, "level", sigma(label)))
        return TimePlot(title, unit, tuple(lines))

    def motion(name: str) -> Any:
        return lambda label: values_of(score, label, "motion", name)

    def range_m(label: str) -> Values:
        shares = values_of(score, label, "motion", "range_share")
        true_m = values_of(score, label, "range_m")
        return [
            None if share is None or was is None else abs(share * was)
            for share, was in zip(shares, true_m, strict=True)
        ]

    counts = [
        *(
            TimeLine(f"{label}: tracks", "", "steps", values_of(score, label, "tracks"))
            for label in labels
        ),
        *(
            TimeLine(
                f"{label}: points of the shape", label, "steps", values_of(score, label, "used")
            )
            for label in labels
        ),
    ]
    return [
        errors("distance error", "m", range_m, motion("sigma_range_m")),
        errors(
            "attitude error",
            "deg",
            lambda label: values_of(score, label, "attitude_error_deg"),
            motion("sigma_attitude_deg"),
        ),
        errors("rate error", "deg/s", motion("rate_deg_s"), motion("sigma_rate_deg_s")),
        errors("spin axis error", "deg", motion("axis_deg"), None),
        TimePlot("tracks in the image", "", tuple(counts)),
    ]
