"""Methods compared on one dataset: read, measured, ranked."""

from __future__ import annotations

from dataclasses import dataclass

from bench.compare.conditions import conditions, groups
from bench.compare.leaderboard import Leaderboard, frame_values, leaderboard
from bench.compare.methods import Method
from bench.compare.options import CompareOptions
from bench.progress import frame_progress
from bench.scoring.pose_measures import MethodMeasures, measured_methods
from bench.scoring.pose_summary import PoseSummary, pose_summary
from bench.scoring.true_view import TrueView, true_view
from models.dataset.dataset import Dataset
from models.errors import DatasetError


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
