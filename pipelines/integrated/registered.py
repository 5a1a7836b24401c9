"""Absolute and relative navigation in one unit, as the bench knows it."""

from __future__ import annotations

from models.frame import IMAGE
from models.navigation_tables import GNSS, INERTIAL, STARS
from models.onboard import OnboardKnowledge
from pipelines.absolute.registered import PIPELINE as ABSOLUTE
from pipelines.absolute.registered import make as make_absolute
from pipelines.integrated.pipeline import IntegratedNavigation
from pipelines.pipeline import RegisteredPipeline
from pipelines.uncooperative.knowledge import UncooperativeKnowledge
from pipelines.uncooperative.registered import PIPELINE as UNCOOPERATIVE
from pipelines.uncooperative.registered import make as make_uncooperative

NAME = "integrated"


def make(onboard: OnboardKnowledge, variant: str) -> IntegratedNavigation:
    """Return the pipeline of one variant: both of its halves are of that variant.

    Raises
    ------
    DatasetError
        If what either half needs is not on board.
    """
    return IntegratedNavigation(
        make_absolute(onboard, variant),
        make_uncooperative(onboard, variant),
        UncooperativeKnowledge.of(onboard).cam_from_lvlh,
    )


def _settings(variant: str) -> str:
    return " ".join(each.settings_hash(variant) for each in (ABSOLUTE, UNCOOPERATIVE))


PIPELINE = RegisteredPipeline(
    name=NAME,
    make=make,
    streams=(IMAGE, GNSS, INERTIAL, STARS),
    variants=UNCOOPERATIVE.variants,
    settings=_settings,
    label=str,
)
