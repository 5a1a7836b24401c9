"""The pipeline for an unknown target, as the bench knows it."""

from __future__ import annotations

from models.frame import CHASER_ORBIT, IMAGE
from models.onboard import OnboardKnowledge
from pipelines.option_checks import variant_among
from pipelines.pipeline import RegisteredPipeline
from pipelines.unknown_target.from_images import UnknownFromImages
from pipelines.unknown_target.knowledge import NAME, UnknownTargetKnowledge
from pipelines.unknown_target.options import IMAGE_VARIANTS


def make(onboard: OnboardKnowledge, variant: str) -> UnknownFromImages:
    """Return the pipeline, which has seen nothing yet.

    Raises
    ------
    DatasetError
        If the camera or its mount is not on board.
    ScenarioError
        If no variant has that name.
    """
    options = variant_among(IMAGE_VARIANTS, variant)
    return UnknownFromImages(UnknownTargetKnowledge.of(onboard), options)


PIPELINE = RegisteredPipeline(
    name=NAME,
    make=make,
    streams=(IMAGE, CHASER_ORBIT),
    variants=tuple(IMAGE_VARIANTS),
    settings=lambda variant: f"{variant} {IMAGE_VARIANTS[variant]!r}",
    label=str,
)
