"""MSSD, MSPD, VSD, ADD and ADD-S against a second implementation, written from the papers.

It loops where ours is vectorised, and shares nothing with it: homogeneous 4 x 4 matrices, one
vertex and one pixel at a time.
"""

import math

import numpy as np
import pytest
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation

from bench.scoring.metrics import bop
from bench.scoring.metrics.add import add, add_s
from bench.scoring.metrics.speed import FLOOR_ATTITUDE_DEG, FLOOR_POSITION, SpeedError, speed_error
from models.camera import Camera
from models.pose import RigidTransform

POSES = 100
ROUNDING = 1e-9  # a few hundred sums of doubles of this size
CAMERA = Camera(width=64, height=48, fx=60.0, fy=62.0, cx=30.0, cy=25.0)
SYMMETRIES = (np.diag([-1.0, -1.0, 1.0]),)


def random_poses(seed: int) -> list[tuple[RigidTransform, RigidTransform]]:
    """Return estimates with their truths, all points of a 3 m target well before the camera."""
    rng = np.random.default_rng(seed)
    return [
        tuple(
            RigidTransform(
                Rotation.random(rng=rng).as_matrix(),
                np.array([*rng.uniform(-1.0, 1.0, 2), rng.uniform(5.0, 30.0)]),
            )
            for _ in range(2)
        )
        for _ in range(POSES)
    ]


CLOUD = np.random.default_rng(3).uniform(-1.5, 1.5, (40, 3))


def moved(pose: RigidTransform, point: np.ndarray) -> list[float]:
    matrix = pose.matrix()
    return [sum(matrix[row, k] * point[k] for k in range(3)) + matrix[row, 3] for row in range(3)]


def seen(point: list[float]) -> list[float]:
    x, y, z = point
    return [CAMERA.fx * x / z + CAMERA.cx, CAMERA.fy * y / z + CAMERA.cy]


def turned(turn: np.ndarray, point: np.ndarray) -> np.ndarray:
    return np.array([sum(turn[row, k] * point[k] for k in range(3)) for row in range(3)])


def naive_add(estimate, truth) -> float:
    return sum(math.dist(moved(estimate, x), moved(truth, x)) for x in CLOUD) / len(CLOUD)


def naive_adi(estimate, truth) -> float:
    there = [moved(estimate, x) for x in CLOUD]
    return sum(min(math.dist(moved(truth, x), y) for y in there) for x in CLOUD) / len(CLOUD)


def naive_maximum(estimate, truth, view) -> float:
    best = math.inf
    for turn in (np.eye(3), *SYMMETRIES):
        worst = max(
            math.dist(view(moved(estimate, x)), view(moved(truth, turned(turn, x)))) for x in CLOUD
        )
        best = min(best, worst)
    return best


def naive_vsd(estimated, true, scene, diameter, tau, delta) -> float:
    """Hodan et al. 2016, equation 1, with the masks of the challenge of 2019."""
    cost = union = 0
    for row in range(true.shape[0]):
        for column in range(true.shape[1]):
            e, t, s = estimated[row, column], true[row, column], scene[row, column]
            true_seen = t > 0 and (s == 0 or t - s <= delta)
            seen_there = e > 0 and (s == 0 or e - s <= delta or true_seen)
            if true_seen or seen_there:
                union += 1
                alike = true_seen and seen_there and abs(t - e) / diameter < tau
                cost += 0 if alike else 1
    return 1.0 if union == 0 else cost / union


@pytest.mark.parametrize("seed", [0])
def test_distances_of_points_are_those_of_the_papers(seed):
    tree = KDTree(CLOUD)
    for estimate, truth in random_poses(seed):
        assert abs(add(estimate, truth, CLOUD) - naive_add(estimate, truth)) < ROUNDING
        assert abs(add_s(estimate, truth, tree) - naive_adi(estimate, truth)) < ROUNDING
        own = bop.mssd(estimate, truth, CLOUD, SYMMETRIES)
        assert abs(own - naive_maximum(estimate, truth, lambda x: x)) < ROUNDING
        own_px = bop.mspd(estimate, truth, CLOUD, CAMERA, SYMMETRIES)
        assert abs(own_px - naive_maximum(estimate, truth, seen)) < ROUNDING


def test_visible_surface_discrepancy_is_that_of_the_paper():
    """On depths that hide and are hidden, meet and miss each other, and on nothing at all."""
    rng = np.random.default_rng(5)
    for number in range(POSES):
        size = (7, 9)
        true = np.where(rng.random(size) < 0.6, rng.uniform(4.0, 5.0, size), 0.0)
        estimated = np.where(rng.random(size) < 0.6, rng.uniform(4.0, 5.0, size), 0.0)
        scene = np.where(rng.random(size) < 0.5, true, rng.uniform(3.9, 5.1, size))
        if number == 0:
            true = estimated = scene = np.zeros(size)
        own = bop.vsd(estimated, true, scene, 2.0)
        for tau, discrepancy in zip(bop.SHARES, own, strict=True):
            wanted = naive_vsd(estimated, true, scene, 2.0, tau, bop.VSD_DELTA_M)
            assert abs(discrepancy - wanted) < ROUNDING


def test_speed_score_is_that_of_the_paper():
    """By quaternions and an arc cosine, as printed; ours keeps digits that these have not."""
    digits_of_an_arc_cosine = 1e-7
    for estimate, truth in random_poses(1):
        own = speed_error(estimate, truth)
        q, p = (Rotation.from_matrix(each.rotation).as_quat() for each in (estimate, truth))
        angle = 2.0 * math.acos(min(1.0, abs(sum(a * b for a, b in zip(q, p, strict=True)))))
        apart = math.dist(estimate.translation, truth.translation) / math.hypot(*truth.translation)
        assert own.position == pytest.approx(apart, abs=ROUNDING)
        assert own.attitude_rad == pytest.approx(angle, abs=digits_of_an_arc_cosine)
        assert own.score == own.position + own.attitude_rad


@pytest.mark.parametrize(
    ("position", "attitude_deg", "floored"),
    [
        (FLOOR_POSITION - 1e-9, FLOOR_ATTITUDE_DEG - 1e-9, (False, False)),
        (FLOOR_POSITION + 1e-9, FLOOR_ATTITUDE_DEG - 1e-9, (True, False)),
        (FLOOR_POSITION - 1e-9, FLOOR_ATTITUDE_DEG + 1e-9, (False, True)),
        (0.5, 90.0, (True, True)),
    ],
)
def test_each_term_has_a_floor_of_its_own(position, attitude_deg, floored):
    error = SpeedError(position, math.radians(attitude_deg))
    counts_position, counts_attitude = floored
    wanted = position * counts_position + math.radians(attitude_deg) * counts_attitude
    assert error.score_floored == pytest.approx(wanted, abs=ROUNDING)


def test_a_symmetry_that_is_declared_costs_nothing():
    truth = random_poses(2)[0][1]
    alike = RigidTransform(truth.rotation @ SYMMETRIES[0], truth.translation)
    assert bop.mssd(alike, truth, CLOUD, SYMMETRIES) < ROUNDING
    assert bop.mspd(alike, truth, CLOUD, CAMERA, SYMMETRIES) < ROUNDING
    assert bop.mssd(alike, truth, CLOUD) > 1.0


def test_a_point_that_the_estimate_puts_behind_the_camera_is_infinitely_wrong():
    truth = RigidTransform(np.eye(3), np.array([0.0, 0.0, 5.0]))
    behind = RigidTransform(np.eye(3), np.array([0.0, 0.0, -5.0]))
    assert bop.mspd(behind, truth, CLOUD, CAMERA) == math.inf
    assert bop.mspd_recall(math.inf, CAMERA.width) == 0.0


def test_recalls_of_one_frame_are_shares_of_thresholds():
    """Below, not at, a threshold; pixels as if the image were 640 wide."""
    assert bop.mssd_recall(0.0, 30.0) == 1.0
    assert bop.mssd_recall(1.5, 30.0) == 0.9  # 5 % of 30 m is no longer passed
    assert bop.mssd_recall(1e9, 30.0) == 0.0
    assert bop.mspd_recall(15.9, 2048) == 1.0
    assert bop.mspd_recall(16.1, 2048) == 0.9  # 5 px of 640 are 16 of 2048
    assert bop.vsd_recall(np.zeros(10)) == 1.0
    assert bop.vsd_recall(np.full(10, 0.26)) == 0.5
