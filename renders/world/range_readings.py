"""The stream of a range finder along the boresight: what it meets, with noise and wrong echoes."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from models.frame import RANGE, TableReading
from models.sensors.range_finder import RANGE_COLUMNS, RangeFinder
from renders.truth.range_truth import Beam, RangeTruth
from renders.world.bodies import Bodies
from renders.world.trajectory import Trajectory

RANGE_DRAW = 0x0A4E  # purpose that keys a frame's random numbers


@dataclass(frozen=True, eq=False)
class RangeReadings:
    """What a range finder reads, at most once a frame.

    Attributes
    ----------
    finder : RangeFinder
    bodies : Bodies
        Whose target the beam is to meet.
    trajectory : Trajectory
    frame_rate_hz : float, Hz
    seed : int
    footprint_rad : float, rad
        Half the beam's full angle.
    """

    finder: RangeFinder
    bodies: Bodies
    trajectory: Trajectory
    frame_rate_hz: float
    seed: int
    footprint_rad: float = 0.0
    name: str = RANGE
    file: str = "range.csv"
    columns: tuple[str, ...] = RANGE_COLUMNS
    _known: dict[float, RangeTruth] = field(default_factory=dict, init=False)

    def truth(self, time_s: float) -> RangeTruth:
        """Return what the beam meets at an instant, and how far the centre of mass is."""
        if time_s not in self._known:
            self._known[time_s] = self._beam.meets(self.trajectory.cam_from_target(time_s))
        return self._known[time_s]

    def reading(self, frame: int, time_s: float, since_s: float, run: int) -> TableReading:
        """Return what is read at a frame: one row, or none.

        Parameters
        ----------
        frame, time_s, run : as for ``TableSensor.reading``
        since_s : float, s
            Of no consequence.
        """
        read = None
        if self.finder.due(frame, self.frame_rate_hz):
            draw = np.random.default_rng([self.seed, run, RANGE_DRAW, frame])
            read = self.finder.reading(self.truth(time_s).surface_m, draw)
        rows = np.array([] if read is None else [[read, self.finder.sigma_m]])
        times_s = np.array([] if read is None else [time_s], dtype=np.float64)
        return TableReading(self.columns, times_s, rows.reshape(-1, len(self.columns)))

    def along(self, trajectory: Trajectory) -> RangeReadings:
        """Return the same of a camera that moves otherwise."""
        return replace(self, trajectory=trajectory)

    @cached_property
    def _beam(self) -> Beam:
        return Beam(self.bodies.target, self.footprint_rad)
