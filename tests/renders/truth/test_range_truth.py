"""A beam meets what geometry says, and truth keeps the centre of mass apart from it."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from tests.support.small_scenes import LAMBERT, activate_best, camera_at

SINGLE_PRECISION_M = 2e-5
STEP = [(0.0, 0.0, -0.5), (4.0, 4.0, 1.0)], [(1.0, 0.0, 0.5), (2.0, 4.0, 1.0)]


@pytest.fixture(scope="module")
def scene():
    """Return a step: its lower face at z = 0 for x below 0, its upper one at z = 1."""
    activate_best()
    from renders.tracing.scene import build_geometry

    mesh = trimesh.util.concatenate(
        [trimesh.creation.box(size).apply_translation(place) for place, size in STEP]
    )
    craft = Spacecraft("step", (Part("step", mesh, LAMBERT),), None, np.zeros(3))
    return build_geometry(craft, None, RetroreflectorOptics()).scene()


def read(scene, place, footprint_rad=0.0):
    from renders.truth.range_truth import range_truth

    return range_truth(scene, camera_at(np.array(place)), np.zeros(3), footprint_rad)


def test_it_is_the_surface_that_is_met(scene):
    low, high = read(scene, [-1.0, 0.0, 10.0]), read(scene, [1.0, 0.0, 10.0])
    assert low.surface_m == pytest.approx(10.0, abs=SINGLE_PRECISION_M)
    assert high.surface_m == pytest.approx(9.0, abs=SINGLE_PRECISION_M)
    assert high.centre_m == pytest.approx(np.sqrt(101.0))
    assert low.met_share == 1.0


def test_a_beam_beside_the_target_has_no_echo(scene):
    missed = read(scene, [5.0, 0.0, 10.0])
    assert missed.surface_m == np.inf
    assert missed.met_share == 0.0


def test_a_wide_beam_reads_where_most_of_it_falls(scene):
    half = read(scene, [0.1, 0.0, 10.0], footprint_rad=0.05)
    assert half.surface_m == pytest.approx(9.0, abs=0.02)
    other = read(scene, [-0.1, 0.0, 10.0], footprint_rad=0.05)
    assert other.surface_m == pytest.approx(10.0, abs=0.02)
