"""Distances of capsules against brute force, and of an arm from boxes of known size."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.arm.arm import Capsule
from models.arm.clearance import (
    FAR_M,
    SAMPLED_M,
    Surroundings,
    apart,
    nearest_of_itself,
    sampled,
    segment_distance,
    swept,
)
from models.arm.house_arm import house_arm
from models.pose import RigidTransform
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.solids import box

GRID = 201
OF_GRID_M = 0.02  # between points of two segments of up to 3.5 m
WALL_M = 0.004  # by which a wall near a tube is told too far, at most


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), kind=st.sampled_from(["any", "parallel", "point", "same"]))
def test_segments_are_as_far_apart_as_their_nearest_points(seed, kind):
    rng = np.random.default_rng(seed)
    first, second = rng.uniform(-1.0, 1.0, (2, 2, 3))
    if kind == "parallel":
        second[1] = second[0] + rng.uniform(-2.0, 2.0) * (first[1] - first[0])
    elif kind == "point":
        second[1] = second[0]
    elif kind == "same":
        second = first.copy()
    share = np.linspace(0.0, 1.0, GRID)[:, None]
    one = first[0] + share * (first[1] - first[0])
    other = second[0] + share * (second[1] - second[0])
    brute = np.linalg.norm(one[:, None] - other[None], axis=2).min()
    distance = float(segment_distance(first, second))
    assert distance <= brute + 1e-12
    assert distance >= brute - OF_GRID_M
    assert distance == pytest.approx(float(segment_distance(second, first)), abs=1e-9)


def test_many_segments_at_once_are_as_one_by_one():
    pairs = np.random.default_rng(1).uniform(-1.0, 1.0, (20, 2, 2, 3))
    together = segment_distance(pairs[:, 0], pairs[:, 1])
    assert together.tolist() == [float(segment_distance(*pair)) for pair in pairs]


def test_a_stretched_arm_is_clear_of_itself_and_a_folded_one_is_not():
    arm = house_arm()
    assert nearest_of_itself(arm, np.zeros(7)).distance_m > 0.3
    folded = nearest_of_itself(arm, np.deg2rad([0.0, 0.0, 0.0, 178.0, 0.0, 0.0, 0.0]))
    assert folded.distance_m < 0.0
    assert "inside" in str(folded)


def test_what_a_joint_joins_is_not_asked():
    arm = house_arm()
    asked = {
        frozenset((arm.capsules[i].name, arm.capsules[j].name)) for i, j in apart(arm.capsules)
    }
    assert frozenset(("forearm", "shoulder")) in asked
    assert frozenset(("upper_arm", "gripper")) in asked
    assert frozenset(("forearm", "elbow")) not in asked
    assert frozenset(("palm", "gripper")) not in asked


@pytest.mark.parametrize("gap_m", [-0.02, 0.01, 0.03, 0.1, 0.2])
def test_a_wall_is_as_far_as_it_is(gap_m):
    arm = house_arm()
    tube = max(arm.capsules, key=lambda each: each.length_m)
    middle = gap_m + tube.radius_m + 0.5
    wall = Spacecraft(
        "wall", (Part("wall", box((1.0, 8.0, 8.0)), "black_paint"),), None, np.zeros(3)
    )
    here = RigidTransform(np.eye(3), np.array([middle, 0.0, -1.0]))
    passed = swept(arm, np.zeros((1, 7)), [here], {tube.link})
    gaps = Surroundings.of(wall).gaps(passed)
    assert gaps.min() == pytest.approx(gap_m, abs=WALL_M)
    assert gaps.min() >= gap_m - 1e-12


def test_what_is_far_is_not_measured():
    arm = house_arm()
    here = RigidTransform(np.eye(3), np.array([50.0, 0.0, 0.0]))
    wall = Spacecraft(
        "wall", (Part("wall", box((1.0, 1.0, 1.0)), "black_paint"),), None, np.zeros(3)
    )
    passed = swept(arm, np.zeros((2, 7)), [here, here], range(8))
    assert set(Surroundings.of(wall).gaps(passed)) == {FAR_M}
    assert set(passed.instants) == {0, 1}


def test_every_place_of_a_surface_has_a_sample_nearby():
    rng = np.random.default_rng(2)
    triangles = rng.uniform(-0.4, 0.4, (12, 3, 3))
    shares = rng.dirichlet(np.ones(3), 200)
    places = np.einsum("pc,tcx->tpx", shares, triangles).reshape(-1, 3)
    points = sampled(triangles)
    nearest = np.array([np.linalg.norm(points - place, axis=1).min() for place in places])
    assert nearest.max() <= SAMPLED_M


def test_a_capsule_knows_its_length():
    assert Capsule(0, "rod", np.zeros(3), np.array([0.0, 3.0, 4.0]), 0.1).length_m == 5.0


@pytest.mark.parametrize("cuts", [0.9, 1.0, 1.9, 2.0, 2.1, 4.99])
def test_the_middle_of_the_worst_triangle_is_near_enough(cuts):
    """Of an even triangle the middle of a cell is an edge over root 3 from its corners."""
    edge_m = cuts * np.sqrt(3.0) * SAMPLED_M
    corners = edge_m * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, np.sqrt(0.75), 0.0]])
    points = sampled(corners[None])
    cells = int(np.ceil(cuts - 1e-9))
    middle = corners[0] + (corners - corners[0]).sum(axis=0) / 3.0 / cells
    nearest = np.linalg.norm(points - middle, axis=1).min()
    assert nearest == pytest.approx(edge_m / cells / np.sqrt(3.0))
    assert nearest <= SAMPLED_M * (1.0 + 1e-9)
    assert len(points) == (cells + 1) * (cells + 2) // 2
