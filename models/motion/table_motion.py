"""Motions that a table of poses gives: from still to still, or smoothly between its rows.

Stills are poses that need have nothing to do with one another. A smooth motion runs through every
row: the place on a cubic spline, the attitude at a constant rate from row to row (slerp), the Sun
on the great circle.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Protocol

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, Slerp

from models.arrays import Floats, Indices
from models.errors import ScenarioError
from models.motion.pose_table import ROUNDING_S, PoseTable
from models.pose import RigidTransform

LARGEST_TURN_DEG = 120.0  # between rows: nearer to half a turn, the way round is a guess


class TableMotion(Protocol):
    """A motion of a table's."""

    @property
    def table(self) -> PoseTable:
        """The poses, and what else is known of their times."""
        ...

    def cam_from_target(self, time_s: float, /) -> RigidTransform:
        """Return the pose at a time."""
        ...

    def sun_dir_in_target(self, time_s: float, /) -> Floats:
        """Return the unit vector towards the Sun at a time, (3,)."""
        ...

    def exposure_ms(self, time_s: float, /) -> float:
        """Return the exposure time of a frame at a time, ms."""
        ...


@dataclass(frozen=True, eq=False)
class Stills:
    """Each row is one frame, and lasts as long as the shutter is open for it.

    Attributes
    ----------
    table : PoseTable
    lead_s : float, s
        From the earliest exposure of a frame to its time: all are at the pose of their row.
    """

    table: PoseTable
    lead_s: float = 0.0

    def row(self, time_s: float) -> int:
        """Return the number of the row at a time; one changes to the next midway."""
        return int(np.searchsorted(self._ends_s, time_s))

    def cam_from_target(self, time_s: float) -> RigidTransform:
        """Return the pose of the row at a time."""
        return self.table.poses[self.row(time_s)]

    def sun_dir_in_target(self, time_s: float) -> Floats:
        """Return the unit vector towards the Sun of the row at a time, (3,)."""
        return _given(self.table.sun_dirs_in_target, "a Sun")[self.row(time_s)]

    def exposure_ms(self, time_s: float) -> float:
        """Return the exposure time of the row at a time, ms."""
        return float(_given(self.table.exposures_ms, "an exposure_ms")[self.row(time_s)])

    def first_row(self, time_s: float) -> int:
        """Return the first of the rows up to that at a time which are at its pose without a break.

        Light of one pose under several Suns is traced together.
        """
        return int(self._first_rows[self.row(time_s)])

    def earth_dir_in_target(self, time_s: float) -> Floats | None:
        """Return the unit vector towards the Earth of the row at a time, (3,).

        It is zero where the row has no Earth, and None where the table does not say.
        """
        towards = self.table.earth_dirs_in_target
        return None if towards is None else towards[self.row(time_s)]

    def shows_stars(self, time_s: float) -> bool:
        """Tell whether stars are seen in the row at a time: everywhere unless the table says."""
        return self.table.stars is None or bool(self.table.stars[self.row(time_s)])

    @cached_property
    def _first_rows(self) -> Indices:
        same = [
            np.array_equal(one.matrix(), other.matrix())
            for one, other in pairwise(self.table.poses)
        ]
        numbers = np.arange(len(self.table))
        return np.maximum.accumulate(np.where([False, *same], 0, numbers))

    @cached_property
    def _ends_s(self) -> Floats:
        """Midway from each row's time to the earliest exposure of the next."""
        return 0.5 * (self.table.times_s[:-1] + self.table.times_s[1:] - self.lead_s)


@dataclass(frozen=True, eq=False)
class SmoothMotion:
    """The motion through every row.

    Attributes
    ----------
    table : PoseTable
        Of two rows or more, no two neighbours more than 120 deg apart.
    overtime_s : float, s
        How long before the first row and after the last it goes on as it was: the earlier exposure
        of a first pair lies there, and a shutter may be open over an end.

    Raises
    ------
    ScenarioError
        If the table has one row, or neighbours too far apart.
    """

    table: PoseTable
    overtime_s: float = 0.0

    def __post_init__(self) -> None:
        if len(self.table) < 2:
            raise ScenarioError(
                "expected two rows or more to interpolate between, got one; "
                'motion.poses = "stills" takes it as it is'
            )
        turns_deg = np.rad2deg((self._attitudes[1:] * self._attitudes[:-1].inv()).magnitude())
        widest = int(np.argmax(turns_deg))
        if turns_deg[widest] > LARGEST_TURN_DEG:
            raise ScenarioError(
                f"expected at most {LARGEST_TURN_DEG:g} deg of turn from one row of poses to the "
                f"next to interpolate between, got {turns_deg[widest]:.4g} deg from "
                f"{self.table.times_s[widest]:g} to {self.table.times_s[widest + 1]:g} s; give "
                'rows closer in time, or motion.poses = "stills"'
            )

    def cam_from_target(self, time_s: float) -> RigidTransform:
        """Return the pose at a time.

        Raises
        ------
        ScenarioError
            If the time is beyond the table.
        """
        time_s = self._within(time_s)
        return RigidTransform(self._turn(time_s).as_matrix(), self._place(time_s))

    def sun_dir_in_target(self, time_s: float) -> Floats:
        """Return the unit vector towards the Sun at a time, (3,)."""
        suns = _given(self.table.sun_dirs_in_target, "a Sun")
        first, share = self._between(self._within(time_s))
        start, end = suns[first], suns[first + 1]
        angle = float(np.arctan2(np.linalg.norm(np.cross(start, end)), start @ end))
        if np.sin(angle) < 1e-9:
            return start if share < 0.5 else end
        mixed = np.sin((1.0 - share) * angle) * start + np.sin(share * angle) * end
        return np.asarray(mixed / np.linalg.norm(mixed))

    def exposure_ms(self, time_s: float) -> float:
        """Return the exposure time at a time, ms: between two rows in proportion."""
        exposures_ms = _given(self.table.exposures_ms, "an exposure_ms")
        return float(np.interp(time_s, self.table.times_s, exposures_ms))

    def _within(self, time_s: float) -> float:
        first, last = float(self.table.times_s[0]), float(self.table.times_s[-1])
        reach = self.overtime_s + ROUNDING_S
        if not first - reach <= time_s <= last + reach:
            raise ScenarioError(
                f"expected a time within the table of poses, {first:g} to {last:g} s, got "
                f"{time_s:g} s: change motion.start_s or motion.end_s, or --span-s"
            )
        return time_s

    def _between(self, time_s: float) -> tuple[int, float]:
        """Return the row before a time, and the share of the way to the next."""
        times_s = self.table.times_s
        first = int(np.clip(np.searchsorted(times_s, time_s, "right") - 1, 0, len(times_s) - 2))
        return first, float((time_s - times_s[first]) / (times_s[first + 1] - times_s[first]))

    @cached_property
    def _attitudes(self) -> Rotation:
        return Rotation.from_matrix(np.stack([pose.rotation for pose in self.table.poses]))

    @cached_property
    def _slerp(self) -> Slerp:
        return Slerp(self.table.times_s, self._attitudes)

    def _turn(self, time_s: float) -> Rotation:
        """Return the attitude; beyond an end it turns on as in the interval there."""
        first, share = self._between(time_s)
        if 0.0 <= share <= 1.0:
            return self._slerp(time_s)
        start, end = self._attitudes[first], self._attitudes[first + 1]
        return Rotation.from_rotvec(share * (end * start.inv()).as_rotvec()) * start

    @cached_property
    def _place(self) -> CubicSpline:
        return CubicSpline(
            self.table.times_s, np.stack([pose.translation for pose in self.table.poses])
        )


def _given(column: Floats | None, what: str) -> Floats:
    if column is None:
        raise ScenarioError(f"expected a table of poses with {what} in each row, got one without")
    return column
