"""The pipeline as the bench would run it: frames of tables in, estimates out."""

from dataclasses import replace

import numpy as np
import pytest

from bench.suites.volpe2017.point_frames import camera_of, frames_of
from bench.suites.volpe2017.tracking_run import case_options
from models.errors import DatasetError, ScenarioError
from models.frame import Frame, TableReading
from models.pose import pose_error
from pipelines.unknown_target.pipeline import INERTIA, MOTION, SHAPE, UnknownTarget
from pipelines.unknown_target.start_guess import StartGuess
from pipelines.unknown_target.tracked_frame import RANGE, TRACKS, seen
from tests.support.watched_target import SHORT, motion_start

FRAMES = list(frames_of(SHORT, 0, 0))


@pytest.mark.parametrize("variant", ["paper", "best"])
def test_frames_in_estimates_out(variant):
    options = case_options(SHORT, variant)
    pipeline = UnknownTarget(camera_of(), SHORT.orbit_rate, motion_start(SHORT), options)
    estimates = [pipeline.process(tracked.as_frame()) for tracked, _ in FRAMES]
    first, last = estimates[0], estimates[-1]
    if variant == "best":
        assert first.pose is None
        assert "expected 4 or more" in first.reason
    assert last.pose is not None
    error = pose_error(last.pose.cam_from_target, FRAMES[-1][1].cam_from_target)
    assert error.attitude_deg < 2.0
    assert np.linalg.eigvalsh(last.pose.stated_covariance)[0] > 0.0
    assert set(last.states) == {MOTION, SHAPE, INERTIA}
    assert last.states[SHAPE].values["points_in_target_m"].shape == (12, 3)


def test_a_frame_is_the_same_through_its_tables():
    tracked = FRAMES[3][0]
    back = seen(tracked.as_frame())
    np.testing.assert_allclose(back.R_cam_from_lvlh, tracked.R_cam_from_lvlh, atol=1e-12)
    np.testing.assert_array_equal(back.tracks, tracked.tracks)
    np.testing.assert_array_equal(back.points_px, tracked.points_px)
    assert back.range_m == tracked.range_m
    without = replace(tracked, range_m=None).as_frame()
    assert RANGE not in without.readings
    assert seen(without).range_m is None


def spoiled(column: int, value: float) -> Frame:
    frame = FRAMES[3][0].as_frame()
    table = frame.table(TRACKS)
    rows = table.rows.copy()
    rows[1, column] = value
    return replace(
        frame, readings={**frame.readings, TRACKS: TableReading(table.columns, table.time_s, rows)}
    )


@pytest.mark.parametrize(
    ("column", "value", "told"),
    [(0, 0.0, "each track once"), (1, np.nan, "finite"), (3, 0.0, "sigma_px above zero")],
)
def test_tables_that_cannot_be_are_refused(column, value, told):
    with pytest.raises(DatasetError, match=told):
        seen(spoiled(column, value))


def test_a_start_that_cannot_be_is_refused():
    with pytest.raises(ScenarioError, match="sigma_m above zero"):
        StartGuess(np.ones(3), 0.0)
    with pytest.raises(ScenarioError, match="away from it"):
        StartGuess(np.zeros(3), 1.0)
