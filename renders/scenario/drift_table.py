"""The scenario's table of what has drifted since calibration, of which no pipeline is told more."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from renders.scenario.table import Table

Share = Annotated[float, Field(ge=0, le=0.5)]


class DriftTable(Table):
    """How lamps and lens differ in every run from what they were: 1-sigmas of draws, shares.

    What is told is as it was; see ``renders.detector.drift``.
    """

    lamp_power: Share = Field(0.0, description="of each ring of lamps, of its power")
    lamp_tilt: Share = Field(
        0.0, description="of the lamps' light, from the middle of the image to its edge, each axis"
    )
    vignetting: Share = Field(0.0, description="of all light in the image's corners")
    blur: Share = Field(0.0, description="of the point spread's width")
    blur_over_field: Share = Field(
        0.0, description="of the point spread's width in the corners over that in the middle"
    )
