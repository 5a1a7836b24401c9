"""Single images at poses of a table, for anybody's pipeline: ours need a prior, or an orbit."""

from __future__ import annotations

from bench.chains.chain import Chain, ScorePart
from bench.pictures.stretch import STRETCH
from models.loading import lazily

CHAIN = Chain(
    name="posed_images",
    title="images",
    pipelines=(),
    truths=lazily("bench.scoring.pose_alone:posed_truths"),
    truth=lazily("bench.scoring.pose_alone:read_true_poses"),
    judge=lazily("bench.scoring.pose_alone:judge_run"),
    judge_alone=lazily("bench.scoring.pose_alone:judge_alone"),
    parts=(ScorePart("asked", lazily("bench.scoring.pose_alone:asked")),),
    frame_rows=lazily("bench.scoring.pose_alone:frame_rows"),
    report=lazily("bench.report.pose_alone:report"),
    headline=lazily("bench.report.summary:core_table"),
    picture=lazily("bench.pictures.wireframe_overlay:close_view"),
    show=lazily("bench.pictures.image_show:draw"),
    verdict=lazily("bench.pictures.wireframe_overlay:verdict"),
    legend="the image as taken; green: the wireframe at the estimated pose; cyan: at the true one",
    greys=STRETCH,
    signals=lazily("bench.pictures.wireframe_overlay:signals"),
    layers=lazily("bench.pictures.wireframe_overlay:layers"),
)
