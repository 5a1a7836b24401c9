"""The tables of the suite's page: rows of text beside the paper's statements."""

from __future__ import annotations

from collections.abc import Sequence

from bench.report.numbers import NONE, number, share
from bench.report.table import TITLES, Table
from bench.suites.consistency import Consistency
from bench.suites.vinag2018.cases import published
from bench.suites.vinag2018.results import Counted, FaultOutcome, Flown, Sampled

BOUND_TOLERANCE = 1.2  # of the error over its bound
AXES = ("x", "y", "z")
ALONG = ("radial", "along", "normal")


def stated_table(flown: Sequence[Flown]) -> Table:
    """Set standard deviations beside what the paper states, axis by axis."""
    rows = []
    for own in flown:
        stated = published()["stated"][f"{own.cell.case.key}_std_m"]
        for axis, most, std in zip(AXES, stated, own.flight.std_m, strict=True):
            rows.append(
                [
                    f"{own.cell.case.name}, {axis}",
                    TITLES[own.cell.variant],
                    f"below {number(most)} m",
                    f"{number(std)} m",
                    "holds" if std <= most else "does not hold",
                ]
            )
        most_deg = published()["stated"]["attitude_deg"]
        held = own.flight.attitude_most_deg <= most_deg
        rows.append(
            [
                f"{own.cell.case.name}, attitude",
                TITLES[own.cell.variant],
                f"below {number(most_deg)} deg",
                f"{number(own.flight.attitude_deg)} deg rms, at most "
                f"{number(own.flight.attitude_most_deg)} deg",
                "holds" if held else "does not hold",
            ]
        )
    return Table(["", "", "VINAG 2018", "ours", ""], rows, {}, {})


def bound_table(flown: Sequence[Flown]) -> Table:
    """Set errors beside their bounds."""
    head = ["", "", *(f"{axis}, m" for axis in ALONG), "bound, m", "error / bound", "attitude, deg",
            "bound, deg"]  # fmt: skip
    rows = []
    for own in flown:
        if own.bound is None:
            continue
        rows.append(
            [
                f"{own.cell.case.name}, {own.flight.runs} runs",
                TITLES[own.cell.variant],
                *(number(each) for each in own.flight.rms_along_m),
                ", ".join(number(each) for each in own.bound.along_m),
                number(own.flight.rms_m / own.bound.position_m),
                number(own.flight.attitude_deg, 2),
                number(own.bound.attitude_deg, 2),
            ]
        )
    return Table(head, rows, {}, {})


def consistency_table(flown: Sequence[Flown]) -> Table:
    """List NEES over its degrees of freedom, and how often it is where it should be."""
    rows = [
        [
            f"{own.cell.case.name}, {own.flight.runs} runs",
            TITLES[own.cell.variant],
            *_honesty(own.flight.orbit),
            *_honesty(own.flight.attitude),
            *_honesty(own.flight.whole),
        ]
        for own in flown
    ]
    head = ["", "", "orbit, clock", "inside", "attitude", "inside", "all 17", "inside"]
    return Table(head, rows, {}, {})


def _honesty(found: Consistency | None) -> list[str]:
    if found is None:
        return [NONE, NONE]
    return [number(found.mean), share(found.inside)]


def availability_table(counted: Sequence[Counted]) -> Table:
    """List how many satellites there are, by antenna gain and transmit pattern."""
    rows = [
        [
            f"{own.case.name}, {own.case.gain_dbi:g} dBi",
            "mean over azimuth" if own.case.azimuth_averaged else "by azimuth",
            number(own.visible),
            number(own.tracked),
            number(own.used),
            share(own.enough),
        ]
        for own in counted
    ]
    head = ["", "transmit pattern", "in sight", "tracked", "used", "four or more"]
    return Table(head, rows, {}, {})


def fault_table(faults: Sequence[FaultOutcome]) -> Table:
    """List how faults were met."""
    rows = [
        [
            own.name,
            share(own.noticed),
            NONE if own.delay_s is None else f"{number(own.delay_s)} s",
            f"{number(own.worst_m)} m, {number(own.worst_deg, 2)} deg",
            f"{number(own.after_m)} m, {number(own.after_deg, 2)} deg",
        ]
        for own in faults
    ]
    return Table(["", "told of", "after", "worst error", "rms at the end"], rows, {}, {})


def mask_table(masked: Sequence[Flown], unmasked: Sequence[Flown]) -> Table:
    """Set GEO with and without the mask side by side.

    Parameters
    ----------
    masked, unmasked : sequence of Flown
        By variant, in the same order; ``masked`` may be empty.
    """
    rows = [
        [
            own.cell.variant,
            "without" if not own.cell.mask else "with",
            *(number(each) for each in own.flight.rms_along_m),
            number(own.flight.satellites),
            number(own.flight.edited),
        ]
        for own in (*masked, *unmasked)
    ]
    head = ["", "mask", *(f"{axis}, m" for axis in ALONG), "satellites", "edited"]
    return Table(head, rows, {}, {})


def sampling_table(sampled: Sampled) -> Table:
    """Compare 100 Hz steps with sums between star frames."""
    row = [number(sampled.position, 4), number(sampled.attitude, 4), number(sampled.apart)]
    head = ["", "position rms", "attitude rms", "largest difference, sigma"]
    return Table(head, [["100 Hz over sums", *row]], {}, {})
