"""What the chaser's own sensors give: GNSS, gyroscopes and stars, as streams between images."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from models.arrays import Floats
from models.frame import TableReading
from models.gnss.constellation import gps_and_galileo
from models.gnss.link_budget import LinkBudget, ReceiveAntenna
from models.gnss.range_errors import RangeErrors
from models.gnss.receiver_clock import ReceiverClock
from models.gnss.reception import Receiver
from models.gnss.tracking_noise import TrackingLoops
from models.motion.perturbed_tumble import LocalFrameAttitude, PerturbedTumble
from models.navigation_tables import COLUMNS, table_of
from models.quaternions import from_rotation_vector, multiplied
from models.sensors.inertial_unit import InertialUnit
from models.sensors.star_sensor import StarSensor
from renders.flight.faults import Faults
from renders.flight.flight import Flight
from renders.flight.sensing import Sensors, sensed
from renders.flight.true_motion import RealMotion
from renders.scenario.navigation_tables import NavigationTable
from renders.world.trajectory import Trajectory

ABSOLUTE_FILE = "absolute.toml"
START_DRAW = 0x57A27  # purpose, that sets these draws apart from the sensors'
ROUNDING_S = 1e-9  # of a time that was counted in frames
LOSSES_DB = 2.3
# Antennas look away from the Earth in a low orbit and towards it in a high one; the body's x axis
# points away. Sensitivities and the ionosphere are VINAG 2018's, section 5.1.
REGIMES = {
    "leo": (3.0, 90.0, (1.0, 0.0, 0.0), 35.0, 10.0),
    "geo": (6.0, 60.0, (-1.0, 0.0, 0.0), 28.0, 0.0),
}


@dataclass(frozen=True, eq=False)
class SensorsAboard:
    """The chaser's sensors along its orbit; its body keeps to the local frame.

    Attributes
    ----------
    motion : PerturbedTumble
    table : NavigationTable
    epoch : str
        Of time zero, as typed.
    seed : int
    """

    motion: PerturbedTumble
    table: NavigationTable
    epoch: str
    seed: int
    _rows: dict[int, dict[str, tuple[Floats, Floats]]] = field(default_factory=dict, init=False)

    @property
    def flight(self) -> Flight:
        """The flight as it really is."""
        gain, edge_deg, boresight, sensitivity, _ = REGIMES[self.table.regime]
        typed = self.table.receive_gain_dbi
        antenna = ReceiveAntenna(gain if typed is None else typed, edge_deg, 0.0, boresight)
        return Flight(
            self.motion.chaser.epoch,
            self.motion.chaser,
            LocalFrameAttitude(self.motion.chaser),
            self.motion.duration_s,
            Receiver(antenna, sensitivity, link=LinkBudget(losses_db=LOSSES_DB)),
            gps_and_galileo(),
        )

    def rows(self, run: int) -> dict[str, tuple[Floats, Floats]]:
        """Return all that a run's sensors give: times (n,) in s and rows, by stream."""
        if run not in self._rows:
            times: dict[str, list[Floats]] = {name: [np.zeros(0)] for name in COLUMNS}
            rows = {name: [np.zeros((0, len(columns)))] for name, columns in COLUMNS.items()}
            flight = self.flight
            for record, _ in sensed(flight, self._sensors, RealMotion(flight), self.seed, (run,)):
                if record is not None:
                    stream, reading = table_of(record)
                    times[stream].append(reading.time_s)
                    rows[stream].append(reading.rows)
            self._rows[run] = {
                name: (np.concatenate(times[name]), np.concatenate(rows[name])) for name in COLUMNS
            }
        return self._rows[run]

    def tables(self, run: int) -> dict[str, dict[str, Any]]:
        """Return where a run's filter starts, by the name of its file."""
        table, zero = self.table, np.zeros(1)
        draw = np.random.default_rng([self.seed, run, START_DRAW]).standard_normal(9)
        first = self.motion.chaser.states(zero)[0]
        turn = from_rotation_vector(np.deg2rad(table.start_sigma_deg) * draw[6:])
        attitude = LocalFrameAttitude(self.motion.chaser).quaternions(zero)[0]
        start: dict[str, Any] = {
            "regime": table.regime,
            "epoch": self.epoch,
            "position_m": (first[:3] + table.start_sigma_m * draw[:3]).tolist(),
            "velocity_m_s": (first[3:] + table.start_sigma_m_s * draw[3:6]).tolist(),
            "q_inertial_from_body_wxyz": multiplied(attitude, turn).tolist(),
        }
        if table.relative_from_s is not None:
            start["relative_from_s"] = table.relative_from_s
        if table.lasting_errors:
            start["lasting"] = True
        return {ABSOLUTE_FILE: start}

    def streams(self) -> tuple[NavigationStream, ...]:
        """Return the sensors as streams."""
        return tuple(NavigationStream(self, name) for name in COLUMNS)

    @property
    def _sensors(self) -> Sensors:
        ionosphere_m = REGIMES[self.table.regime][-1]
        return Sensors(
            InertialUnit(),
            StarSensor(rate_hz=self.table.star_rate_hz),
            TrackingLoops(),
            RangeErrors(ionosphere_m=ionosphere_m, correlated=self.table.lasting_errors),
            ReceiverClock(),
            Faults(),
        )


@dataclass(frozen=True, eq=False)
class NavigationStream:
    """One of the sensors.

    Attributes
    ----------
    aboard : SensorsAboard
    name : str
        Of the stream.
    """

    aboard: SensorsAboard
    name: str

    @property
    def file(self) -> str:
        """Path of its table in a dataset."""
        return f"{self.name}.csv"

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of its numbers, unit at the end."""
        return COLUMNS[self.name]

    def reading(self, frame: int, time_s: float, since_s: float, run: int) -> TableReading:
        """Return what it gave from one frame to the next.

        Parameters
        ----------
        frame, time_s, since_s, run : as for ``TableSensor.reading``
        """
        times_s, rows = self.aboard.rows(run)[self.name]
        own = (times_s > since_s + ROUNDING_S) & (times_s <= time_s + ROUNDING_S)
        return TableReading(self.columns, times_s[own], rows[own])

    def along(self, trajectory: Trajectory) -> NavigationStream:
        """Return itself: a camera that is steered leaves the chaser as it is."""
        return self
