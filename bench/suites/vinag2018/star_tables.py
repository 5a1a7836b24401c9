"""The tables of the star camera: attitudes without a prior, and what a filter makes of them."""

from __future__ import annotations

from collections.abc import Sequence

from bench.report.numbers import count, number, share
from bench.report.table import Table
from bench.suites.vinag2018.results import Flown
from bench.suites.vinag2018.star_results import Surveyed


def survey_table(surveys: Sequence[Surveyed]) -> Table:
    """List how often attitudes were found without a prior, and how well."""
    rows = [
        [
            f"{own.sky}, {own.attitudes} attitudes",
            share(own.identified),
            count(own.wrong),
            number(own.across_arcsec),
            number(own.across_over_bound),
            number(own.about_arcsec),
            number(own.about_over_bound),
            number(own.nees),
            number(own.stars),
        ]
        for own in surveys
    ]
    head = ["", "identified", "wrong", "across, arcsec", "over bound", "about, arcsec",
            "over bound", "NEES", "stars"]  # fmt: skip
    return Table(head, rows, {}, {})


def star_flight_table(flown: Sequence[Flown]) -> Table:
    """Set the filter on star images beside the filter on the sensor's data sheet."""
    rows = [
        [
            "images" if own.cell.star_pixels else "data sheet, 2.5 and 5 arcsec",
            f"{own.flight.runs} runs of {own.cell.span_s:.0f} s, {own.cell.star_rate_hz} Hz",
            number(own.flight.attitude_deg, 2),
            number(own.flight.attitude_most_deg, 2),
            number(own.flight.attitude.mean),
            number(own.flight.rms_m),
            count(own.flight.unseen),
            count(own.flight.refused),
        ]
        for own in flown
    ]
    head = ["star sensor", "", "attitude, deg", "at most, deg", "NEES", "position, m",
            "frames without attitude", "refused by the filter"]  # fmt: skip
    return Table(head, rows, {}, {})
