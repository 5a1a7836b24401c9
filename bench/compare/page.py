"""The page of a comparison: leaderboard, pairs, conditions and recall, all in one HTML file."""

from __future__ import annotations

from pathlib import Path

from bench.compare import tables
from bench.compare.bootstrap import FEWEST_BLOCKS
from bench.compare.comparison import Comparison
from bench.compare.conditions import conditions
from bench.compare.figures import condition_figure, recall_figure, standing_figure
from bench.compare.leaderboard import MEASURES
from bench.report.numbers import number, share
from bench.report.page import Page, write_page
from bench.report.parts import Card, Figure, Section, TitledTable
from bench.report.plot import svg_address
from bench.scoring.metrics import speed

LOST_COUNT = f"a lost frame counts {number(speed.LOST.score)}, 1 + pi"
LOST_IN = {
    "speed": LOST_COUNT,
    "position": "a lost frame stands behind all others",
    "attitude": "a lost frame stands behind all others",
    "ar": "a lost frame recalls nothing",
}


def write_comparison_page(path: Path, comparison: Comparison) -> None:
    """Write ``comparison.html``."""
    info, board = comparison.view.dataset.info, comparison.board
    ranges = conditions(comparison.view).range_m
    frames = len(comparison.view.dataset.entries)
    near, far = number(float(ranges.min())), number(float(ranges.max()))
    span = f"{near} to {far} m" if near != far else f"at {near} m"
    page = Page(
        title=f"{info.case}, {len(comparison.methods)} methods",
        heading=f"{len(comparison.methods)} methods on {info.case}",
        lead=f"{info.target} under Sun {info.sun}, the same {frames} frames for all, {span}",
        label=board.standings[0].label,
        cards=_cards(comparison),
        headline_title="Every measure, method by method",
        headline=tables.summary_table(comparison),
        before=[_board(comparison)],
        after=[_pairs(comparison), *_groups(comparison), _recall(comparison)],
        later=[
            Section(
                "Frames without a pose",
                tables=(TitledTable("Lost", tables.lost_table(comparison), wide=True),),
                nothing="None.",
            ),
            Section(
                "Files",
                tables=(TitledTable("Files", tables.file_table(comparison), wide=True),),
            ),
        ],
        facts=_facts(comparison),
    )
    write_page(path, page)


def _cards(comparison: Comparison) -> list[Card]:
    first = comparison.board.standings[0]
    own = comparison.summaries[first.label]
    tied = sum(standing.tied_with_first for standing in comparison.board.standings)
    position, attitude = own.position_error_m, own.attitude_error_deg
    beside = f"and {tied} not told apart from it" if tied else "told apart from all others"
    return [
        Card(first.label, "", f"first by {MEASURES[comparison.board.rank_by].title}", beside),
        Card(number(own.speed.score), "", "its SPEED score", LOST_COUNT),
        Card(tables.metres(position.median), "", "its position error, median",
             f"{share(own.position_over_range.median)} of the range; "
             f"95 % below {tables.metres(position.p95)}"),
        Card(number(attitude.median), "deg", "its attitude error, median",
             f"95 % below {number(attitude.p95)} deg"),
        Card(f"{own.estimated} of {own.frames}", "frames", "with a pose",
             f"{own.wrong or 'none'} wrong"),
    ]  # fmt: skip


def _board(comparison: Comparison) -> Section:
    how, frames = comparison.options.resampling, len(comparison.view.dataset.entries)
    return Section(
        "Leaderboard",
        text=(
            f"Ranked by {MEASURES[comparison.board.rank_by].title}, over all frames: "
            f"{LOST_IN[comparison.board.rank_by]}. Medians here count a lost frame as infinitely "
            "wrong; those of the next table leave it out. In brackets intervals of 95 % for each "
            "number by itself."
        ),
        figures=(Figure(svg_address(standing_figure(comparison)), "Standings with intervals"),),
        tables=(TitledTable("Leaderboard", tables.standing_table(comparison), wide=True),),
        note=(
            f"Circular block bootstrap of {how.resamples} resamples, seed {how.seed}, blocks of "
            f'{how.block(frames)} frames; all methods are drawn with the same numbers. "Not told '
            'apart" is a difference from the first whose interval holds 0, or of fewer than '
            f"{FEWEST_BLOCKS} blocks, whose signs agree too often by chance."
        ),
    )


def _pairs(comparison: Comparison) -> Section:
    return Section(
        "Pair by pair, frame by frame",
        text="The first minus the second on the same frames; below 0 the first has less.",
        tables=(TitledTable("Pairs", tables.pair_table(comparison), wide=True),),
    )


def _groups(comparison: Comparison) -> list[Section]:
    known = list(dict.fromkeys(own.by for own in comparison.board.groups))
    figures = (
        Figure(
            svg_address(condition_figure(comparison)),
            "SPEED score of each frame over its conditions",
            "One mark a frame; a cross where it is lost.",
        ),
    )
    if not known:
        return [Section("By condition", text="Too few or too like frames to group.",
                        figures=figures)]  # fmt: skip
    titled = tuple(
        TitledTable(f"By {by}", tables.group_table(comparison, by), wide=True, heading=True)
        for by in known
    )
    text = (
        "Range is from the camera to the target frame's origin; the phase angle lies between Sun "
        "and camera, as seen from there; the tumble rate is the target's in the chaser's local "
        "frame. What a dataset's truth does not tell is left out."
    )
    return [Section("By range, phase angle and tumble rate", text, figures, titled)]


def _recall(comparison: Comparison) -> Section:
    return Section(
        "Recall",
        text="The share of all frames, lost ones too, whose error is below a threshold.",
        figures=(Figure(svg_address(recall_figure(comparison)), "Recall against error"),),
        tables=(
            TitledTable(
                "Thresholds for a spacecraft",
                tables.recall_table(comparison, "spacecraft"),
                heading=True,
            ),
            TitledTable(
                "Usual thresholds, of table-top objects",
                tables.recall_table(comparison, "usual"),
                heading=True,
            ),
        ),
        note="d is the target's diameter; ADD and ADD-S are over points spread on its surface.",
    )


def _facts(comparison: Comparison) -> list[tuple[str, str]]:
    view = comparison.view
    shape, grid = view.shape, view.grid
    told = "not known: no ADD, no BOP"
    if shape is not None:
        told = (
            f"{shape.source}, diameter {number(shape.diameter_m, 4)} m, {len(shape.spread)} points "
            f"spread and {len(shape.corners)} corners of its hull, "
            f"{len(shape.symmetries) or 'no'} symmetries declared"
        )
    seen = "left out"
    if grid is not None:
        nth = "every pixel" if grid.stride == 1 else f"one pixel of {grid.stride}, both ways"
        seen = f"{nth}; the scene's depth from {view.scene_depth_source}"
    info = view.dataset.info
    return [
        ("case", f"{info.case}, Sun {info.sun}, target {info.target}"),
        ("shape", told),
        ("VSD", seen),
        *info.provenance.items(),
        ("dataset", f"sha256 {view.dataset.fingerprint()}"),
    ]
