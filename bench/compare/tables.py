"""A comparison's tables, of a terminal and a page alike."""

from __future__ import annotations

from bench.compare.comparison import Comparison
from bench.compare.leaderboard import MEASURES, Value
from bench.report.numbers import NONE, count, number, share
from bench.report.table import Table, Term, with_unit
from bench.scoring.metrics import bop, speed
from bench.scoring.metrics.recall import Recall
from bench.scoring.pose_summary import PoseSummary

TERMS = (
    Term("frames", "Frames of the dataset; a file that lacks some has lost them.", "frames"),
    Term("without a pose", "Lost: none told, or none that the method stands by."),
    Term("wrong poses", "Beyond what their covariance allows, and beyond the case's limits."),
    Term(
        "position error, median", "Length of estimate minus truth, of frames with a pose.", "pose"
    ),
    Term("position error, p95", "95 of 100 frames with a pose are better than this."),
    Term("position over range, median", "The same over the true range, of frames with a pose."),
    Term("attitude error, median", "Angle of the turn from true to estimated, frames with a pose."),
    Term("attitude error, p95", "95 of 100 frames with a pose are better than this."),
    Term(
        "SPEED score",
        "Mean over all frames of position error over range plus attitude error in rad; a lost "
        f"frame counts {number(speed.LOST.score)}. Less is better (Kisantal et al. 2020).",
        "SPEED",
    ),
    Term(
        "SPEED score, floored",
        f"The same, a position term below {speed.FLOOR_POSITION:g} and an attitude term below "
        f"{speed.FLOOR_ATTITUDE_DEG:g} deg being zero, each for itself (SPEED+, as spnv2 has it).",
    ),
    Term("SPEED score, with a pose", "Without floors, over the frames with a pose alone."),
    Term("ADD, median", "Mean distance of the target's points from their true places.", "surface"),
    Term("ADD-S, median", "Mean distance of true points from the nearest estimated one."),
    Term("MSSD, median", "Largest distance of any of the target's points from its true place."),
    Term("MSPD, median", "The same of their projections."),
    Term(
        "AR VSD",
        "Share of all frames, tolerances and thresholds passed by the visible surface discrepancy "
        f"(BOP; delta {1e3 * bop.VSD_DELTA_M:g} mm).",
        "BOP",
    ),
    Term("AR MSSD", "The same for MSSD, thresholds of 5 to 50 % of the diameter."),
    Term("AR MSPD", "The same for MSPD, thresholds of 5 to 50 px of an image 640 px wide."),
    Term("AR", "Mean of the three: BOP's average recall. More is better."),
)


def summary_table(comparison: Comparison) -> Table:
    """Set the methods side by side, the best first."""
    labels = [standing.label for standing in comparison.board.standings]
    columns = [_cells(comparison.summaries[label]) for label in labels]
    rows = [[term.name, *(column[place] for column in columns)] for place, term in enumerate(TERMS)]
    sections = {place: term.section for place, term in enumerate(TERMS) if term.section}
    return Table(["", *labels], rows, {term.name: term.meaning for term in TERMS}, sections)


def standing_table(comparison: Comparison) -> Table:
    """Rank the methods, each number with its interval."""
    board = comparison.board
    measures = [name for name in MEASURES if name in board.standings[0].values]
    rows = []
    for place, standing in enumerate(board.standings, start=1):
        remark = "" if place == 1 else "not told apart" if standing.tied_with_first else "worse"
        cells = [_within(standing.values[name]) for name in measures]
        rows.append([f"{place}. {standing.label}", *cells, remark])
    head = ["", *(_head(name) for name in measures), "against the first"]
    return Table(head, rows, {}, {})


def pair_table(comparison: Comparison) -> Table:
    """Tell of each two methods how they differ, frame by frame."""
    rows = [
        [
            f"{pair.one} − {pair.other}",
            _within(pair.difference, signed=True),
            f"{share(pair.better_share.value)} ({_ends(pair.better_share, percent=True)})",
            pair.verdict,
        ]
        for pair in comparison.board.pairs
    ]
    head = ["", _head(comparison.board.rank_by), "frames in which the first is better",
            "told apart"]  # fmt: skip
    return Table(head, rows, {}, {})


def group_table(comparison: Comparison, by: str) -> Table:
    """Tell how each method does under like conditions."""
    rows: list[list[str]] = []
    sections: dict[int, str] = {}
    before = ""
    for own in comparison.board.groups:
        if own.by != by:
            continue
        if own.group != before:
            sections[len(rows)] = f"{own.group}, {own.frames} frames"
            before = own.group
        cells = [_within(own.values[name]) for name in MEASURES if name in own.values]
        rows.append([own.label, count(own.lost), *cells])
    measures = [name for name in MEASURES if name in comparison.board.standings[0].values]
    return Table(["", "lost", *(_head(name) for name in measures)], rows, {}, sections)


def recall_table(comparison: Comparison, kind: str) -> Table:
    """Tell which share of all frames is within each threshold of a kind."""
    labels = [standing.label for standing in comparison.board.standings]
    recalls: list[list[Recall]] = [
        [each for each in comparison.summaries[label].recall if each.kind == kind]
        for label in labels
    ]
    rows = [
        [own[0].what, *(share(each.share) for each in own)] for own in zip(*recalls, strict=True)
    ]
    return Table(["", *labels], rows, {}, {})


def lost_table(comparison: Comparison) -> Table:
    """List why frames have no pose."""
    rows = [
        [label, count(times), reason]
        for label, summary in comparison.summaries.items()
        for reason, times in summary.lost.items()
    ]
    return Table(["method", "frames", "reason"], rows, {}, {})


def file_table(comparison: Comparison) -> Table:
    """List which files were compared."""
    rows = [
        [
            method.label,
            method.path.name,
            method.format,
            count(method.missing),
            "; ".join(method.remarks) or NONE,
            method.sha256[:16],
        ]
        for method in comparison.methods
    ]
    return Table(["method", "file", "format", "frames missing", "left out", "sha256"], rows, {}, {})


def _cells(own: PoseSummary) -> list[str]:
    position, relative, attitude = (
        own.position_error_m,
        own.position_over_range,
        own.attitude_error_deg,
    )
    add, add_s, mssd, mspd = (
        None if sizes is None else sizes.median
        for sizes in (own.add_m, own.add_s_m, own.mssd_m, own.mspd_px)
    )
    recall = own.bop
    return [
        count(own.frames),
        count(own.frames - own.estimated),
        count(own.wrong),
        metres(position.median),
        metres(position.p95),
        share(relative.median),
        with_unit(attitude.median, "deg"),
        with_unit(attitude.p95, "deg"),
        number(own.speed.score),
        number(own.speed.score_floored),
        number(own.speed.score_estimated),
        metres(add),
        metres(add_s),
        metres(mssd),
        with_unit(mspd, "px"),
        number(None if recall is None else recall.ar_vsd),
        number(None if recall is None else recall.ar_mssd),
        number(None if recall is None else recall.ar_mspd),
        number(None if recall is None else recall.ar),
    ]


def metres(value: float | None) -> str:
    """Write a length in mm below 1 m, in m above."""
    if value is None or value >= 1.0:
        return with_unit(value, "m")
    return with_unit(1e3 * value, "mm")


def _head(name: str) -> str:
    measure = MEASURES[name]  # type: ignore[index]
    unit = f", {measure.unit}" if measure.unit else ""
    return f"{measure.title}{unit}"


def _within(value: Value, signed: bool = False) -> str:
    return f"{number(value.value, signed=signed)} ({_ends(value, signed=signed)})"


def _ends(value: Value, signed: bool = False, percent: bool = False) -> str:
    scale = 100.0 if percent else 1.0
    low, high = (
        "∞" if end is None else number(scale * end, signed=signed) for end in value.interval
    )
    return f"{low} to {high}"
