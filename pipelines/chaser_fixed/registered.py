"""The chaser-fixed pipeline, as the bench knows it."""

from __future__ import annotations

from dataclasses import replace

from models.frame import IMAGE_800, IMAGE_850
from models.onboard import OnboardKnowledge
from pipelines.chaser_fixed.options import VARIANTS, options_for
from pipelines.chaser_fixed.pipeline import ChaserFixed
from pipelines.pipeline import RegisteredPipeline
from pipelines.pnp.flight_knowledge import FlightKnowledge

NAME = "chaser_fixed"


def make(onboard: OnboardKnowledge, variant: str) -> ChaserFixed:
    """Return the pipeline of one variant; see ``pipelines.chaser_fixed.options``.

    Raises
    ------
    DatasetError
        If the markers or the prior are not on board.
    """
    options = options_for(variant)
    if onboard.psf_sigma_px is not None:
        options = replace(options, psf_sigma_px=onboard.psf_sigma_px)
    return ChaserFixed(FlightKnowledge.of(onboard, NAME), options, onboard.sigmas)


PIPELINE = RegisteredPipeline(
    name=NAME,
    make=make,
    streams=(IMAGE_800, IMAGE_850),
    variants=VARIANTS,
    settings=lambda variant: repr(options_for(variant)),
    label=str,
)
