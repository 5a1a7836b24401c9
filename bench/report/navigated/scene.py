"""What the scene of a navigated chaser shows beside its target: the chaser's orbit."""

from __future__ import annotations

from bench.chains.chain import EstimatesByPipeline
from bench.pictures.frame_record import FrameRecord, FrameRecords
from bench.report.flights.scene import orbit_scene
from bench.report.scene_addition import SceneAddition
from models.arrays import Floats


def scene(records: FrameRecords, estimates: EstimatesByPipeline) -> SceneAddition:
    """Return where the chaser was, was said to be, and whom it heard.

    Parameters
    ----------
    records : FrameRecords
    estimates : mapping of str to mapping of int to Estimate
        Of run 0, by pipeline.
    """
    return SceneAddition(orbit=orbit_scene(records, estimates, _true_place))


def _true_place(record: FrameRecord) -> Floats | None:
    return None if record.truth is None else record.truth.chaser.position_in_inertial
