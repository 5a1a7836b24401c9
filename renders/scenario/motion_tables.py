"""The scenario's tables of motion and clock: what moves, what a frame is, and when."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Field, model_validator

from renders.scenario.table import Name, Table, Triple

MotionKind: TypeAlias = Literal["approach", "tumble", "poses"]
Line = Annotated[str, Field(max_length=2000)]


class MotionTable(Table):
    """What moves and its clock; see ``models.motion``.

    ``approach``: that of Opromolla et al. 2022. ``tumble``: ``[tumble]``. ``poses``: a table of
    your own, see ``models.motion.pose_table``.
    """

    kind: MotionKind | None = Field(
        None, description="poses where there is a table, tumble where there is [tumble]"
    )
    start_s: float = Field(0.0, ge=0, le=1e6, description="first frame")
    end_s: float = Field(330.0, ge=0, le=1e6, description="last frame, or just after it")
    rate_hz: float = Field(5.0, ge=1e-6, le=15, description="pose rate; a pair is 33 ms apart")
    pair_gap_ms: float = Field(
        33.0, ge=0.01, le=1e5, description="800 nm exposure before the 850 nm one"
    )
    target_wobble: bool = Field(True, description="attitude motion of the stabilised target")
    ring_in_target_m: Triple | None = Field(
        None, description="the approached ring's centre in the target's frame; its origin"
    )
    file: Name | None = Field(
        None, description="a CSV file of poses beside the scenario; its header names the frames"
    )
    poses: Literal["stills", "interpolated"] | None = Field(
        None, description="each row a frame, which is the default, or a motion through them"
    )
    table: Annotated[tuple[Line, ...], Field(strict=False, max_length=100_001)] | None = Field(
        None, description="the file's lines, as a resolved scenario holds them"
    )
    epoch_utc: Name | None = Field(
        None, description="date and time of motion time 0, such as 2026-03-20T12:00:00Z"
    )

    longitude_deg: float | None = Field(
        None,
        ge=-360,
        le=360,
        description="east, of the geostationary target, with epoch_utc: how it stands among the "
        "stars and under the Sun follows",
    )

    @model_validator(mode="before")
    @classmethod
    def _date_as_text(cls, table: Any) -> Any:
        """Take TOML's own dates, too."""
        if isinstance(table, dict) and isinstance(table.get("epoch_utc"), datetime):
            return {**table, "epoch_utc": table["epoch_utc"].isoformat().replace("+00:00", "Z")}
        return table


class FrameTable(Table):
    """What a frame is."""

    kind: Literal["pairs", "single", "colour"] = Field(
        description="800 and 850 nm, lit by the lamps; or one image, as where no markers are; or "
        "one behind Bayer's filters, of white dots, with a first pose"
    )
