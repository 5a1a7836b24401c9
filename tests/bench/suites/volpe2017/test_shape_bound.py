"""The bound's Jacobian against the simulation, and what the bound must hold to."""

from dataclasses import replace

import numpy as np
import pytest

from bench.suites.volpe2017.cases import TUMBLE, Case, motion_of, observability_cases
from bench.suites.volpe2017.point_frames import camera_of, frame_of
from bench.suites.volpe2017.shape_bound import (
    COLUMNS,
    BoundTask,
    bound,
    true_places,
    true_unknowns,
)
from models.motion.watched_tumble import WatchedTumble
from models.sensors.range_finder import RangeFinder
from pipelines.unknown_target.inertia_chart import inertia_of
from pipelines.unknown_target.observation_rows import sighting_rows
from pipelines.unknown_target.unknowns import CHART, OMEGA, PLACE, SHARED

SHORT = Case("short", "short", TUMBLE, duration_s=90.0, step_s=3.0)
SMALL = np.repeat([1e-3, 1e-5, 1e-6, 1e-4], [3, 3, 3, 5])
DIFFERENCES = 1e-3  # of the largest: second order, and the turn of the first camera


def pixels(shared, time_s):
    """Return where the points are seen if the unknowns were others, by the simulation alone."""
    motion = motion_of(SHORT)
    other = WatchedTumble(
        motion.semi_major_axis_m, motion.start, shared[OMEGA], inertia_of(shared[CHART]), 100.0
    )
    camera_attitude = motion.state(time_s).R_cam_from_lvlh  # known, and as it was
    turn = camera_attitude @ other.state(time_s).R_lvlh_from_target
    moved = WatchedTumble(
        motion.semi_major_axis_m, shared[PLACE], shared[OMEGA], inertia_of(shared[CHART]), 100.0
    )
    place = -camera_attitude @ moved.state(time_s).rho_in_lvlh
    return camera_of().project(SHORT.points_in_target @ turn.T + place)


@pytest.mark.parametrize("unknown", range(SHARED))
def test_rows_are_differences_of_the_simulation(unknown):
    at, camera = true_unknowns(SHORT), camera_of()
    frame = np.full(12, 25)
    ones = np.full(12, 1.0 / camera.fx)
    rows = sighting_rows(
        true_places(SHORT), at.points, frame, np.arange(12), np.zeros((12, 2)), ones
    )
    change = np.zeros(SHARED)
    change[unknown] = SMALL[unknown]
    more, less = (pixels(at.shared + sign * change, 75.0) for sign in (1.0, -1.0))
    slope = (more - less) / (2.0 * SMALL[unknown])
    scale = np.abs(slope).max()
    np.testing.assert_allclose(rows.by_shared[:, :, unknown], slope, atol=DIFFERENCES * scale)


def column(name, **changes):
    own = bound(BoundTask(replace(SHORT, **changes), 0)).values["bound"]
    return own[:, COLUMNS.index(name)]


def test_more_is_known_with_every_image():
    for name in ("shape_m", "inertia_percent", "scale"):
        assert (np.diff(column(name)) < 1e-6).all()


def test_without_a_range_the_scale_is_as_it_was():
    assert column("scale", range_to="none")[-1] == pytest.approx(
        column("scale", range_to="none")[0], rel=0.05
    )
    assert column("scale")[-1] < 0.1 * column("scale", range_to="none")[-1]


def test_false_matches_and_false_ranges_count_as_missing():
    assert column("shape_m", false_share=0.3)[-1] > column("shape_m")[-1]
    finder = RangeFinder(outlier_share=0.5)
    assert column("scale", range_finder=finder)[-1] > column("scale")[-1]


def test_a_spin_in_a_high_orbit_tells_ratios_nothing():
    cases = {own.key: own for own in observability_cases(200.0)}
    least = {
        key: bound(BoundTask(replace(cases[key], step_s=4.0), 0)).values["bound"][-1]
        for key in ("spin_high_centre", "tumble_centre")
    }
    place = COLUMNS.index("inertia_percent")
    assert least["spin_high_centre"][place] > 4.0 * least["tumble_centre"][place]


def test_the_prior_and_the_noise_are_the_estimators_own():
    frame = frame_of(replace(SHORT, rounded=True), motion_of(SHORT).state(0.0), 0, 0, 0)
    np.testing.assert_allclose(frame.sigma_px, np.sqrt(1.0 + 1.0 / 12.0))
    np.testing.assert_array_equal(frame.points_px, np.round(frame.points_px))
