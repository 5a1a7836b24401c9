"""Predictions against the simulation, and derivatives against differences."""

import numpy as np
import pytest

from bench.suites.volpe2017.cases import states_of
from bench.suites.volpe2017.point_frames import camera_of
from bench.suites.volpe2017.shape_bound import true_unknowns
from models.motion.clohessy_wiltshire import state_transition
from models.motion.gravity_gradient_rotation import lvlh_from_first
from models.spacecraft.simple_target import BOX_M, points_in_target, range_to_surface_m
from pipelines.unknown_target.free_tumble import FreeTumble
from pipelines.unknown_target.observation_rows import (
    Epochs,
    centre_rows,
    placed,
    sighting_rows,
    surface_rows,
)
from pipelines.unknown_target.unknowns import CHART, OMEGA, SHARED, Unknowns
from tests.support.watched_target import SHORT

STATES = states_of(SHORT)
FRAME = np.array([0, 30, 60])
WHO = np.array([3, 9, 11])
ONE = np.ones(3)
ZERO = np.zeros((3, 2))
STEP = 1e-5
SMALL = np.repeat([1e-3, 1e-5, 1e-7, 1e-5], [3, 3, 3, 5])  # by unknown: m, m/s, rad/s, 1


def where(at: Unknowns):
    attitude = np.array([each.R_cam_from_lvlh for each in STATES])
    epochs = epochs_of(attitude)
    first = epochs.R_cam_from_start[0].T
    own = FreeTumble(at.shared[OMEGA], at.shared[CHART], first, SHORT.orbit_rate, 121.0)
    return placed(at, own, epochs)


def epochs_of(attitude):
    n, times_s = SHORT.orbit_rate, SHORT.times_s
    turned = attitude @ np.array([lvlh_from_first(n * each) for each in times_s])
    steps = np.array([state_transition(n, each) for each in times_s])
    return Epochs(times_s, attitude, turned, steps)


def predictions(at: Unknowns):
    """Return minus the errors of measurements of zero: what is predicted."""
    now = where(at)
    seen = -sighting_rows(now, at.points, FRAME, WHO, ZERO, ONE).error
    far = -centre_rows(now, FRAME, np.zeros(3), ONE).error
    return np.concatenate([seen.ravel(), far.ravel()])


def test_predictions_are_what_is_seen():
    at, camera = true_unknowns(SHORT), camera_of()
    found = predictions(at)
    for place, (frame, who) in enumerate(zip(FRAME, WHO, strict=True)):
        point = STATES[frame].cam_from_target @ points_in_target()[who]
        px = found[2 * place : 2 * place + 2] * camera.fx + np.array([camera.cx, camera.cy])
        np.testing.assert_allclose(px, camera.project(point), atol=1e-4)
        assert found[6 + place] == pytest.approx(np.linalg.norm(STATES[frame].rho_in_lvlh))


def test_derivatives_are_differences():
    at = true_unknowns(SHORT)
    now = where(at)
    rows = sighting_rows(now, at.points, FRAME, WHO, ZERO, ONE)
    far = centre_rows(now, FRAME, np.zeros(3), ONE)
    both = np.concatenate([rows.by_shared.reshape(6, -1), far.by_shared.reshape(3, -1)])
    for unknown in range(SHARED):
        change = np.zeros(SHARED)
        change[unknown] = SMALL[unknown]
        still = np.zeros_like(at.points)
        slope = predictions(at.moved(change, still)) - predictions(at.moved(-change, still))
        slope /= 2.0 * SMALL[unknown]
        scale = np.abs(slope).max()
        np.testing.assert_allclose(both[:, unknown], slope, atol=1e-4 * scale)
    for place, who in enumerate(WHO):
        for axis in range(3):
            moved = np.zeros_like(at.points)
            moved[who, axis] = STEP
            none = np.zeros(SHARED)
            slope = predictions(at.moved(none, moved)) - predictions(at.moved(none, -moved))
            found = rows.by_point[place, :, axis]
            np.testing.assert_allclose(
                found, slope[2 * place : 2 * place + 2] / (2.0 * STEP), atol=1e-7
            )


def test_a_point_behind_the_camera_is_no_prediction():
    at = true_unknowns(SHORT)
    behind = at.points.copy()
    behind[3, 2] = -100.0
    rows = sighting_rows(where(at), behind, FRAME, WHO, ZERO, ONE)
    assert rows.sizes[0] == np.inf
    assert len(rows.weighted(np.where(np.isfinite(rows.sizes), 1.0, 0.0)).who) == 2


def test_a_surface_range_is_to_the_face_that_the_beam_meets():
    at = true_unknowns(SHORT)
    now = where(at)
    every = np.arange(len(STATES))
    box = np.zeros(12, dtype=bool)
    box[:8] = True  # the hull of the panels' corners too is not the surface beside them
    true_m = np.array(
        [
            range_to_surface_m(-p.rotation.T @ p.translation, p.rotation[2])
            for p in (state.cam_from_target for state in STATES)
        ]
    )
    sigma = np.ones(len(every))
    rows = surface_rows(now, at.points, box, every, true_m, sigma)
    np.testing.assert_allclose(rows.error, 0.0, atol=1e-6)
    corners = at.points[rows.who]
    np.testing.assert_allclose(np.abs(corners), np.tile(0.5 * BOX_M, (len(every), 1)))
    assert true_m.max() - true_m.min() > 0.5


def test_a_beam_that_misses_tells_nothing():
    at = true_unknowns(SHORT)
    far = at.points + np.array([5.0, 0.0, 0.0])
    rows = surface_rows(where(at), far, np.ones(12, dtype=bool), FRAME, 20.0 * ONE, ONE)
    assert not np.isfinite(rows.sizes[0])
    flat = np.zeros(12, dtype=bool)
    flat[:3] = True
    rows = surface_rows(where(at), at.points, flat, FRAME, 20.0 * ONE, ONE)
    assert not np.isfinite(rows.sizes).any()
