"""A beam meets what geometry says, and truth keeps the centre of mass apart from it."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from models.errors import DatasetError
from models.spacecraft.part import Part, Spacecraft
from renders.truth.range_truth import (
    RANGE_TRUTH,
    Beam,
    RangeTruth,
    range_truth_text,
    read_range_truths,
)
from tests.support.small_scenes import camera_at

STEP = [(0.0, 0.0, -0.5), (4.0, 4.0, 1.0)], [(1.0, 0.0, 0.5), (2.0, 4.0, 1.0)]


def step() -> Spacecraft:
    """Return a step: its lower face at z = 0 for x below 0, its upper one at z = 1."""
    mesh = trimesh.util.concatenate(
        [trimesh.creation.box(size).apply_translation(place) for place, size in STEP]
    )
    return Spacecraft("step", (Part("step", mesh, "mli"),), None, np.zeros(3))


def read(place, footprint_rad=0.0) -> RangeTruth:
    return Beam(step(), footprint_rad).meets(camera_at(np.array(place)))


def test_it_is_the_surface_that_is_met():
    low, high = read([-1.0, 0.0, 10.0]), read([1.0, 0.0, 10.0])
    assert low.surface_m == pytest.approx(10.0, abs=1e-9)
    assert high.surface_m == pytest.approx(9.0, abs=1e-9)
    assert high.centre_m == pytest.approx(np.sqrt(101.0))
    assert low.met_share == 1.0


def test_a_beam_beside_the_target_has_no_echo():
    missed = read([5.0, 0.0, 10.0])
    assert missed.surface_m == np.inf
    assert missed.met_share == 0.0


def test_a_wide_beam_reads_where_most_of_it_falls():
    half = read([0.1, 0.0, 10.0], footprint_rad=0.05)
    assert half.surface_m == pytest.approx(9.0, abs=0.02)
    other = read([-0.1, 0.0, 10.0], footprint_rad=0.05)
    assert other.surface_m == pytest.approx(10.0, abs=0.02)


def test_a_ball_is_met_where_its_equation_says():
    """Rays at every distance beside a ball's middle, and the sphere's own equation."""
    ball = trimesh.creation.icosphere(subdivisions=5, radius=1.0)
    beam = Beam(Spacecraft("ball", (Part("ball", ball, "mli"),), None, np.zeros(3)))
    for aside in np.linspace(0.0, 0.95, 12):
        met = beam.meets(camera_at(np.array([aside, 0.3 * aside, 6.0]))).surface_m
        towards = 6.0 - np.sqrt(max(0.0, 1.0 - aside**2 * 1.09))
        if aside * np.sqrt(1.09) < 0.95:
            assert met == pytest.approx(towards, abs=2e-3)  # of so many facets


def test_truth_reads_back(tmp_path):
    truths = {0: RangeTruth(9.0, 10.5, 1.0), 3: RangeTruth(np.inf, 11.25, 0.25)}
    path = tmp_path / RANGE_TRUTH
    path.parent.mkdir()
    path.write_text(range_truth_text(truths.items()))
    assert read_range_truths(tmp_path) == truths
    path.write_text(path.read_text() + "3,1.0,1.0,1.0\n")
    with pytest.raises(DatasetError, match="each frame once, got 3 again"):
        read_range_truths(tmp_path)
    assert read_range_truths(tmp_path / "elsewhere") == {}
