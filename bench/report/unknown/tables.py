"""The tables of an unknown target, as rows of text made from its ``score.json``."""

from __future__ import annotations

from typing import Any

from bench.report.numbers import NONE, count, number, share
from bench.report.table import (
    CORE_TERMS,
    TIME_TERMS,
    Table,
    Term,
    core_cells,
    headline,
    length,
    time_cells,
    with_unit,
)
from bench.scoring.score import shown_labels

Score = dict[str, Any]

TERMS = (
    *CORE_TERMS,
    Term(
        "distance error, median",
        "Size of the relative error of the distance to the centre of mass; like the three below "
        "over the second half of the frames.",
        "motion, second half",
    ),
    Term("velocity error, median", "Of the relative velocity, in the local frame."),
    Term("rate error, median", "Of the inertial rate, after the one turn of the axes."),
    Term("spin axis error, median", "Angle between the rates."),
    Term("inertia", "Largest error of an entry at the end, in percent of the trace.", "at the end"),
    Term("points", "Of the shape, at the end."),
    Term("points to surface, rms", "Distance of the points to the mesh that was rendered."),
    Term("points to surface, median", "Half of the points are nearer."),
    Term("nearest nine tenths, rms", "The same without the tenth that is farthest."),
    Term("sigma stated, median", "What the pipeline says of its points."),
    Term("seen surface within 5 cm", "Share of what images showed that has a point so near."),
    Term("seen surface within 50 cm", "The same: how evenly the points lie."),
    Term(
        "surface to surface, rms",
        "Distance of the surface that silhouettes carve to the true one.",
        "surface",
    ),
    Term("surface to surface, median", "Half of it is nearer."),
    Term("of the seen surface within 5 cm of it", "Share of what images showed."),
    Term(
        "F-score",
        "Harmonic mean of the shares of either surface that lie within one hundredth "
        "of the target's size of the other; of the true one, what was seen.",
    ),
    Term("chamfer distance", "Mean of the mean distances either way."),
    Term(
        "principal axes",
        "Angles between the axes of inertia and the true ones, from the "
        "smallest moment to the largest.",
        "inertia",
    ),
    Term("principal moments", "Their errors, both of trace 1."),
    Term("tracks", "In all; in brackets the median number of images of one.", "tracks"),
    Term("an image", "Mean number of tracks, and of those that are points of the shape."),
    *TIME_TERMS,
)


def headline_table(score: Score) -> Table:
    """Compare the pipelines on the same images."""
    columns = {label: _column(score["pipelines"][label]) for label in shown_labels(score)}
    return headline(score, TERMS, columns)


def _column(own: dict[str, Any]) -> list[str]:
    motion, cloud, tracks = (own["parts"][name] for name in ("motion", "shape", "tracks"))
    cloud = cloud or {}

    def metres(name: str) -> str:
        value = cloud.get(name)
        return length(None if value is None else 1e3 * value)

    velocity = motion["velocity_m_s"]["median"]
    middle = tracks["lengths"][1] if tracks["lengths"] else 0
    return [
        *core_cells(own["core"]),
        share(motion["range_share"]["median"]),
        with_unit(None if velocity is None else 1e3 * velocity, "mm/s"),
        with_unit(motion["rate_deg_s"]["median"], "deg/s"),
        with_unit(motion["axis_deg"]["median"], "deg"),
        with_unit(motion["inertia_percent"], "%"),
        count(cloud["points"]) if cloud else NONE,
        *(metres(name) for name in ("rms_m", "median_m", "inlier_rms_m", "sigma_m")),
        share(cloud.get("completeness_5cm")),
        share(cloud.get("completeness_50cm")),
        *_surface_cells(own["parts"].get("surface") or {}),
        *_inertia_cells(own["parts"].get("inertia") or {}),
        f"{tracks['tracks']} ({middle})",
        f"{number(tracks['live'])}, {number(tracks['used'])}",
        *time_cells(own["core"]),
    ]


def _surface_cells(surface: dict[str, Any]) -> list[str]:
    def metres(name: str) -> str:
        value = surface.get(name)
        return length(None if value is None else 1e3 * value)

    score = surface.get("f_score")
    return [
        metres("accuracy_rms_m"),
        metres("accuracy_median_m"),
        share(surface.get("completeness_5cm")),
        NONE if score is None else f"{score:.2f} at {metres('within_m')}",
        metres("chamfer_m"),
    ]


def _inertia_cells(inertia: dict[str, Any]) -> list[str]:
    return [
        ", ".join(number(each) for each in inertia[name]) + f" {unit}" if inertia else NONE
        for name, unit in (("axes_deg", "deg"), ("moments_percent", "%"))
    ]
