"""Image pairs at 800 and 850 nm of a target with retroreflectors, for the chaser's own camera."""

from __future__ import annotations

from bench.chains.chain import Chain, ScorePart
from bench.pictures.stretch import STRETCH
from models.loading import lazily

CHAIN = Chain(
    name="retroreflector_pairs",
    title="image pairs",
    pipelines=("chaser_fixed",),
    truths=lazily("bench.scoring.pairs.judged_pairs:true_poses"),
    truth=lazily("bench.scoring.pairs.judged_pairs:read_true_dataset"),
    judge=lazily("bench.scoring.pairs.judged_pairs:judge_run"),
    judge_alone=lazily("bench.scoring.pairs.judged_pairs:judge_alone"),
    parts=(
        ScorePart("axes", lazily("bench.scoring.pairs.parts:axes")),
        ScorePart("centroids", lazily("bench.scoring.pairs.parts:centroid_score")),
        ScorePart("detection", lazily("bench.scoring.pairs.parts:detection")),
        ScorePart("paper_statistics", lazily("bench.scoring.pairs.parts:statistics")),
        ScorePart("efficiency", lazily("bench.scoring.pairs.parts:efficiencies")),
        ScorePart("nees", lazily("bench.scoring.pairs.parts:nees")),
        ScorePart("per_range", lazily("bench.scoring.pairs.parts:per_range")),
        ScorePart("asked", lazily("bench.scoring.pairs.parts:asked")),
    ),
    frame_rows=lazily("bench.scoring.pairs.parts:frame_rows"),
    report=lazily("bench.report.pairs.page:report"),
    headline=lazily("bench.report.pairs.tables:headline_table"),
    picture=lazily("bench.pictures.marker_overlay:overlay"),
    show=lazily("bench.pictures.pair_show:draw"),
    verdict=lazily("bench.pictures.marker_overlay:verdict"),
    legend=(
        "red circle: detected (small and dim: matched to no marker); green diamond: reprojected; "
        "cyan ticks: truth"
    ),
    greys=STRETCH,
    signals=lazily("bench.pictures.marker_overlay:signals"),
    layers=lazily("bench.pictures.marker_overlay:layers"),
)
