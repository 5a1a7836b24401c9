"""Single images of such a target by a chaser that navigates for itself, and what it goes by."""

from __future__ import annotations

from dataclasses import replace

from bench.chains.chain import ScorePart
from bench.chains.tumble_images import CHAIN as TUMBLE
from models.loading import lazily

CHAIN = replace(
    TUMBLE,
    name="navigated_images",
    pipelines=("integrated",),
    parts=(
        *TUMBLE.parts,
        ScorePart("navigation", lazily("bench.scoring.navigated.parts:navigation")),
        ScorePart("integrity", lazily("bench.scoring.navigated.parts:integrity")),
        ScorePart("relative_integrity", lazily("bench.scoring.navigated.parts:relative_integrity")),
    ),
    frame_rows=lazily("bench.scoring.navigated.parts:frame_rows"),
    report=lazily("bench.report.navigated.page:report"),
    scene=lazily("bench.report.navigated.scene:scene"),
    trials=None,
)
