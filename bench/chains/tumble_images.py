"""Single images of a known target that turns freely and carries no markers."""

from __future__ import annotations

from bench.chains.chain import Chain, ScorePart
from bench.pictures.stretch import STRETCH
from models.loading import lazily

CHAIN = Chain(
    name="tumble_images",
    title="images",
    pipelines=("uncooperative",),
    truths=lazily("bench.scoring.tumble.judged_images:true_images"),
    truth=lazily("bench.scoring.tumble.judged_images:read_true_images"),
    judge=lazily("bench.scoring.tumble.judged_images:judge_run"),
    judge_alone=lazily("bench.scoring.tumble.judged_images:judge_alone"),
    parts=(
        ScorePart("state", lazily("bench.scoring.tumble.parts:state")),
        ScorePart("corners", lazily("bench.scoring.tumble.parts:corners")),
        ScorePart("starts", lazily("bench.scoring.tumble.parts:starts")),
        ScorePart("limits", lazily("bench.scoring.tumble.parts:limits")),
        ScorePart("asked", lazily("bench.scoring.tumble.parts:asked")),
    ),
    frame_rows=lazily("bench.scoring.tumble.parts:frame_rows"),
    report=lazily("bench.report.tumble.page:report"),
    headline=lazily("bench.report.tumble.tables:headline_table"),
    picture=lazily("bench.pictures.wireframe_overlay:close_view"),
    show=lazily("bench.pictures.image_show:draw"),
    verdict=lazily("bench.pictures.wireframe_overlay:verdict"),
    legend=(
        "green: the wireframe at the estimated pose; cyan: at the true one, where they differ; "
        "red circle: detected corner (dim: matched to no landmark)"
    ),
    greys=STRETCH,
    signals=lazily("bench.pictures.wireframe_overlay:signals"),
    layers=lazily("bench.pictures.wireframe_overlay:layers"),
    trials=lazily("bench.estimating.tumble.starts:try_starts"),
)
