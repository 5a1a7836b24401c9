"""Which star frames the suite looks at: attitudes without a prior, as units of work."""

from __future__ import annotations

import hashlib
from functools import cache

from bench.suites.units import WorkUnit
from bench.suites.vinag2018.star_survey import SKIES, SurveyTask, survey
from models.sensors.star_camera import star_camera
from models.sky import hipparcos
from pipelines.star_attitude.options import StarAttitudeOptions

PIXELS = 1024
BATCH = 50  # attitudes of one unit
FRAME_S = 0.4  # of one core of 2025, of a frame


def survey_units(sky: str, attitudes: int, seed: int) -> list[WorkUnit]:
    """Return the units of a sky's attitudes.

    Parameters
    ----------
    sky : str
        Among ``SKIES``.
    attitudes, seed : int
        Of a sky whose share is one.
    """
    units = []
    attitudes = max(round(SKIES[sky].share * attitudes), 1)
    for first in range(0, attitudes, BATCH):
        count = min(BATCH, attitudes - first)
        units.append(
            WorkUnit(
                name=f"stars/sky_{list(SKIES).index(sky)}/{first:05d}_{count:03d}",
                work=survey,
                task=SurveyTask(SKIES[sky], first, count, seed, PIXELS, star_options_text()),
                kind="star frames",
                expected_s=FRAME_S * count,
            )
        )
    return units


@cache
def star_options_text() -> str:
    """Return all that shapes star images beside code: settings, and a hash of the catalogue."""
    table = hashlib.sha256(hipparcos.TABLE.read_bytes()).hexdigest()[:16]
    return f"{star_camera(PIXELS)!r} {StarAttitudeOptions()!r} {table}"
