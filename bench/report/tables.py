"""The tables of the report, as rows of text made from ``score.json``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from bench.report.numbers import NONE, count, number, numbers, share
from bench.report.pairs.published import PublishedCase

Score = dict[str, Any]
MOST_LISTED = 10
TITLES = {"best": "best", "paper": "paper variant"}


@dataclass(frozen=True)
class Table:
    """A table of text.

    Attributes
    ----------
    head : list of str
        Column titles; the first column's is usually empty.
    rows : list of list of str
    terms : dict
        What a first cell means, by its text: shown when pointed at.
    sections : dict
        Titles that stand before the row of a given number.
    """

    head: list[str]
    rows: list[list[str]]
    terms: dict[str, str]
    sections: dict[int, str]


MEANINGS = {
    "frames": "Image pairs in the dataset.",
    "with a pose": "Frames for which the pipeline gave a pose.",
    "missed": "Frames without a pose although four or more markers were lit, visible and whole "
    "within the image. None of these should be.",
    "position error, median": "Length of estimate minus truth of t_cam_from_target, run 0.",
    "position error, p95": "95 of 100 frames are better than this.",
    "position rms x, y, z": "Root mean square along the camera's axes: x right, y down, z along "
    "the boresight. A constant bias counts.",
    "attitude error, median": "Angle of the turn between estimated and true attitude.",
    "attitude error, p95": "95 of 100 frames are better than this.",
    "attitude rms α, β, γ": "Root mean square of the errors of the passive 3-2-1 angles, wrapped.",
    "centroid bias u, v": "Mean over all frames and markers of detection minus the marker's "
    "projected centre with the true pose (Table 13 of the paper).",
    "centroid std u, v": "Standard deviation of the same.",
    "detector's part of it": "Standard deviation about each marker's mean over the runs: what "
    "another detector seed changes. Needs two runs.",
    "precision": "Share of the matched detections that lie within max(1.5 px, half a radius) of "
    "the marker they are matched to.",
    "recall": "Share of the markers that are at least 99 % lit and visible, and 1.5 radii within "
    "the image, that were found and matched.",
    "mismatches": "Detections matched to a marker that is not there; in brackets those that the "
    "solver kept.",
    "position / bound": "Root mean square position error over the Cramer-Rao bound, for the "
    "centroid noise measured at that range and the markers used; 1 is the best that an unbiased "
    "estimator can do. All runs. A pose from fewer than three true matches has no bound and is "
    "left out; it shows in the errors above.",
    "attitude / bound": "The same for the rotation vector.",
    "NEES": "Mean of e'P⁻¹e / 6 with the covariance that the pipeline states: 1 is honest, above "
    "is overconfident. In brackets where it falls 95 times in 100 if the errors of different "
    "frames are independent.",
    "runtime, median": "Time a frame takes, run 0, on the machine that estimated.",
    "runtime, p95": "95 of 100 frames take less.",
}


def variants_of(score: Score) -> list[str]:
    """Return the pipeline variants, ``best`` first."""
    return sorted(score["pipelines"], key=lambda variant: (variant != "best", variant))


def headline_table(score: Score) -> Table:
    """Compare the variants on the same frames."""
    variants = variants_of(score)
    columns = [_headline(score["pipelines"][variant]) for variant in variants]
    rows = [[term, *(column[place] for column in columns)] for place, term in enumerate(MEANINGS)]
    sections = {0: "frames", 3: "pose", 9: "image processing", 15: "solver", 18: "time"}
    head = ["", *(TITLES.get(variant, variant) for variant in variants)]
    return Table(head, rows, MEANINGS, sections)


def _headline(score: Score) -> list[str]:
    position, attitude = score["position_error_mm"], score["attitude_error_deg"]
    centroid, detection = score["centroid_error_px"], score["detection"]
    pooled, nees = score["pooled"]["centroid_error_px"], score["nees"]
    efficiency, runtime = score["efficiency"], score["runtime_ms"]
    bounds = [number(bound) for bound in nees["bounds"] or [None, None]]
    return [
        count(score["frames"]),
        count(score["estimated"]),
        count(score["lost"]["missed"]),
        _unit(number(position["median"]), "mm"),
        _unit(number(position["p95"]), "mm"),
        _unit(_triple(position["rms"]), "mm"),
        _unit(number(attitude["median"]), "deg"),
        _unit(number(attitude["p95"]), "deg"),
        _unit(_triple(attitude["rms"]), "deg"),
        _unit(_pair(centroid["mean"], signed=True), "px"),
        _unit(_pair(centroid["std"]), "px"),
        _unit(_pair(pooled["temporal_std"]), "px"),
        share(detection["precision"]),
        share(detection["recall"]),
        f"{detection['mismatches']} ({detection['mismatches_used']})",
        _with_count(efficiency["position"], score),
        _with_count(efficiency["attitude"], score),
        f"{number(nees['mean'])} ({bounds[0]} to {bounds[1]})" if nees["bounds"] else NONE,
        _unit(number(runtime["median"]), "ms"),
        _unit(number(runtime["p95"]), "ms"),
    ]


def _with_count(ratio: float | None, score: Score) -> str:
    """Write an efficiency, and of how many poses it is if some have no bound."""
    bounded, poses = score["efficiency"]["frames"], score["pooled"]["estimated"]
    return number(ratio) if bounded == poses else f"{number(ratio)} ({bounded} of {poses} poses)"


def published_table(score: Score, published: PublishedCase | None) -> Table:
    """Set mu_N and sigma_N (equations 17 and 18) and centroids beside the paper's."""
    head = ["", "tx", "ty", "tz", "α", "β", "γ", "u", "v"]
    means, spreads = [], []
    if published is not None:
        source = f"{published.source}, {published.runs} runs"
        mean, std = vars(published.mean), vars(published.std)
        means.append([source, *_pose_cells(mean), *_signed(published.centroid_mean_px)])
        spreads.append([source, *_pose_cells(std, False), *_plain(published.centroid_std_px)])
    for variant in reversed(variants_of(score)):
        row = score["pipelines"][variant]
        statistics, centroid = row["paper_statistics"], row["centroid_error_px"]
        runs = statistics["runs"]
        name = f"{TITLES.get(variant, variant)}, {runs} run{'s' if runs > 1 else ''}"
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
        "about x", "about y", "about z", "position / bound", "attitude / bound",
    ]  # fmt: skip
    rows = []
    for row in score["pipelines"][variant]["per_range"]:
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
            ]
        )
    return Table(head, rows, {}, {})


def lost_table(score: Score) -> Table:
    """List why frames have no pose, and which they are."""
    rows = []
    for variant in variants_of(score):
        lost = score["pipelines"][variant]["lost"]
        frames = score["pipelines"][variant]["per_frame"]
        for reason, times in lost["reasons"].items():
            which = [count(row["frame"]) for row in frames if row["reason"] == reason]
            shown = ", ".join(which[:MOST_LISTED]) + (" ..." if len(which) > MOST_LISTED else "")
            rows.append([TITLES.get(variant, variant), count(times), shown, reason])
    return Table(["variant", "frames", "which", "reason"], rows, {}, {})


def _unit(text: str, unit: str) -> str:
    return text if set(text) <= {NONE, ",", " "} else f"{text} {unit}"


def _pair(values: list[float] | None, signed: bool = False) -> str:
    return NONE if values is None else ", ".join(number(value, 3, signed) for value in values)


def _triple(values: list[float] | None) -> str:
    return NONE if values is None else ", ".join(numbers(values))
