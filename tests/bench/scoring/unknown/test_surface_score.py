"""Surfaces whose distances have a closed form: balls about one middle, and plates apart."""

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from bench.scoring.target_shape import spread_points
from bench.scoring.unknown.inertia_score import inertia_score
from bench.scoring.unknown.surface_score import surface_score

RADIUS_M = 2.0
SIDE_M = 4.0
FACETS = 2e-3  # share of its radius by which a ball of 5120 faces lies within itself


def ball(radius_m: float) -> np.ndarray:
    return np.asarray(trimesh.creation.icosphere(4, radius_m).triangles)


def plate(height_m: float, shift_m: float = 0.0) -> np.ndarray:
    a, b = SIDE_M * np.array([[-0.5, -0.5], [0.5, 0.5]]) + [shift_m, 0.0]
    corners = np.array([[a[0], a[1]], [b[0], a[1]], [b[0], b[1]], [a[0], b[1]]])
    raised = np.column_stack([corners, np.full(4, height_m)])
    return raised[[[0, 1, 2], [0, 2, 3]]]


@pytest.mark.parametrize(("more_m", "near"), [(0.03, True), (0.06, True), (0.2, False)])
def test_a_ball_round_another_is_off_by_their_radii(more_m, near):
    true = ball(RADIUS_M)
    score = surface_score(ball(RADIUS_M + more_m), true, spread_points(true, 2000))
    facets_m = FACETS * RADIUS_M
    for told in (score.accuracy_rms_m, score.accuracy_median_m, score.chamfer_m):
        assert told == pytest.approx(more_m, abs=facets_m)
    size_m = 2.0 * RADIUS_M * np.sqrt(3.0)  # of the box about it
    assert score.within_m == pytest.approx(0.01 * size_m, rel=1e-2)
    assert score.completeness_5cm == float(more_m < 0.05)
    assert (score.precision, score.recall, score.f_score) == (near,) * 3


def test_a_plate_shifted_along_itself_covers_the_rest_of_the_other():
    # By a quarter: three quarters lie on each other, what is beyond is off by 0 to 1 m evenly.
    shift_m = 0.25 * SIDE_M
    true = plate(0.0)
    seen = spread_points(true, 4000)
    score = surface_score(plate(0.0, shift_m), true, seen)
    assert score.accuracy_median_m == pytest.approx(0.0, abs=1e-9)
    assert score.accuracy_rms_m == pytest.approx(np.sqrt(0.25 * shift_m**2 / 3.0), rel=0.02)
    assert score.chamfer_m == pytest.approx(0.25 * shift_m / 2.0, rel=0.02)
    within = 0.75 + 0.25 * score.within_m / shift_m
    for told in (score.precision, score.recall, score.f_score):
        assert told == pytest.approx(within, abs=0.01)
    assert score.completeness_5cm == pytest.approx(0.75 + 0.25 * 0.05 / shift_m, abs=0.01)


def test_half_a_surface_is_right_and_incomplete():
    true = plate(0.0)
    score = surface_score(true[:1], true, spread_points(true, 4000))
    assert score.precision == 1.0
    assert score.accuracy_rms_m == pytest.approx(0.0, abs=1e-9)
    assert score.recall is not None
    assert 0.5 < score.recall < 0.55
    assert score.f_score == pytest.approx(2.0 * score.recall / (1.0 + score.recall))


def test_without_anything_seen_only_accuracy_is_told():
    score = surface_score(plate(0.1), plate(0.0), np.zeros((0, 3)))
    assert score.accuracy_rms_m == pytest.approx(0.1)
    assert (score.recall, score.f_score, score.chamfer_m, score.completeness_5cm) == (None,) * 4


def test_axes_are_off_by_the_turn_between_them_and_moments_by_their_shares():
    moments = np.diag([0.1, 0.4, 0.5])
    turn = Rotation.from_rotvec(np.deg2rad([0.0, 0.0, 7.0])).as_matrix()
    turned = inertia_score(turn @ moments @ turn.T, 300.0 * moments)
    assert turned.axes_deg == pytest.approx([7.0, 7.0, 0.0], abs=1e-4)
    assert turned.moments_percent == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    other = inertia_score(np.diag([0.11, 0.4, 0.49]), moments)
    assert other.moments_percent == pytest.approx([10.0, 0.0, 2.0], abs=1e-9)
    assert other.entries_percent == pytest.approx(1.0)
