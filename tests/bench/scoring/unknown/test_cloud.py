"""A cloud's distance to a surface: a box's closed form stands for the mesh."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from bench.scoring.unknown.cloud import Surface, cloud_score

HALF = np.array([1.0, 0.5, 2.0])


@pytest.fixture(scope="module")
def surface() -> Surface:
    return Surface(np.asarray(trimesh.creation.box(2.0 * HALF).triangles))


def from_box(points: np.ndarray) -> np.ndarray:
    """Return the distances to the box's surface, by its closed form."""
    beyond = np.abs(points) - HALF
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
    return np.where((beyond <= 0.0).all(axis=1), -beyond.max(axis=1), outside)


def test_distances_are_the_boxs(surface):
    points = np.random.default_rng(0).uniform(-2.5, 2.5, (300, 3))
    np.testing.assert_allclose(surface.distances(points), from_box(points), atol=1e-9)


def test_a_cloud_on_the_surface_and_one_beside_it(surface):
    rng = np.random.default_rng(1)
    on = rng.uniform(-1.0, 1.0, (400, 3)) * HALF
    axis = rng.integers(0, 3, 400)
    on[np.arange(400), axis] = (HALF * np.sign(on))[np.arange(400), axis]
    seen = on[:200]
    exact = cloud_score(on, np.full(400, 0.01), surface, seen)
    assert exact.rms_m == pytest.approx(0.0, abs=1e-9)
    assert exact.completeness_5cm == 1.0
    assert exact.sigma_m == pytest.approx(0.01)
    off = on.copy()
    off[np.arange(40), axis[:40]] *= 1.0 + 0.3 / HALF[axis[:40]]  # a tenth, 30 cm outside
    beside = cloud_score(off, None, surface, seen)
    assert beside.rms_m == pytest.approx(0.3 * np.sqrt(0.1), rel=1e-6)
    assert beside.inlier_rms_m == pytest.approx(0.0, abs=1e-9)
    assert beside.within_5cm == pytest.approx(0.9)
    assert beside.median_m == pytest.approx(0.0, abs=1e-9)


def test_nothing_is_told_of_what_is_not_there(surface):
    none = cloud_score(np.zeros((0, 3)), None, surface, np.zeros((5, 3)))
    assert (none.points, none.rms_m, none.completeness_5cm) == (0, None, None)
    unknown = cloud_score(np.ones((3, 3)), np.ones(3), None, np.zeros((5, 3)))
    assert (unknown.points, unknown.rms_m, unknown.sigma_m) == (3, None, 1.0)
