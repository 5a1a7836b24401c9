"""What the scene of an absolute navigation shows: the orbit, and the satellites that are heard."""

from __future__ import annotations

from collections.abc import Callable

from bench.chains.chain import EstimatesByPipeline
from bench.pictures.frame_record import FrameRecord, FrameRecords
from bench.report.scene_addition import OrbitScene, SceneAddition
from bench.scoring.flights.judged_instants import ORBIT, POSITION
from models.arrays import Floats
from models.estimate import Estimate
from models.frame import TableReading
from models.navigation_tables import GNSS

MOST_SKIES = 600  # instants of which the satellites are told
SENT = ("sent_x_m", "sent_y_m", "sent_z_m")


def scene(records: FrameRecords, estimates: EstimatesByPipeline) -> SceneAddition:
    """Return where the satellite was, was said to be, and whom it heard.

    Parameters
    ----------
    records : FrameRecords
    estimates : mapping of str to mapping of int to Estimate
        Of run 0, by pipeline.
    """
    return SceneAddition(
        orbit=orbit_scene(
            records, estimates, lambda own: None if own.truth is None else own.truth.position_m
        )
    )


def orbit_scene(
    records: FrameRecords,
    estimates: EstimatesByPipeline,
    true_place: Callable[[FrameRecord], Floats | None],
) -> OrbitScene:
    """Return an orbit: the true one, those said, and the satellites heard.

    Parameters
    ----------
    records : FrameRecords
    estimates : mapping of str to mapping of int to Estimate
        Of run 0, by pipeline.
    true_place : callable
        From a frame's record to the place, (3,) array, inertial, m; None where none is known.
    """
    indices = records.dataset.indices
    step = -(-len(indices) // MOST_SKIES)
    true_m, senders_m = [], []
    for place, index in enumerate(indices):
        record = records.record(index)
        true_m.append(true_place(record))
        senders_m.append(_senders_m(record) if place % step == 0 else None)
    said_m = {label: [_place_m(own.get(index)) for index in indices]
              for label, own in estimates.items()}  # fmt: skip
    return OrbitScene(true_m, said_m, senders_m)


def _place_m(said: Estimate | None) -> Floats | None:
    if said is None or ORBIT not in said.states:
        return None
    place = said.states[ORBIT].values.get(POSITION)
    return place if place is not None and place.shape == (3,) else None


def _senders_m(record: FrameRecord) -> Floats | None:
    heard = record.frame.readings.get(GNSS)
    if not isinstance(heard, TableReading) or not len(heard.time_s):
        return None
    latest = heard.time_s == heard.time_s.max()
    columns = [heard.columns.index(name) for name in SENT]
    return heard.rows[latest][:, columns]
