"""The synthetic corners carry the noise that they are said to carry, and tell nothing else."""

import numpy as np
import pytest
from scipy import stats

from bench.suites.pesce2019.cases import case, tumble_of
from bench.suites.pesce2019.synthetic_points import PointNoise, point_frame, points_of
from models.camera import camera_preset
from models.motion.chaser_navigation import SIGMA_M, SIGMA_M_S
from models.spacecraft.wireframes import wireframe_by_name
from pipelines.uncooperative.knowledge import PointFrame, seen

CAMERA = camera_preset("chaser_fixed")
TARGET = wireframe_by_name("xmm")
TUMBLE = tumble_of(case("3"), 600.0)
POSE = TUMBLE.cam_from_target(200.0)
TRUE_PX = CAMERA.project(POSE @ TARGET.points_in_target)
RUNS = 300
P_VALUE = 1e-4  # a right generator fails one of these tests in ten thousand


def named(points_px, sigma_px=0.01):
    """Tell which landmark each point is, where the noise is too small to be mistaken."""
    apart = np.linalg.norm(points_px[:, None] - TRUE_PX[None], axis=2)
    return np.where(apart.min(axis=1) < 8.0 * sigma_px, apart.argmin(axis=1), -1)


@pytest.fixture(scope="module")
def errors_px():
    """Return (RUNS, landmarks, 2), noise over its sigma, drawn too small to be mistaken."""
    noise = PointNoise(0.01, 1)
    rows = []
    for run in range(RUNS):
        points = points_of(TARGET, CAMERA, POSE, noise, (0, run, 0))
        who = named(points)
        rows.append([points[who == each][0] - TRUE_PX[each] for each in range(len(TARGET))])
    return np.array(rows) / 0.01


def test_noise_is_gaussian_of_the_sigma_asked(errors_px):
    assert stats.kstest(errors_px.ravel(), "norm").pvalue > P_VALUE


def test_noise_is_independent_between_axes_and_landmarks(errors_px):
    table = errors_px.reshape(RUNS, -1)
    correlation = np.corrcoef(table.T)[np.triu_indices(table.shape[1], 1)]
    # Fisher's transform of a correlation of independent numbers has variance 1 / (n - 3).
    scaled = np.arctanh(correlation) * np.sqrt(RUNS - 3)
    assert stats.kstest(scaled, "norm").pvalue > P_VALUE


def test_noise_is_independent_between_frames():
    noise = PointNoise(0.01, 0)
    first, second = (
        np.array(
            [
                (points := points_of(TARGET, CAMERA, POSE, noise, (0, run, frame)))[
                    named(points) == 0
                ][0]
                - TRUE_PX[0]
                for run in range(RUNS)
            ]
        ).ravel()
        for frame in (0, 1)
    )
    assert abs(np.arctanh(np.corrcoef(first, second)[0, 1])) * np.sqrt(2 * RUNS - 3) < 4.0


def test_outliers_are_uniform_over_the_target():
    noise = PointNoise(1e-9, 3)
    drawn = []
    for run in range(RUNS):
        points = points_of(TARGET, CAMERA, POSE, noise, (0, run, 0))
        drawn.append(points[named(points, 1e-6) < 0])
    lows, highs = TRUE_PX.min(axis=0), TRUE_PX.max(axis=0)
    places = (np.concatenate(drawn) - lows) / (highs - lows)
    assert len(places) == 3 * RUNS
    for axis in (0, 1):
        assert stats.kstest(places[:, axis], "uniform").pvalue > P_VALUE


def test_the_order_tells_nothing():
    """Each landmark stands at each place equally often."""
    noise = PointNoise(0.01, 0)
    places = np.array(
        [
            np.flatnonzero(named(points_of(TARGET, CAMERA, POSE, noise, (0, run, 0))) == 5)[0]
            for run in range(RUNS)
        ]
    )
    counts = np.bincount(places, minlength=len(TARGET))
    assert stats.chisquare(counts).pvalue > P_VALUE


def test_more_noise_is_the_same_noise_larger():
    """Table 7's cells differ by the size of the noise alone, and Table 8's by the outliers."""
    quiet, loud, many = (
        points_of(TARGET, CAMERA, POSE, noise, (0, 0, 0))
        for noise in (PointNoise(0.01, 0), PointNoise(0.02, 0), PointNoise(0.01, 4))
    )
    who = named(quiet)
    np.testing.assert_allclose(loud - TRUE_PX[who], 2.0 * (quiet - TRUE_PX[who]), atol=1e-9)
    known = many[named(many) >= 0]
    assert {tuple(row) for row in known.tolist()} == {tuple(row) for row in quiet.tolist()}


def test_a_frame_is_the_same_whatever_was_drawn_before():
    noise = PointNoise(2.0, 1)
    first = seen(point_frame(TUMBLE, TARGET, CAMERA, noise, 7.0, (0, 3, 7)))
    point_frame(TUMBLE, TARGET, CAMERA, noise, 8.0, (0, 3, 8))
    again = seen(point_frame(TUMBLE, TARGET, CAMERA, noise, 7.0, (0, 3, 7)))
    assert isinstance(first, PointFrame)
    assert isinstance(again, PointFrame)
    np.testing.assert_array_equal(first.points_px, again.points_px)
    np.testing.assert_array_equal(
        first.chaser.position_in_inertial, again.chaser.position_in_inertial
    )
    other = seen(point_frame(TUMBLE, TARGET, CAMERA, noise, 7.0, (0, 4, 7)))
    assert isinstance(other, PointFrame)
    assert not np.isin(first.points_px, other.points_px).any()


def test_the_chaser_is_known_as_well_as_section_v_b_3_says():
    noise = PointNoise(2.0, 1)
    frames = [
        seen(point_frame(TUMBLE, TARGET, CAMERA, noise, float(t), (0, 0, t))).chaser
        for t in range(200)
    ]
    truths = [TUMBLE.chaser_state(float(t)) for t in range(200)]
    for name, sigma in (("position_in_inertial", SIGMA_M), ("velocity_in_inertial", SIGMA_M_S)):
        errors = np.array(
            [getattr(f, name) - getattr(t, name) for f, t in zip(frames, truths, strict=True)]
        )
        assert stats.kstest(errors.ravel() / sigma, "norm").pvalue > P_VALUE
    assert (SIGMA_M, SIGMA_M_S) == (10.0, 0.1)
