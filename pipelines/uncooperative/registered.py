"""The pipeline for an uncooperative target, as the bench knows it."""

from __future__ import annotations

from models.frame import CHASER_ORBIT, IMAGE
from models.onboard import OnboardKnowledge
from pipelines.pipeline import RegisteredPipeline
from pipelines.uncooperative.knowledge import NAME, UncooperativeKnowledge
from pipelines.uncooperative.options import VARIANTS, options_for
from pipelines.uncooperative.pipeline import Uncooperative


def make(onboard: OnboardKnowledge, variant: str) -> Uncooperative:
    """Return the pipeline of one variant, with no state yet: it acquires the target first.

    Raises
    ------
    DatasetError
        If the wireframe or the expectations are not on board.
    """
    return Uncooperative(UncooperativeKnowledge.of(onboard), options_for(variant))


PIPELINE = RegisteredPipeline(
    name=NAME,
    make=make,
    streams=(IMAGE, CHASER_ORBIT),
    variants=VARIANTS,
    settings=lambda variant: repr(options_for(variant)),
    label=str,
)
