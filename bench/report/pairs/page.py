"""What image pairs add to the report."""

from __future__ import annotations

from typing import Any

from bench.report.numbers import number
from bench.report.pairs import figures, tables
from bench.report.pairs.plots import plots
from bench.report.pairs.published import PublishedCase, published_case
from bench.report.parts import (
    Card,
    Figure,
    ReportInput,
    ReportParts,
    Section,
    TitledTable,
)
from bench.report.plot import svg_address
from bench.report.table import length, without_pose
from bench.scoring.score import shown_labels
from models.onboard import needed


def report(given: ReportInput) -> ReportParts:
    """Return the page's parts."""
    return marker_report(given, "image pairs", "ring", "850 nm")


def marker_report(given: ReportInput, frames: str, origin: str, hero_words: str) -> ReportParts:
    """Return the parts of a page on images of markers.

    Parameters
    ----------
    given : ReportInput
    frames : str
        What a frame is, in words.
    origin : str
        Of the target frame.
    hero_words : str
        Of the picture at the top.
    """
    score, rows = given.score, given.headline["per_frame"]
    published = published_case(given.info.target, given.info.sun)
    ranges = [row["range_m"] for row in rows]
    with_pose = [row for row in rows if row["reason"] is None] or rows
    onboard = given.records.onboard
    camera = needed(onboard.camera, "camera.toml", "the report")
    detector = needed(onboard.detector, "detector.toml", "the report")
    return ReportParts(
        lead=(
            f"{given.info.target} under Sun {given.info.sun}, {score['frames']} {frames} of "
            f"{camera.width} × {camera.height}, camera to {origin} {number(max(ranges))} to "
            f"{number(min(ranges))} m"
        ),
        cards=_cards(given.headline),
        hero=with_pose[len(with_pose) // 2]["frame"],
        hero_words=hero_words,
        headline=tables.headline_table(score),
        after=[_beside(given, published), *_over_time(given, published)],
        later=[_by_range(score)],
        shown=given.headline["core"]["lost"]["frames"],
        facts={
            "detector": (
                f"{detector.bits} bits, {detector.gain_e_dn} e/DN, read noise "
                f"{detector.read_noise_e} e, full well {detector.full_well_e:.0f} e"
            )
        },
        plots=plots(score),
    )


def _cards(own: dict[str, Any]) -> list[Card]:
    core, parts = own["core"], own["parts"]
    position, attitude = core["position_error_mm"], core["attitude_error_deg"]
    centroids = parts["centroids"]["run_0"]
    std_px, efficiency = centroids["std"], parts["efficiency"]
    return [
        Card(number(position["median"]), "mm", "position error, median",
             f"95 % below {length(position['p95'])}"),
        Card(number(attitude["median"]), "deg", "attitude error, median",
             f"95 % below {number(attitude['p95'])} deg"),
        Card(number(max(std_px)) if std_px else number(None), "px", "centroid noise, worse axis",
             f"{centroids['count']} centroids"),
        Card(number(efficiency["position"]), "× bound", "position, over Cramér–Rao",
             f"1 is the best there is; {tables.chance_words(efficiency['frames'])}"),
        Card(f"{core['estimated']} of {core['frames']}", "frames", "with a pose",
             f"without: {without_pose(core)}; {core['wrong']['count'] or 'none'} wrong"),
    ]  # fmt: skip


def _beside(given: ReportInput, published: PublishedCase | None) -> Section:
    told = "No paper reports this Sun with this target."
    if published is not None:
        told = f"{published.source}, {published.tables}, Sun {given.info.sun}."
    return Section(
        title="Beside the paper",
        text=f"{told} Position in mm, angles in deg, centroids (u, v) in px.",
        tables=(TitledTable("Beside the paper", tables.published_table(given.score, published)),),
        note=(
            "μ_N and σ_N (equations 17 and 18, the second put right) are statistics of the mean "
            "error over the runs, not of a frame's error: averaging 100 runs of independent noise "
            "makes them ten times smaller, so only rows of as many runs compare. The paper's runs "
            f"carry 1 px (1 σ) of calibration error each; {_calibration(given.scenario)}. "
            "Centroids are of one run in both."
        ),
    )


def _over_time(given: ReportInput, published: PublishedCase | None) -> list[Section]:
    score = given.score
    std_px = None if published is None else published.centroid_std_px
    dotted = " Dotted: the paper's standard deviation." if published is not None else ""
    return [
        Section(
            "Pose error against time",
            figures=(
                Figure(
                    svg_address(figures.pose_error_figure(score)),
                    "Pose error against time, six panels",
                ),
            ),
            note=(
                "Camera axes: x right, y down, z along the boresight. Rotations are the "
                "components of the small turn from true to estimated attitude. Shaded: three "
                "sigma of the covariance that the pipeline states. Dashed: three sigma of the "
                "Cramér–Rao bound for the markers used and the centroid noise measured at that "
                "range. A cross at the foot is a frame without a pose, a triangle at the edge an "
                "error beyond the panel."
            ),
        ),
        Section(
            "Centroid error against time",
            figures=(
                Figure(
                    svg_address(figures.centroid_figure(score, std_px)),
                    "Centroid error against time, per marker",
                ),
            ),
            note=f"Detection minus the marker's projected centre with the true pose.{dotted}",
        ),
        Section(
            "Markers",
            figures=(
                Figure(
                    svg_address(figures.markers_figure(score)), "Number of markers against time"
                ),
            ),
        ),
    ]


def _by_range(score: dict[str, Any]) -> Section:
    return Section(
        "By range",
        tables=tuple(
            TitledTable(label, tables.range_table(score, label), wide=True, heading=True)
            for label in shown_labels(score)
        ),
        note=(
            "All runs together. Bias and standard deviation of the centroids in px; root mean "
            "square position error in mm along, and attitude error in deg about, the camera's "
            "axes; and both over the Cramér–Rao bound. At the bound: where 95 of 100 such ratios "
            "would lie if the pipeline reached it (chi-square, one degree of freedom a pose, as "
            "one axis of the three makes up most of an error)."
        ),
    )


def _calibration(scenario: dict[str, dict[str, Any]]) -> str:
    """Say how far the camera was calibrated wrong."""
    table = scenario.get("calibration")
    if table is None:
        return "what ours carry is not on record"
    focal, centre = table.get("sigma_focal_px"), table.get("sigma_principal_point_px")
    if not isinstance(focal, int | float) or not isinstance(centre, int | float):
        return "what ours carry is not on record"
    told = scenario.get("told")
    if isinstance(told, dict) and told.get("camera"):
        return "ours are off by what the scenario's [told.camera] says"
    if focal == 0.0 and centre == 0.0:
        return "ours are calibrated exactly"
    return f"ours carry {focal:g} px in focal length and {centre:g} px in principal point"
