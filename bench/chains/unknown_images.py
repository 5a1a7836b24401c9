"""Single images of a target that nobody has a model of, and a range to its surface."""

from __future__ import annotations

from bench.chains.chain import Chain, ScorePart
from bench.pictures.stretch import STRETCH
from models.loading import lazily

CHAIN = Chain(
    name="unknown_images",
    title="images",
    pipelines=("unknown_target",),
    truths=lazily("bench.scoring.unknown.judged_unknown:true_unknown"),
    truth=lazily("bench.scoring.unknown.judged_unknown:read_true_unknown"),
    judge=lazily("bench.scoring.unknown.judged_unknown:judge_run"),
    parts=(
        ScorePart("motion", lazily("bench.scoring.unknown.parts:motion")),
        ScorePart("shape", lazily("bench.scoring.unknown.parts:shape")),
        ScorePart("surface", lazily("bench.scoring.unknown.surface_score:surface")),
        ScorePart("inertia", lazily("bench.scoring.unknown.parts:inertia")),
        ScorePart("tracks", lazily("bench.scoring.unknown.parts:tracks")),
        ScorePart("asked", lazily("bench.scoring.unknown.parts:asked")),
    ),
    frame_rows=lazily("bench.scoring.unknown.parts:frame_rows"),
    report=lazily("bench.report.unknown.page:report"),
    headline=lazily("bench.report.unknown.tables:headline_table"),
    picture=lazily("bench.pictures.track_picture:overlay"),
    show=lazily("bench.pictures.track_show:draw"),
    verdict=lazily("bench.pictures.track_picture:verdict"),
    legend="green: tracks that are points of the shape; red: tracks that are none, or not yet",
    greys=STRETCH,
    signals=lazily("bench.pictures.wireframe_overlay:signals"),
    layers=lazily("bench.pictures.track_picture:layers"),
    scene=lazily("bench.report.unknown.scene:scene"),
    trials=lazily("bench.estimating.unknown.shape_files:make_shapes"),
)
