"""Sensors that give numbers and no images: rows of a table, by frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from models.frame import CHASER_ORBIT, TableReading
from models.motion.chaser_navigation import corrupted
from models.motion.relative_state import CHASER_ORBIT_COLUMNS
from renders.world.trajectory import FreeMotion, Trajectory


class TableSensor(Protocol):
    """A sensor whose readings are rows; what it draws is keyed by run and frame."""

    @property
    def name(self) -> str:
        """Of its stream."""
        ...

    @property
    def file(self) -> str:
        """Path of its table in a dataset."""
        ...

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of its numbers, unit at the end."""
        ...

    def reading(self, frame: int, time_s: float, since_s: float, run: int) -> TableReading:
        """Return what it gave up to a frame.

        Parameters
        ----------
        frame : int
        time_s : float, s
            Of the frame.
        since_s : float, s
            Of the frame before, or before which nothing is asked for; what is later is given.
        run : int
        """
        ...

    def along(self, trajectory: Trajectory) -> TableSensor:
        """Return the same sensor on a camera that moves otherwise, where that is of consequence."""
        ...


@dataclass(frozen=True, eq=False)
class ChaserNavigation:
    """The chaser's own navigation: its orbit, once a frame, wrong by its sigmas.

    Attributes
    ----------
    motion : FreeMotion
    seed : int
    sigma_m, sigma_m_s : float, m and m/s
        1-sigma per axis.
    """

    motion: FreeMotion
    seed: int
    sigma_m: float
    sigma_m_s: float
    name: str = CHASER_ORBIT
    file: str = "navigation.csv"
    columns: tuple[str, ...] = CHASER_ORBIT_COLUMNS

    def reading(self, frame: int, time_s: float, since_s: float, run: int) -> TableReading:
        """Return what the chaser believes of its own orbit at a frame, one row.

        Parameters
        ----------
        frame, time_s, run : as for ``TableSensor.reading``
        since_s : float, s
            Of no consequence.
        """
        return corrupted(
            self.motion.chaser_state(time_s),
            seed=self.seed,
            run=run,
            frame=frame,
            sigma_m=self.sigma_m,
            sigma_m_s=self.sigma_m_s,
        ).reading()

    def along(self, trajectory: Trajectory) -> ChaserNavigation:
        """Return itself: a camera that is steered leaves the orbit as it is."""
        return self
