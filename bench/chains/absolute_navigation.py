"""GNSS, gyroscopes and stars of a satellite that navigates for itself: tables, and no image."""

from __future__ import annotations

from bench.chains.chain import Chain, ScorePart
from models.loading import lazily

CHAIN = Chain(
    name="absolute_navigation",
    title="instants",
    pipelines=("absolute",),
    truths=lazily("bench.scoring.flights.judged_instants:true_instants"),
    truth=lazily("bench.scoring.flights.judged_instants:read_true_instants"),
    judge=lazily("bench.scoring.flights.judged_instants:judge_run"),
    parts=(
        ScorePart("navigation", lazily("bench.scoring.flights.parts:navigation")),
        ScorePart("integrity", lazily("bench.scoring.flights.parts:integrity")),
    ),
    frame_rows=lazily("bench.scoring.flights.parts:frame_rows"),
    report=lazily("bench.report.flights.page:report"),
    headline=lazily("bench.report.summary:core_table"),
    picture=lazily("bench.report.flights.page:no_picture"),
    show=lazily("bench.report.flights.page:no_picture"),
    verdict=lazily("bench.report.flights.page:verdict"),
    legend="",
    scene=lazily("bench.report.flights.scene:scene"),
)
