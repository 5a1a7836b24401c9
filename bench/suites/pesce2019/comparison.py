"""Ours beside the paper's, cell by cell: figures, ratios, verdicts, and why where they part."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from bench.report.numbers import number
from bench.suites.pesce2019.cases import published
from bench.suites.pesce2019.plan import TABLE_RUNS
from bench.suites.pesce2019.results import AcquiredCase, Results, TrackedCell
from bench.suites.pesce2019.summaries import AcquisitionSummary, BoundSummary, TrackingSummary

FACTOR = 2.0  # `paper` further than this from the paper's own figure is explained
WORST_HEAVY = 0.5  # of the sum of squares: then one run makes the figure
LOST_HEAVY = 0.05  # of the frames
NEAR_BOUND = 1.25  # of the Cramer-Rao bound: nothing left to gain there


@dataclass(frozen=True)
class Compared:
    """One cell of one of the paper's tables.

    Attributes
    ----------
    table : str
        ``table5`` to ``table8``.
    row, quantity, unit : str
    published : float
    best, paper : float or None
        Ours.
    best_ratio, paper_ratio : float or None
        Ours over the published.
    best_verdict : str
        ``at or below``, ``above`` or ``none``.
    paper_verdict : str
        ``within two``, ``better by more``, ``worse by more`` or ``none``.
    explanation : str or None
        Where ``paper`` is further than a factor of two away: why, from what was measured.
    """

    table: str
    row: str
    quantity: str
    unit: str
    published: float
    best: float | None
    paper: float | None
    best_ratio: float | None
    paper_ratio: float | None
    best_verdict: str
    paper_verdict: str
    explanation: str | None


@dataclass(frozen=True)
class Measured:
    """What a tracking cell's explanation is made of, for one of position and attitude.

    Attributes
    ----------
    unit : str
    filtered, raw, median_run, worst_share : float or None
    single_bound, filter_bound : float
    no_state, no_pose : float
    runs : int
    """

    unit: str
    filtered: float | None
    raw: float | None
    median_run: float | None
    worst_share: float | None
    single_bound: float
    filter_bound: float
    no_state: float
    no_pose: float
    runs: int


def compared(results: Results) -> list[Compared]:
    """Return every cell of Tables 5 to 8 that was run."""
    reference = published()
    cells: list[Compared] = []
    for acquired in results.table5:
        cells += _acquisition_cells(acquired, reference["acquisition"][f"case{acquired.case.key}"])
    for tracked in results.table6:
        row, figures = row_title("table6", tracked), reference["tracking_rmse"]
        figures = figures[f"case{tracked.cell.case.key}"]
        cells += _tracking_cells("table6", row, figures, tracked.steady, tracked.bound_steady)
    for tracked in results.table7:
        sigma_px = tracked.cell.noise.sigma_px
        figures = reference["noise_sensitivity"][f"{sigma_px:g}"]
        row = row_title("table7", tracked)
        cells += _tracking_cells("table7", row, figures, tracked.settled, tracked.bound_settled)
    for tracked in results.table8:
        outliers = tracked.cell.noise.outliers
        figures = reference["outlier_sensitivity"][f"{outliers}"]
        row = row_title("table8", tracked)
        cells += _tracking_cells("table8", row, figures, tracked.settled, tracked.bound_settled)
    return cells


def row_title(table: str, own: AcquiredCase | TrackedCell) -> str:
    """Return what a row of one of the paper's tables is of.

    Parameters
    ----------
    table : str
    own : AcquiredCase or TrackedCell
    """
    if isinstance(own, TrackedCell) and table == "table7":
        return f"σ {own.cell.noise.sigma_px:g} px"
    if isinstance(own, TrackedCell) and table == "table8":
        outliers = own.cell.noise.outliers
        return f"{outliers} outlier{'s' if outliers > 1 else ''}"
    case = own.cell.case if isinstance(own, TrackedCell) else own.case
    return f"case {case.key}, {case.name}"


def _cell(
    table: str,
    row: str,
    quantity: str,
    unit: str,
    published: float,
    best: float | None,
    paper: float | None,
    why: str,
) -> Compared:
    best_ratio = None if best is None else best / published
    paper_ratio = None if paper is None else paper / published
    if paper_ratio is None:
        paper_verdict = "none"
    elif paper_ratio > FACTOR:
        paper_verdict = "worse by more"
    elif paper_ratio < 1.0 / FACTOR:
        paper_verdict = "better by more"
    else:
        paper_verdict = "within two"
    return Compared(
        table, row, quantity, unit, published, best, paper, best_ratio, paper_ratio,
        _best_verdict(best_ratio), paper_verdict, None if paper_verdict == "within two" else why,
    )  # fmt: skip


def _best_verdict(ratio: float | None) -> str:
    if ratio is None:
        return "none"
    return "at or below" if ratio <= 1.0 else "above"


def _acquisition_cells(acquired: AcquiredCase, figures: dict[str, list[float]]) -> list[Compared]:
    row = row_title("table5", acquired)
    best, paper = acquired.table["best"], acquired.table["paper"]
    columns: tuple[tuple[str, str, float, float | None, float | None], ...] = (
        ("position error, mean", "m", figures["e_rho_m"][0], best.position_m, paper.position_m),
        ("position error, std", "m", figures["e_rho_m"][1], best.position_std_m,
         paper.position_std_m),
        ("attitude error, mean", "deg", figures["e_R_deg"][0], best.attitude_deg,
         paper.attitude_deg),
        ("attitude error, std", "deg", figures["e_R_deg"][1], best.attitude_std_deg,
         paper.attitude_std_deg),
    )  # fmt: skip
    return [
        _cell(
            "table5", row, quantity, unit, own, ours, theirs,
            _why_acquisition(paper, best, unit, own, acquired.single_bound[unit]),
        )
        for quantity, unit, own, ours, theirs in columns
    ]  # fmt: skip


def _tracking_cells(
    table: str,
    row: str,
    figures: list[float],
    summaries: dict[str, TrackingSummary],
    bound: BoundSummary,
) -> Iterator[Compared]:
    best, paper = summaries["best"], summaries["paper"]
    yield _cell(
        table, row, "position rmse", "m", figures[0], best.position_m, paper.position_m,
        why_tracking(position_measured(paper, bound), figures[0]),
    )  # fmt: skip
    yield _cell(
        table, row, "attitude rmse", "deg", figures[1], best.attitude_deg, paper.attitude_deg,
        why_tracking(attitude_measured(paper, bound), figures[1]),
    )  # fmt: skip


def position_measured(paper: TrackingSummary, bound: BoundSummary) -> Measured:
    """Gather what explains a position error."""
    return Measured(
        "m", paper.position_m, paper.raw_position_m, paper.median_run_position_m,
        paper.worst_run_share_position, bound.raw_position_m, bound.position_m,
        paper.no_state, paper.no_pose, paper.runs,
    )  # fmt: skip


def attitude_measured(paper: TrackingSummary, bound: BoundSummary) -> Measured:
    """Gather what explains an attitude error."""
    return Measured(
        "deg", paper.attitude_deg, paper.raw_attitude_deg, paper.median_run_attitude_deg,
        paper.worst_run_share_attitude, bound.raw_attitude_deg, bound.attitude_deg,
        paper.no_state, paper.no_pose, paper.runs,
    )  # fmt: skip


def why_tracking(one: Measured, figure: float) -> str:
    """Say in a sentence or two where an error comes from: few runs, raw poses, or the filter."""
    if one.filtered is None or one.raw is None:
        return f"No state in {_percent(one.no_state)} of the frames of the window."
    ratio = one.filtered / figure
    parts = []
    heavy = max(WORST_HEAVY, FACTOR / one.runs)  # of two runs one always makes half
    if one.median_run and one.worst_share is not None and one.worst_share > heavy:
        parts.append(
            f"one run makes {_percent(one.worst_share)} of the sum of squares; the median run has "
            f"{_with_unit(one.median_run, one.unit)}, {_times(one.median_run / figure)} the "
            "published figure"
        )
    if one.no_pose > LOST_HEAVY:
        parts.append(f"no pose is found in {_percent(one.no_pose)} of the frames")
    excess, gain = one.raw / one.single_bound, one.raw / one.filtered
    quality = "at" if excess < NEAR_BOUND else f"{_times(excess)}"
    parts.append(
        f"the poses before the filter have {_with_unit(one.raw, one.unit)} rms, {quality} the "
        f"Cramér–Rao bound of one image ({_with_unit(one.single_bound, one.unit)} with our "
        f"landmarks, camera and range), and the filter divides that by {number(gain)}"
    )
    if ratio > FACTOR:
        needed = one.raw / figure
        parts.append(
            f"the published figure would take a division by {number(needed)}; the bound of a "
            f"filter that knows the motion is {_with_unit(one.filter_bound, one.unit)}"
        )
    else:
        parts.append(
            f"the published figure is {_times(figure / one.single_bound)} the bound of one image "
            "without any filter"
        )
    text = "; ".join(parts)
    return text[0].upper() + text[1:] + "."


def _why_acquisition(
    paper: AcquisitionSummary, best: AcquisitionSummary, unit: str, figure: float, bound: float
) -> str:
    if not paper.acquired:
        return f"None of {paper.runs} runs acquired."
    median = paper.median_position_m if unit == "m" else paper.median_attitude_deg
    own = best.median_position_m if unit == "m" else best.median_attitude_deg
    parts = [
        f"{paper.acquired} of {paper.runs} runs acquired, {paper.wrong} of them wrong by more than "
        f"10 deg or 1 m, which a mean is full of; the median is {_with_unit(median, unit)}"
        if paper.wrong
        else f"{paper.acquired} of {paper.runs} runs acquired, none wrong by more than 10 deg or "
        f"1 m; the median is {_with_unit(median, unit)}"
    ]
    if own is not None:
        parts.append(
            f"least squares over all matches, as in best, gives {_with_unit(own, unit)} on the "
            "same points"
        )
    parts.append(
        f"the Cramér–Rao bound of all landmarks in one image is {_with_unit(bound, unit)} rms, and "
        f"the published figure {_times(figure / bound)} that"
    )
    return "; ".join(parts) + "."


def table5_note(acquired: AcquiredCase) -> str:
    """Say what all the runs of a case came to, beyond the table's first hundred."""
    best = acquired.whole["best"]
    if best.wrong_share is None or best.wrong_share_most is None:
        return f"{acquired.case.name}: best acquired in none of {best.runs} runs."
    first = min(best.runs, TABLE_RUNS)
    return (
        f"{acquired.case.name}: {best.acquired} of {best.runs} acquired by best, {best.wrong} "
        f"wrong ({_percent(best.wrong_share)}, below {_percent(best.wrong_share_most)} with 97.5 % "
        f"confidence); the table's means are of the first {first}."
    )


def _with_unit(value: float | None, unit: str) -> str:
    return f"{number(value)} {unit}"


def _times(ratio: float) -> str:
    return f"{number(ratio, 2)} times"


def _percent(share: float) -> str:
    return f"{number(100.0 * share, 2)} %"
