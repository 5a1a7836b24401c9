"""The tables of the suite's page: the paper's, cell by cell, and what they hide."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from bench.report.numbers import NONE, count, number, numbers, share
from bench.report.table import TITLES, Table
from bench.suites.opromolla2022.asked import ALLOWED_OVER_PAPER, MEAN, RATIO, STD
from bench.suites.opromolla2022.cases import published
from bench.suites.opromolla2022.results import FlownSequence, MappedSun
from bench.suites.opromolla2022.summaries import PARAMETERS, PerFrame, Statistics

PRINTED, PEER = "printed", "exact centroids"
SHOWN = ("best", "paper")
ASKED_TERMS = {
    "mean, best": "Holds where it lies within three of its own standard errors of zero.",
    "std, best": "Holds where it is at most the printed one, or 1.1 of what exact centroids give.",
    f"mean, {PEER}": "The true centroids, solved under the same draws of calibration and survey.",
    "std, printed": "Of the mean over the runs, from instant to instant: not the error of a frame.",
}


def paper_table(flown: Sequence[FlownSequence]) -> Table:
    """Set mu_N and sigma_N beside the paper's, cell by cell."""
    head = ["", "tx, cm", "ty, cm", "tz, cm", "alpha, deg", "beta, deg", "gamma, deg", "asked"]
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    for own in flown:
        sections[len(rows)] = _title(own)
        printed = published()["results"][own.sequence.name]
        for name, line in (("mean", MEAN), ("std", STD)):
            told = [*printed[f"{name}_t_cm"], *printed[f"{name}_euler_deg"]]
            rows.append([f"{name}, {PRINTED}", *_signed(told), ""])
            for variant in (*SHOWN, "exact"):
                rows.append(
                    [
                        f"{name}, {_called(variant)}",
                        *_signed(_of(own.statistics[variant], name)),
                        _asked(own, line) if variant == "best" else "",
                    ]
                )
    return Table(head, rows, ASKED_TERMS, sections)


def _title(own: FlownSequence) -> str:
    one = own.per_frame["best"]
    return f"{own.sequence.name}: {one.runs} runs of {one.frames} frames"


def _called(variant: str) -> str:
    return PEER if variant == "exact" else TITLES[variant]


def _of(told: Statistics | None, name: str) -> list[float] | None:
    return None if told is None else getattr(told, name)


def _signed(values: Sequence[float] | None) -> list[str]:
    if values is None:
        return [NONE] * len(PARAMETERS)
    return [number(value, 2) for value in values]


def _asked(own: FlownSequence, line: str) -> str:
    told = next((each for each in own.asked if each.line == line), None)
    if told is None or told.holds is None:
        return NONE
    broken = [each.of for each in told.figures if each.holds is False]
    return "holds" if told.holds else f"does not hold: {', '.join(broken)}"


def centroid_table(flown: Iterable[FlownSequence]) -> Table:
    """Set centroid errors beside the paper's Table 13 and its section 5.2.1."""
    head = ["", "mean u, px", "mean v, px", "std u, px", "std v, px", "std u, all runs",
            "std v, all runs"]  # fmt: skip
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    for own in flown:
        printed = published()["centroids"].get(own.sequence.name)
        if printed is None:
            continue
        sections[len(rows)] = own.sequence.name
        rows.append([PRINTED, *_signed([*printed["mean"], *printed["std"]]), NONE, NONE])
        for variant in SHOWN:
            one = own.per_frame[variant]
            told = [one.centroid_mean_px, one.centroid_std_px, one.pooled_centroid_std_px]
            cells = [text for pair in told for text in (_signed(pair) if pair else [NONE, NONE])]
            rows.append([TITLES[variant], *cells])
    return Table(head, rows, {}, sections)


def frame_table(flown: Iterable[FlownSequence], by_runs: bool = False) -> Table:
    """List what a user of one run meets, sequence by sequence.

    Parameters
    ----------
    flown : iterable of FlownSequence
    by_runs : bool
        Whether the rows are sets of errors, and what was redrawn are runs.
    """
    head = [
        "", "", "position, mm: median", "p95", "rms", "attitude, deg: median", "p95", "rms",
        "lost", "missed", "wrong", "NEES / 6", "inside", "best / paper, rms", "worst parameter",
    ]  # fmt: skip
    rows: list[list[str]] = []
    for own in flown:
        name = own.sequence.errors if by_runs else own.sequence.name
        for variant in SHOWN:
            rows.append(
                [
                    name.replace("_", " "),
                    TITLES[variant],
                    *_frame_cells(own.per_frame[variant]),
                    *(_ratio_cells(own) if variant == "best" else ["", ""]),
                ]
            )
    return Table(head, rows, {}, {})


def _frame_cells(one: PerFrame) -> list[str]:
    return [
        *numbers(one.position_mm or None),
        *numbers(one.attitude_deg or None),
        f"{one.lost} of {one.runs * one.frames}",
        count(one.missed),
        count(one.wrong),
        number(one.nees.mean),
        share(one.nees.inside),
    ]


def _ratio_cells(own: FlownSequence) -> list[str]:
    over = own.over_paper
    if over is None:
        return [NONE, NONE]
    worst = max(range(len(PARAMETERS)), key=lambda place: over.high[place])
    between = f"{number(over.low[worst], 2)} to {number(over.high[worst], 2)}"
    verdict = "" if over.high[worst] <= ALLOWED_OVER_PAPER else ", not excluded"
    return [
        f"{number(min(over.ratio), 2)} to {number(max(over.ratio), 2)}",
        f"{PARAMETERS[worst]}: {between}{verdict}",
    ]


def rms_table(flown: Iterable[FlownSequence]) -> Table:
    """List the rms of each parameter under each error, variant by variant."""
    head = ["", "", *(f"{p}, mm" for p in PARAMETERS[:3]), *(f"{p}, deg" for p in PARAMETERS[3:])]
    rows = [
        [
            own.sequence.errors.replace("_", " "),
            TITLES[variant],
            *_signed(own.per_frame[variant].rms or None),
        ]
        for own in flown
        for variant in SHOWN
    ]
    return Table(head, rows, {}, {})


def sun_table(suns: Iterable[MappedSun]) -> Table:
    """List what came of each Sun of the map."""
    told = ("colour", "poses", "by the outline", "wrong", "mm, rms", "deg, rms", "why none")
    head = ["", "dots lit and seen, %", "frames with all",
            *(f"{TITLES[variant]}: {what}" for variant in SHOWN for what in told)]  # fmt: skip
    rows = []
    for own in suns:
        first = own.verdicts[SHOWN[0]]
        dots = ", ".join(f"{100.0 * share:.0f}" for share in first.dots)
        cells = [own.sun, dots, f"{first.all_shown} of {first.frames}"]
        for variant in SHOWN:
            one, frames = own.verdicts[variant], own.per_frame[variant]
            cells += [
                one.colour,
                f"{one.poses} of {one.frames}",
                count(one.outline_of_few),
                count(one.overconfident),
                number(frames.position_mm[2] if frames.position_mm else None),
                number(frames.attitude_deg[2] if frames.attitude_deg else None),
                one.reason or NONE,
            ]
        rows.append(cells)
    return Table(head, rows, {}, {})


def sun_rule_table(suns: Iterable[MappedSun]) -> Table:
    """Sum over the map what holds where all dots are lit and seen, and where not."""
    head = ["", "frames with all dots", "of them with a pose", "other frames", "with a pose",
            "of them by the outline", "wrong poses"]  # fmt: skip
    rows = []
    for variant in SHOWN:
        own = [each.verdicts[variant] for each in suns]
        rows.append(
            [
                TITLES[variant],
                count(sum(each.all_shown for each in own)),
                count(sum(each.posed_of_shown for each in own)),
                count(sum(each.few for each in own)),
                count(sum(each.posed_of_few for each in own)),
                count(sum(each.outline_of_few for each in own)),
                count(sum(each.overconfident for each in own)),
            ]
        )
    return Table(head, rows, {}, {})


def headline_table(flown: Iterable[FlownSequence]) -> Table:
    """Compare the variants in one line a sequence."""
    head = ["", "position rms, mm: best", "paper variant", "attitude rms, deg: best",
            "paper variant", "lost: best", "paper variant", "not worse than paper", "mean",
            "std"]  # fmt: skip
    rows = []
    for own in flown:
        best, paper = own.per_frame["best"], own.per_frame["paper"]
        rows.append(
            [
                own.sequence.name,
                number(best.position_mm[2] if best.position_mm else None),
                number(paper.position_mm[2] if paper.position_mm else None),
                number(best.attitude_deg[2] if best.attitude_deg else None),
                number(paper.attitude_deg[2] if paper.attitude_deg else None),
                count(best.lost),
                count(paper.lost),
                _asked(own, RATIO),
                _asked(own, MEAN),
                _asked(own, STD),
            ]
        )
    terms = {
        "E-SB": "Sun behind the target, a lamp beside the lens.",
        "I": "S7's light, twice the prior's error.",
        "C1": "S7's light, two pixels of calibration error; C2: three.",
        "M1": "S7's light, markers installed 1 mm off.",
    }
    return Table(head, rows, terms, {})
