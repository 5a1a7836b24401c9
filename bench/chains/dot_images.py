"""Single colour images of white dots on black, for the camera at an arm's end.

Judged as image pairs are, markers and all, with the second pose that fits told beside.
"""

from __future__ import annotations

from dataclasses import replace

from bench.chains.chain import ScorePart
from bench.chains.retroreflector_pairs import CHAIN as PAIRS
from models.loading import lazily

*MARKER_PARTS, ASKED = PAIRS.parts
CHAIN = replace(
    PAIRS,
    name="dot_images",
    title="colour images",
    pipelines=("eye_in_hand",),
    parts=(*MARKER_PARTS, ScorePart("rivals", lazily("bench.scoring.dots.rivals:rivals")), ASKED),
    report=lazily("bench.report.dots.page:report"),
    picture=lazily("bench.pictures.dot_picture:overlay"),
    signals=lazily("bench.pictures.dot_picture:signals"),
    show=lazily("bench.pictures.dot_picture:draw"),
)
