"""Absolute and relative navigation in one unit, as the bench knows it."""

from __future__ import annotations

from models.frame import IMAGE
from models.navigation_tables import GNSS, INERTIAL, STARS
from models.onboard import OnboardKnowledge
from pipelines.absolute.knowledge import AbsoluteKnowledge
from pipelines.absolute.options import REGIMES
from pipelines.absolute.registered import PIPELINE as ABSOLUTE
from pipelines.absolute.registered import make as make_absolute
from pipelines.integrated.options import relative_options_for
from pipelines.integrated.pipeline import IntegratedNavigation
from pipelines.pipeline import RegisteredPipeline
from pipelines.uncooperative.knowledge import UncooperativeKnowledge
from pipelines.uncooperative.pipeline import Uncooperative
from pipelines.uncooperative.registered import PIPELINE as UNCOOPERATIVE

NAME = "integrated"


def make(onboard: OnboardKnowledge, variant: str) -> IntegratedNavigation:
    """Return the pipeline of one variant: both of its halves are of that variant.

    Raises
    ------
    DatasetError
        If what either half needs is not on board.
    """
    known, own = UncooperativeKnowledge.of(onboard), AbsoluteKnowledge.of(onboard)
    return IntegratedNavigation(
        make_absolute(onboard, variant),
        Uncooperative(known, relative_options_for(variant, own.regime)),
        known.cam_from_lvlh,
        own.relative_from_s,
    )


def _settings(variant: str) -> str:
    relative = [relative_options_for(variant, regime) for regime in REGIMES]
    return f"{ABSOLUTE.settings_hash(variant)} {relative!r}"


PIPELINE = RegisteredPipeline(
    name=NAME,
    make=make,
    streams=(IMAGE, GNSS, INERTIAL, STARS),
    variants=UNCOOPERATIVE.variants,
    settings=_settings,
    label=str,
)
