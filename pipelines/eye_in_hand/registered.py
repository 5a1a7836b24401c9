"""The eye-in-hand pipeline, as the bench knows it."""

from __future__ import annotations

from models.frame import IMAGE
from models.onboard import OnboardKnowledge
from pipelines.eye_in_hand.options import VARIANTS, options_for
from pipelines.eye_in_hand.pipeline import EyeInHand
from pipelines.pipeline import RegisteredPipeline
from pipelines.pnp.flight_knowledge import FlightKnowledge

NAME = "eye_in_hand"


def make(onboard: OnboardKnowledge, variant: str) -> EyeInHand:
    """Return the pipeline of one variant; see ``pipelines.eye_in_hand.options``.

    Raises
    ------
    DatasetError
        If the markers or the prior are not on board.
    """
    return EyeInHand(
        FlightKnowledge.of(onboard, NAME),
        options_for(variant),
        board=onboard.wireframe,
        psf_sigma_px=onboard.psf_sigma_px,
        sigmas=onboard.sigmas,
    )


PIPELINE = RegisteredPipeline(
    name=NAME,
    make=make,
    streams=(IMAGE,),
    variants=VARIANTS,
    settings=lambda variant: repr(options_for(variant)),
    label=str,
    in_colour=True,
)
