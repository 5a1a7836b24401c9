"""A flight as a dataset, both halves: for ``rvbench estimate`` and any navigator of one's own."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bench.scoring.flights.judged_instants import TRUTH
from bench.suites.vinag2018.cases import Case
from bench.suites.vinag2018.flight import EPOCH, flight_of
from models.atomic_file import write_text
from models.dataset.description import DatasetInfo, Stream, info_to_json
from models.dataset.frame_table import FrameEntry, frames_to_csv
from models.dataset.onboard_files import onboard_texts
from models.dataset.sensor_table import table_to_csv
from models.frame import TableReading
from models.gnss.range_errors import RangeErrors
from models.gnss.receiver_clock import ReceiverClock
from models.gnss.tracking_noise import TrackingLoops
from models.navigation_tables import COLUMNS, table_of
from models.onboard import OnboardKnowledge
from models.sensors.inertial_unit import InertialUnit
from models.sensors.star_sensor import StarSensor
from renders.flight.faults import Faults
from renders.flight.flight import Flight
from renders.flight.sensing import Sensors, sensed
from renders.flight.true_motion import RealMotion

CHAIN = "absolute_navigation"
FILES = {"gnss": "gnss.csv", "inertial": "inertial.csv", "star_attitude": "star_attitude.csv"}
OFF_M, OFF_M_S = 300.0, 0.3  # on each axis, of the start that is told
TABLE = "absolute.toml"


def write_flight(
    folder: Path, case: Case, duration_s: float, seed: int = 0, faults: Faults | None = None
) -> Path:
    """Write a dataset with a frame a second; ``dataset.json`` last.

    Parameters
    ----------
    folder : Path
        Made if needed.
    case : Case
    duration_s : float, s
    seed : int
        Of all noise.
    faults : Faults, optional

    Returns
    -------
    Path
        The folder.

    Raises
    ------
    StorageError
        If it cannot be written.
    """
    flight = flight_of(case, duration_s)
    sensors = Sensors(
        InertialUnit(),
        StarSensor(),
        TrackingLoops(),
        RangeErrors(ionosphere_m=case.ionosphere_m),
        ReceiverClock(),
        faults or Faults(),
    )
    tables: dict[str, list[tuple[int, TableReading]]] = {name: [] for name in COLUMNS}
    entries: list[FrameEntry] = []
    truth = ["index,time_s,x_m,y_m,z_m,x_m_s,y_m_s,z_m_s,qw,qx,qy,qz"]
    for record, was in sensed(flight, sensors, RealMotion(flight), seed, (0,)):
        index = len(entries)
        if record is not None:
            stream, table = table_of(record)
            tables[stream].append((index, table))
        elif was is not None:
            entries.append(FrameEntry(index, was.time_s))
            numbers = [*was.motion[0, :6].tolist(), *was.q_inertial_from_body_wxyz.tolist()]
            truth.append(",".join([str(index), repr(was.time_s), *map(repr, numbers)]))
    onboard = onboard_texts(OnboardKnowledge(tables={TABLE: _start(flight, case.regime)}))
    info = DatasetInfo(
        case=f"vinag-{case.key}",
        sun="by date",
        frames=len(entries),
        target=f"a satellite in {case.name}",
        chain=CHAIN,
        streams=tuple(Stream(name, "table", FILES[name], COLUMNS[name]) for name in COLUMNS),
        onboard=tuple(onboard),
        provenance={"flown": f"{flight.duration_s:g} s from {EPOCH}, seed {seed}"},
    )
    texts = {
        **onboard,
        "frames.csv": frames_to_csv(entries),
        **{FILES[name]: table_to_csv(COLUMNS[name], rows) for name, rows in tables.items()},
        TRUTH: "\n".join(truth) + "\n",
        "dataset.json": info_to_json(info),
    }
    for name, text in texts.items():
        write_text(folder / name, text)
    return folder


def _start(flight: Flight, regime: str) -> dict[str, object]:
    first = flight.orbit.states(np.zeros(1))[0]
    return {
        "regime": regime,
        "epoch": EPOCH,
        "position_m": (first[:3] + OFF_M).tolist(),
        "velocity_m_s": (first[3:] + OFF_M_S).tolist(),
        "q_inertial_from_body_wxyz": flight.attitude.quaternions(np.zeros(1))[0].tolist(),
    }
