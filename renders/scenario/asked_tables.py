"""The tables of a scenario that shape no frame: what counts as wrong, and what is asked for."""

from __future__ import annotations

from pydantic import Field

from renders.scenario.table import Table


class LimitsTable(Table):
    """Beyond which an error is no noise, but a wrong pose; see ``bench.scoring.limits``."""

    wrong_position_m: float = Field(1.0, gt=0, le=1e6, description="m")
    wrong_attitude_deg: float = Field(10.0, gt=0, le=180, description="deg")


class AskedTable(Table):
    """What the case asks of a pipeline; what is left out is not asked."""

    median_position_m: float | None = Field(None, gt=0, le=1e6, description="m, at most")
    median_attitude_deg: float | None = Field(None, gt=0, le=180, description="deg, at most")
    lost_share: float | None = Field(
        None, ge=0, le=1, description="of the frames from the first pose on, at most"
    )
    wrong_in_a_row: int | None = Field(None, ge=0, le=1_000_000, description="frames, at most")
    starts_right: float | None = Field(
        None, ge=0, le=1, description="of the starts without a prior, at least"
    )
    range_share: float | None = Field(
        None, gt=0, le=1, description="of an unknown target: of its distance, at most"
    )
    rate_deg_s: float | None = Field(
        None, gt=0, le=360, description="of an unknown target: deg/s, at most"
    )
    axis_deg: float | None = Field(
        None, gt=0, le=180, description="of an unknown target's spin: deg, at most"
    )
    shape_rms_m: float | None = Field(
        None, gt=0, le=1e6, description="of an unknown target's points to its surface: m, at most"
    )
