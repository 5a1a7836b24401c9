"""A Sun that moves: that of each row of a table of poses, or that of the date."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import ClassVar

import numpy as np

from models.arrays import Floats
from models.motion.table_motion import TableMotion
from models.sky.sun_ephemeris import sun_dir_in_inertial
from renders.scenario.scenario import Scenario
from renders.scenario.sun_choice import EPOCH, TABLE, epoch_in
from renders.tracing.light_groups import SunGroup
from renders.world.sky import Turning, sun_group

ANYWHERE = (0.0, 0.0, 1.0)  # of a Sun whose place is asked for at each instant


@dataclass(frozen=True, eq=False)
class WithSunOfTable:
    """A sky whose Sun stands where a table says, and all else where it was.

    Attributes
    ----------
    turning : Turning
    motion : TableMotion
    """

    turning: Turning
    motion: TableMotion
    suns_stand_still: ClassVar[bool] = False

    def sun_in_target(self, direction: tuple[float, float, float], time_s: float) -> list[float]:
        """Return it as the table has it."""
        sun: list[float] = self.motion.sun_dir_in_target(time_s).tolist()
        return sun

    def earth_at(self, time_s: float) -> tuple[Floats, float]:
        """Return the (3,) unit vector to the Earth's centre, target frame, and its distance, km."""
        return self.turning.earth_at(time_s)

    def target_from_icrs(self, time_s: float) -> Floats:
        """Return the (3, 3) rotation of the target among the stars."""
        return self.turning.target_from_icrs(time_s)


@dataclass(frozen=True, eq=False)
class WithSunByDate:
    """A sky whose Sun stands where the date says, and all else where it was.

    Attributes
    ----------
    turning : Turning
        Takes directions in inertial axes, those of the ICRS.
    epoch : datetime
        Of motion time 0.
    """

    turning: Turning
    epoch: datetime
    suns_stand_still: ClassVar[bool] = False

    def sun_in_target(self, direction: tuple[float, float, float], time_s: float) -> list[float]:
        """Return it as the date has it."""
        x, y, z = sun_dir_in_inertial(self.epoch, time_s).tolist()
        return self.turning.sun_in_target((x, y, z), time_s)

    def earth_at(self, time_s: float) -> tuple[Floats, float]:
        """Return the (3,) unit vector to the Earth's centre, target frame, and its distance, km."""
        return self.turning.earth_at(time_s)

    def target_from_icrs(self, time_s: float) -> Floats:
        """Return the (3, 3) rotation of the target among the stars."""
        return self.turning.target_from_icrs(time_s)


@dataclass(frozen=True, eq=False)
class UnderTheStars:
    """A sky over a target of which it is known how it stands among the stars.

    Attributes
    ----------
    turning : Turning
    """

    turning: Turning
    suns_stand_still: ClassVar[bool] = False

    def sun_in_target(self, direction: tuple[float, float, float], time_s: float) -> list[float]:
        """Return it from axes of the ICRS."""
        sun: list[float] = (self.target_from_icrs(time_s) @ np.array(direction)).tolist()
        return sun

    def earth_at(self, time_s: float) -> tuple[Floats, float]:
        """Return the (3,) unit vector to the Earth's centre, target frame, and its distance, km."""
        return self.turning.earth_at(time_s)

    def target_from_icrs(self, time_s: float) -> Floats:
        """Return the (3, 3) rotation of the target among the stars."""
        return self.turning.target_from_icrs(time_s)


def with_its_sun(
    scenario: Scenario, turning: Turning, motion: TableMotion | None = None
) -> tuple[Turning, SunGroup]:
    """Return a scenario's sky and its Sun, whether it stands still or moves.

    Parameters
    ----------
    scenario : Scenario
    turning : Turning
        How the sky turns over the target.
    motion : TableMotion, optional
        Of a table of poses.
    """
    name = scenario.sun.default
    if name == TABLE and motion is not None:
        return WithSunOfTable(turning, motion), SunGroup(f"sun_{TABLE}", ANYWHERE)
    if name == EPOCH:
        if scenario.tumble is None:
            turning = UnderTheStars(turning)
        return WithSunByDate(turning, epoch_in(scenario)), SunGroup(f"sun_{EPOCH}", ANYWHERE)
    return turning, sun_group(name)


def inertial_sun(scenario: Scenario, sun: SunGroup, time_s: float) -> Floats:
    """Return the unit vector towards a Sun in the orbit's inertial axes.

    Parameters
    ----------
    scenario : Scenario
        Whose epoch it is, where the Sun is that of the date.
    sun : SunGroup
    time_s : float, s

    Returns
    -------
    (3,) array
    """
    if sun.name == f"sun_{EPOCH}":
        return sun_dir_in_inertial(epoch_in(scenario), time_s)
    return np.array(sun.direction_in_target)
