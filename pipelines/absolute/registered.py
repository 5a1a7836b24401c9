"""Absolute navigation, as the bench knows it."""

from __future__ import annotations

from models.navigation_tables import GNSS, INERTIAL, STARS
from models.onboard import OnboardKnowledge
from pipelines.absolute.knowledge import NAME, AbsoluteKnowledge
from pipelines.absolute.options import REGIMES, VARIANTS, absolute_options_for
from pipelines.absolute.pipeline import AbsoluteNavigation
from pipelines.pipeline import RegisteredPipeline


def make(onboard: OnboardKnowledge, variant: str) -> AbsoluteNavigation:
    """Return the pipeline of one variant, at its start.

    Raises
    ------
    DatasetError
        If its start is not on board.
    """
    knowledge = AbsoluteKnowledge.of(onboard)
    options = absolute_options_for(variant, knowledge.regime, knowledge.lasting)
    return AbsoluteNavigation(knowledge, options)


def _settings(variant: str) -> str:
    return repr(
        [absolute_options_for(variant, regime, lasting) for regime in REGIMES
         for lasting in (False, True)]
    )  # fmt: skip


PIPELINE = RegisteredPipeline(
    name=NAME,
    make=make,
    streams=(GNSS, INERTIAL, STARS),
    variants=VARIANTS,
    settings=_settings,
    label=str,
)
