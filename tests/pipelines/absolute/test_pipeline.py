"""Absolute navigation as a pipeline: tables in, states out, and every way to have none."""

from dataclasses import replace

import numpy as np
import pytest

from bench.suites.vinag2018.cases import LEO
from bench.suites.vinag2018.flight import EPOCH, flight_of
from models.errors import DatasetError
from models.frame import Frame, TableReading
from models.gnss.range_errors import RangeErrors
from models.gnss.receiver_clock import ReceiverClock
from models.gnss.tracking_noise import TrackingLoops
from models.navigation_records import InertialInterval
from models.navigation_tables import COLUMNS, GNSS, INERTIAL, STARS, records_of, table_of
from models.onboard import OnboardKnowledge
from models.sensors.inertial_unit import InertialUnit
from models.sensors.star_sensor import StarSensor
from pipelines.absolute.pipeline import INTEGRITY, ORBIT, TURN
from pipelines.registry import registered_pipeline
from renders.flight.faults import Faults
from renders.flight.sensing import Sensors, sensed
from renders.flight.true_motion import RealMotion

SPAN_S = 40.0
FLIGHT = flight_of(replace(LEO, degree=4), SPAN_S)


def start() -> dict[str, object]:
    first = FLIGHT.orbit.states(np.zeros(1))[0]
    return {
        "regime": "leo",
        "epoch": EPOCH,
        "position_m": (first[:3] + 300.0).tolist(),
        "velocity_m_s": (first[3:] - 0.3).tolist(),
        "q_inertial_from_body_wxyz": FLIGHT.attitude.quaternions(np.zeros(1))[0].tolist(),
    }


def pipeline(variant: str = "best", **changed):
    table = {**start(), **changed}
    told = OnboardKnowledge(tables={"absolute.toml": table})
    return registered_pipeline("absolute").make(told, variant)


@pytest.fixture(scope="module")
def seconds():
    """Return frames, one a second, and the truth of each."""
    sensors = Sensors(
        InertialUnit(),
        StarSensor(),
        TrackingLoops(),
        RangeErrors(ionosphere_m=10.0),
        ReceiverClock(),
        Faults(),
    )
    frames, truths, rows = [], [], {name: [] for name in COLUMNS}
    for record, truth in sensed(FLIGHT, sensors, RealMotion(FLIGHT), 3, (0,)):
        if record is not None:
            stream, table = table_of(record)
            rows[stream].append(table)
            continue
        frames.append(Frame(len(frames), truth.time_s, joined(rows)))
        truths.append(truth)
        rows = {name: [] for name in COLUMNS}
    return frames, truths


def joined(rows) -> dict[str, TableReading]:
    return {
        name: TableReading(
            COLUMNS[name],
            np.concatenate([each.time_s for each in tables]),
            np.concatenate([each.rows for each in tables]),
        )
        for name, tables in rows.items()
        if tables
    }


@pytest.mark.parametrize("variant", ["paper", "best"])
def test_it_navigates(seconds, variant):
    own = pipeline(variant)
    said = [own.process(frame) for frame in seconds[0]]
    assert all(said)
    last, truth = said[-1], seconds[1][-1]
    assert last.mode == "navigating"
    orbit = last.states[ORBIT]
    error = orbit.values["position_in_inertial_m"] - truth.motion[0, :3]
    assert np.abs(error).max() < 15.0
    assert error @ np.linalg.solve(orbit.covariance[:3, :3], error) < 20.0
    q = last.states[TURN].values["q_inertial_from_body_wxyz"]
    assert abs(q @ truth.q_inertial_from_body_wxyz) > 1.0 - 1e-8
    told = last.states[INTEGRITY].values
    assert told["satellites_used"] > 10
    assert (np.abs(error).max() < told["protection_m"]).all()


def test_tables_keep_records(seconds):
    for frame in seconds[0][:3]:
        again: dict[str, list[TableReading]] = {name: [] for name in COLUMNS}
        for record in records_of(frame.readings):
            stream, table = table_of(record)
            again[stream].append(table)
        for name, table in joined(again).items():
            assert table.rows == pytest.approx(frame.table(name).rows, rel=1e-15)
    pushed = InertialInterval(1.0, 0.2, np.zeros((1, 3)), np.array([[0.1, 0.0, 0.0]]))
    back = records_of(dict([table_of(pushed)]))[0]
    assert back.specific_force_m_s2.tolist() == [[0.1, 0.0, 0.0]]


def test_what_comes_late_or_not_at_all_is_told(seconds):
    own = pipeline()
    frames = seconds[0]
    own.process(frames[0])
    late = own.process(
        Frame(1, frames[1].time_s, {**frames[1].readings, GNSS: frames[0].table(GNSS)})
    )
    assert late.states[INTEGRITY].values["late_records"] == 0  # sorted: it is taken in its place
    late = own.process(Frame(2, frames[2].time_s, frames[1].readings))
    assert late.states[INTEGRITY].values["late_records"] > 0
    silent = own.process(Frame(9, frames[9].time_s, {}))
    assert not silent
    assert "no turns for the last" in silent.reason


def test_rows_that_cannot_be_are_a_reason(seconds):
    frame = seconds[0][0]
    for stream, column, value, words in (
        (STARS, 0, 7.0, "a unit quaternion"),
        (STARS, 4, -1.0, "a positive covariance"),
        (INERTIAL, 0, 0.0, "a duration above 0"),
    ):
        table = frame.table(stream)
        rows = table.rows.copy()
        rows[0, column] = value
        broken = {**frame.readings, stream: TableReading(table.columns, table.time_s, rows)}
        said = pipeline().process(Frame(0, frame.time_s, broken))
        assert not said
        assert words in said.reason
    other = TableReading(("range_m",), np.zeros(1), np.zeros((1, 1)))
    assert "expected the columns" in pipeline().process(Frame(0, 1.0, {GNSS: other})).reason


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"regime": "moon"}, "regime among leo, geo, got 'moon'"),
        ({"position_m": [1.0, 2.0]}, "position_m as 3 finite numbers"),
        ({"velocity_m_s": [1.0, float("nan"), 0.0]}, "velocity_m_s as 3 finite numbers"),
        ({"q_inertial_from_body_wxyz": [1.0, 1.0, 0.0, 0.0]}, "of length 1"),
    ],
)
def test_a_start_that_cannot_be_is_refused(changed, words):
    with pytest.raises(DatasetError, match=words):
        pipeline(**changed)


def test_without_a_start_it_says_what_to_write():
    with pytest.raises(DatasetError, match=r"absolute\.toml.*write regime"):
        registered_pipeline("absolute").make(OnboardKnowledge(), "best")
