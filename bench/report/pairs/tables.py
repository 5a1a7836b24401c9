"""The tables of image pairs, as rows of text made from ``score.json``."""

from __future__ import annotations

import math
from typing import Any

from bench.report.numbers import NONE, number, numbers, share
from bench.report.pairs.published import PublishedCase
from bench.report.table import (
    CORE_TERMS,
    TIME_TERMS,
    Table,
    Term,
    core_cells,
    headline,
    time_cells,
    title_of,
    unseen,
)
from bench.scoring.score import shown_labels
from models.quantiles import chi_square_quantile

Score = dict[str, Any]

UNSEEN = [term.name for term in CORE_TERMS].index("missed") + 1
TERMS = (
    *CORE_TERMS[:UNSEEN],
    Term(
        "could not be seen",
        "Frames without a pose that were not missed: too few markers whole, lit and in the image.",
    ),
    *CORE_TERMS[UNSEEN:],
    Term(
        "position rms x, y, z",
        "Root mean square along the camera's axes: x right, y down, z along the boresight. A "
        "constant bias counts.",
    ),
    Term(
        "attitude rms α, β, γ",
        "Root mean square of the errors of the passive 3-2-1 angles, wrapped.",
    ),
    Term(
        "centroid bias u, v",
        "Mean over all frames and markers of detection minus the marker's projected centre with "
        "the true pose (Table 13 of the paper).",
        "image processing",
    ),
    Term("centroid std u, v", "Standard deviation of the same."),
    Term(
        "detector's part of it",
        "Standard deviation about each marker's mean over the runs: what another detector seed "
        "changes. Needs two runs.",
    ),
    Term(
        "precision",
        "Share of the matched detections that lie within max(1.5 px, half a radius) of the marker "
        "they are matched to.",
    ),
    Term(
        "recall",
        "Share of the markers that are at least 99 % lit and visible, and 1.5 radii within the "
        "image, that were found and matched.",
    ),
    Term(
        "mismatches",
        "Detections matched to a marker that is not there; in brackets those that the solver kept.",
    ),
    Term(
        "position / bound",
        "Root mean square position error over the Cramer-Rao bound, for the centroid noise "
        "measured at that range and the markers used; 1 is the best that an unbiased estimator "
        "can do. All runs. A pose from fewer than three true matches has no bound and is left "
        "out; it shows in the errors above.",
        "solver",
    ),
    Term("attitude / bound", "The same for the rotation vector."),
    Term(
        "at the bound",
        "Where 95 of 100 such ratios would lie if the pipeline reached the bound: chi-square, one "
        "degree of freedom a pose. Of few poses they say little.",
    ),
    Term(
        "NEES",
        "Mean of e'P⁻¹e / 6 with the covariance that the pipeline states: 1 is honest, above is "
        "overconfident. In brackets where it falls 95 times in 100 if the errors of different "
        "frames are independent.",
    ),
    *TIME_TERMS,
)


def headline_table(score: Score) -> Table:
    """Compare the pipelines on the same pairs."""
    columns = {label: _column(score["pipelines"][label]) for label in shown_labels(score)}
    return headline(score, TERMS, columns)


def _column(own: dict[str, Any]) -> list[str]:
    parts = own["parts"]
    axes, centroids, detection = parts["axes"]["run_0"], parts["centroids"], parts["detection"]
    efficiency, nees = parts["efficiency"], parts["nees"]
    bounds = [number(bound) for bound in nees["bounds"] or [None, None]]
    core = core_cells(own["core"])
    core.insert(UNSEEN, unseen(own["core"]))
    return [
        *core,
        _unit(_triple(axes["position_rms_mm"]), "mm"),
        _unit(_triple(axes["euler_rms_deg"]), "deg"),
        _unit(_pair(centroids["run_0"]["mean"], signed=True), "px"),
        _unit(_pair(centroids["run_0"]["std"]), "px"),
        _unit(_pair(centroids["pooled"]["temporal_std"]), "px"),
        share(detection["precision"]),
        share(detection["recall"]),
        f"{detection['mismatches']} ({detection['mismatches_used']})",
        _with_count(efficiency["position"], own),
        _with_count(efficiency["attitude"], own),
        _chance(efficiency["frames"]),
        f"{number(nees['mean'])} ({bounds[0]} to {bounds[1]})" if nees["bounds"] else NONE,
        *time_cells(own["core"]),
    ]


def _with_count(ratio: float | None, own: dict[str, Any]) -> str:
    """Write an efficiency, and of how many poses it is if some have no bound."""
    bounded, poses = own["parts"]["efficiency"]["frames"], own["core"]["pooled"]["estimated"]
    return number(ratio) if bounded == poses else f"{number(ratio)} ({bounded} of {poses} poses)"


def at_the_bound(poses: int) -> tuple[float, float]:
    """Return where ratios of rms error to bound lie 95 times in 100, of who reaches the bound.

    One degree of freedom a pose: of its three axes one, the boresight or the turn that looks like
    it, makes up most of the error.

    Parameters
    ----------
    poses : int
        At least one.
    """
    low, high = (chi_square_quantile(each, poses) / poses for each in (0.025, 0.975))
    return math.sqrt(low), math.sqrt(high)


def chance_words(poses: int) -> str:
    """Say what so few poses can tell of a ratio to the bound."""
    if not poses:
        return "no pose has a bound"
    return f"of {poses} poses chance alone gives {_chance(poses)}"


def _chance(poses: int) -> str:
    return " to ".join(number(end) for end in at_the_bound(poses)) if poses else NONE


def published_table(score: Score, published: PublishedCase | None) -> Table:
    """Set mu_N and sigma_N (equations 17 and 18) and centroids beside the paper's."""
    head = ["", "tx", "ty", "tz", "α", "β", "γ", "u", "v"]
    means, spreads = [], []
    if published is not None:
        source = f"{published.source}, {published.runs} runs"
        mean, std = vars(published.mean), vars(published.std)
        means.append([source, *_pose_cells(mean), *_signed(published.centroid_mean_px)])
        spreads.append([source, *_pose_cells(std, False), *_plain(published.centroid_std_px)])
    for variant in reversed(shown_labels(score)):
        parts = score["pipelines"][variant]["parts"]
        statistics, centroid = parts["paper_statistics"], parts["centroids"]["run_0"]
        runs = statistics["runs"]
        name = f"{title_of(variant)}, {runs} run{'s' if runs > 1 else ''}"
        means.append([name, *_pose_cells(statistics["mean"]), *_signed(centroid["mean"])])
        spreads.append([name, *_pose_cells(statistics["std"], False), *_plain(centroid["std"])])
    sections = {
        0: "mean over time of the mean error over the runs, μ_N",
        len(means): "standard deviation over time of the same, σ_N",
    }
    return Table(head, [*means, *spreads], {}, sections)


def _pose_cells(statistic: dict[str, Any] | None, signed: bool = True) -> list[str]:
    if statistic is None:
        return [NONE] * 6
    position_mm = [10.0 * value for value in statistic["t_cm"]]
    return [*numbers(position_mm, 2, signed), *numbers(statistic["euler_deg"], 2, signed)]


def _signed(values: Any) -> list[str]:
    return [number(value, 2, signed=True) for value in values or (None, None)]


def _plain(values: Any) -> list[str]:
    return [number(value, 3) for value in values or (None, None)]


def range_table(score: Score, variant: str) -> Table:
    """List one variant's errors by range."""
    head = [
        "range, m", "poses", "bias u", "bias v", "std u", "std v", "x", "y", "z",
        "about x", "about y", "about z", "position / bound", "attitude / bound", "at the bound",
    ]  # fmt: skip
    rows = []
    for row in score["pipelines"][variant]["parts"]["per_range"]:
        near, far = row["range_m"]
        rows.append(
            [
                f"{number(near, 2)} to {number(far, 2)}",
                f"{row['estimated']} of {row['frames']}",
                *_signed(row["centroid_bias_px"]),
                *_plain(row["centroid_std_px"]),
                *numbers(row["position_rms_mm"]),
                *numbers(row["rotation_rms_deg"]),
                number(row["efficiency"]["position"]),
                number(row["efficiency"]["attitude"]),
                _chance(row["efficiency"]["frames"]),
            ]
        )
    return Table(head, rows, {}, {})


def _unit(text: str, unit: str) -> str:
    return text if set(text) <= {NONE, ",", " "} else f"{text} {unit}"


def _pair(values: list[float] | None, signed: bool = False) -> str:
    return NONE if values is None else ", ".join(number(value, 3, signed) for value in values)


def _triple(values: list[float] | None) -> str:
    return NONE if values is None else ", ".join(numbers(values))
