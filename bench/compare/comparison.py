"""Methods compared on one dataset: read, measured, ranked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from typing import Any, TypedDict, Unpack

from bench.compare.bootstrap import Resampling
from bench.compare.conditions import conditions, groups
from bench.compare.leaderboard import Leaderboard, RankBy, frame_values, leaderboard
from bench.compare.methods import Method
from bench.estimating.foreign_estimates.reading import FileFormat
from bench.estimating.foreign_estimates.said_poses import Choices, TrajectoryOf
from bench.progress import frame_progress
from bench.scoring.pose_measures import MethodMeasures, measured_methods
from bench.scoring.pose_summary import PoseSummary, pose_summary
from bench.scoring.true_view import TrueView, true_view
from models.dataset.dataset import Dataset
from models.errors import DatasetError, ScenarioError
from models.reading.options import check_option

VSD_PX = 512  # of 2048: every fourth pixel; the shares differ by less than a hundredth
MOST_VSD_PX, MOST_SEED, MOST_RESAMPLES = 16_384, 2**63 - 1, 100_000


@dataclass(frozen=True)
class CompareOptions:
    """What can be asked of a comparison.

    Attributes
    ----------
    file_format : str, optional
        Of foreign files; found by what they hold unless given.
    choices : Choices
        What those leave open.
    rank_by : str
        ``speed``, ``position``, ``attitude`` or ``ar``.
    resampling : Resampling
    vsd_px : int
        Pixels along the image's longer side that VSD looks at; 0 leaves it out, and ``ar`` with it.
    """

    file_format: FileFormat | None = None
    choices: Choices = field(default_factory=Choices)
    rank_by: RankBy = "speed"
    resampling: Resampling = field(default_factory=Resampling)
    vsd_px: int = VSD_PX


class CompareChoices(TypedDict, total=False):
    """The same as typed: those of ``CompareOptions``, ``Choices`` and ``Resampling`` by name."""

    rank_by: RankBy
    file_format: FileFormat | None
    vsd_px: int
    scene: int | None
    target: int | None
    trajectory_of: TrajectoryOf
    seed: int
    resamples: int
    block_frames: int | None


def compare_options(**typed: Unpack[CompareChoices]) -> CompareOptions:
    """Return options from what is typed, checked.

    Raises
    ------
    ScenarioError
        If one cannot be.
    """

    def of(kind: type[Any]) -> dict[str, Any]:
        names = {each.name for each in fields(kind)}
        return {name: value for name, value in typed.items() if name in names}

    options = CompareOptions(
        **of(CompareOptions),
        choices=Choices(**of(Choices)),
        resampling=Resampling(**of(Resampling)),
    )
    check_options(options)
    return options


@dataclass(frozen=True, eq=False)
class Comparison:
    """What came of it.

    Attributes
    ----------
    view : TrueView
    options : CompareOptions
    methods : list of Method
    measures : list of MethodMeasures
    summaries : dict of str to PoseSummary
        By label.
    board : Leaderboard
    """

    view: TrueView
    options: CompareOptions
    methods: list[Method]
    measures: list[MethodMeasures]
    summaries: dict[str, PoseSummary]
    board: Leaderboard

    def method(self, label: str) -> Method:
        """Return a method by its label."""
        return next(method for method in self.methods if method.label == label)


def check_number(methods: Sequence[Method]) -> None:
    """Refuse to compare one method with nothing.

    Raises
    ------
    ScenarioError
    """
    if len(methods) < 2:
        raise ScenarioError(
            f"expected at least two methods to compare, got {methods[0].label} alone; "
            "for one: `rvbench score DATASET --estimates FILE`"
        )


def check_options(options: CompareOptions) -> None:
    """Refuse options that cannot be.

    Raises
    ------
    ScenarioError
    """
    how = options.resampling
    check_option("--seed", how.seed, 0, MOST_SEED, whole=True)
    check_option("--resamples", how.resamples, 100, MOST_RESAMPLES, whole=True)
    check_option("--block-frames", how.block_frames, 1, 1_000_000, whole=True)
    check_option("--vsd-px", options.vsd_px, 0, MOST_VSD_PX, whole=True)
    if options.rank_by == "ar" and not options.vsd_px:
        raise ScenarioError(
            "expected --vsd-px above 0 with --rank-by ar, whose average is over VSD too, got 0"
        )


def compared(dataset: Dataset, methods: list[Method], options: CompareOptions) -> Comparison:
    """Measure and rank methods whose estimates are at hand.

    Parameters
    ----------
    dataset : Dataset
    methods : list of Method
        Of different labels.
    options : CompareOptions

    Raises
    ------
    DatasetError
        If the truth is missing or cannot be read, or the ranking needs the target's shape and
        nobody knows it.
    """
    view = true_view(dataset, options.vsd_px)
    if options.rank_by == "ar" and view.shape is None:
        raise DatasetError(
            f"{dataset.folder}: expected a target whose shape is known for --rank-by ar, got "
            f"{dataset.info.target}; rank by speed, position or attitude"
        )
    runs = {method.label: method.run for method in methods}
    with frame_progress("measuring", len(dataset.entries)) as advance:
        measures = measured_methods(view, runs, advance)
    values = {each.label: frame_values(view, each) for each in measures}
    grouped = groups(conditions(view))
    return Comparison(
        view=view,
        options=options,
        methods=methods,
        measures=measures,
        summaries={each.label: pose_summary(view, each) for each in measures},
        board=leaderboard(values, options.rank_by, grouped, options.resampling),
    )
