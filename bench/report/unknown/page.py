"""What images of an unknown target add to the report."""

from __future__ import annotations

from typing import Any

import numpy as np

from bench.estimating.runs import read_run
from bench.pictures.track_picture import with_trails
from bench.report.filmstrip import jpeg
from bench.report.numbers import number, share
from bench.report.parts import Card, Figure, ReportInput, ReportParts, Section
from bench.report.plot import svg_address
from bench.report.table import length
from bench.report.unknown import figures, tables
from bench.report.unknown.plots import plots
from bench.report.unknown.surface_figure import surface_figure
from bench.scoring.target_shape import spread_points, target_shape
from bench.scoring.unknown.cloud import Surface
from bench.scoring.unknown.judged_unknown import judge_run, read_true_unknown
from bench.scoring.unknown.parts import last_cloud
from bench.scoring.unknown.surface_score import surface_in_true

TRAIL_FRAMES = 12
PICTURE_PX = 1000
SURFACE_POINTS = 40_000


def report(given: ReportInput) -> ReportParts:
    """Return the page's parts."""
    rows = given.headline["per_frame"]
    camera = given.records.onboard.camera
    size = "" if camera is None else f" of {camera.width} × {camera.height}"
    hero = max(rows, key=lambda row: row["used"])["frame"]
    return ReportParts(
        lead=f"{given.info.target}, {len(rows)} images{size}; no model, no prior pose, own tracks",
        cards=_cards(given.headline),
        hero=hero,
        hero_words="the frame that shows most points of the shape",
        headline=tables.headline_table(given.score),
        after=[_errors(given), _shape(given), _tracks(given, hero)],
        shown=[row["frame"] for row in rows if row["wrong"]],
        plots=plots(given.score),
    )


def _cards(own: dict[str, Any]) -> list[Card]:
    motion, cloud = own["parts"]["motion"], own["parts"]["shape"] or {}
    rms, median = cloud.get("rms_m"), cloud.get("median_m")
    return [
        Card(share(motion["range_share"]["median"]), "", "distance error, median",
             f"95 % below {share(motion['range_share']['p95'])}"),
        Card(number(motion["rate_deg_s"]["median"]), "deg/s", "rate error, median",
             f"95 % below {number(motion['rate_deg_s']['p95'])} deg/s"),
        Card(number(motion["axis_deg"]["median"]), "deg", "spin axis error, median",
             f"95 % below {number(motion['axis_deg']['p95'])} deg"),
        Card(str(cloud.get("points", 0)), "points", "of the shape",
             "no surface to hold them against")
        if rms is None else
        Card(length(1e3 * rms), "", "points to the surface, rms",
             f"median {length(None if median is None else 1e3 * median)}, "
             f"{cloud['points']} points"),
    ]  # fmt: skip


def _errors(given: ReportInput) -> Section:
    return Section(
        "Errors over time",
        text="After the one constant turn that brings the pipeline's axes onto the true ones.",
        figures=(Figure(svg_address(figures.error_figure(given.score)), "Errors against time"),),
    )


def _shape(given: ReportInput) -> Section:
    dataset = given.records.dataset
    shape = target_shape(dataset)
    truth = read_true_unknown(dataset)
    judged = judge_run(read_run(dataset, 0, given.label), truth)
    cloud = last_cloud(judged)
    if shape is None or cloud is None or not len(cloud[0]):
        return Section("Shape", text="No point of it was found.")
    points, triangles = cloud[0], shape.vertices[shape.faces]
    away = Surface(triangles).distances(points)
    drawn = figures.cloud_figure(points, away, spread_points(triangles, SURFACE_POINTS))
    told = [Figure(svg_address(drawn), "The cloud over the mesh, three views")]
    own = surface_in_true(judged, truth, given.label)
    text = "The points at the end over the mesh that was rendered, in grey, along its axes."
    if own is not None:
        both = surface_figure(own, triangles)
        told.append(Figure(svg_address(both), "The carved surface and the true one, three views"))
        text += " Below, what the silhouettes leave of space, and the true surface."
    return Section("Shape", text=text, figures=tuple(told))


def _tracks(given: ReportInput, hero: int) -> Section:
    records = given.records
    indices = records.dataset.indices
    place = indices.index(hero)
    before = [records.record(index) for index in indices[max(0, place - TRAIL_FRAMES) : place]]
    drawn = np.asarray(with_trails(records.record(hero), before, PICTURE_PX))
    return Section(
        "Tracks",
        figures=(
            Figure(jpeg(drawn), "A frame with its tracks",
                   f"Frame {hero}, with where its tracks were in the {len(before)} before it."),
            Figure(svg_address(figures.track_figure(given.score, given.label)),
                   "Tracks in each image"),
        ),
    )  # fmt: skip
