"""Every clause of Opromolla et al. 2022 on the pattern whose Figure 4 we cannot see."""

from __future__ import annotations

import numpy as np
import pytest

from models.arrays import Floats
from models.camera import CAMERAS
from models.pose import RigidTransform
from models.spacecraft.retroreflector_layout import POINTS_IN_TARGET, RETROREFLECTORS

RING_OUTER_RADIUS_M = 0.90  # the flange of a 0.83 m launch adaptor ring
FACE_HALF_WIDTH_M = 1.2
SUPPORT_RADIUS_M = 0.03  # a marker's seat reaches a little beyond its disc
SPAN_3_4_M = 1.6
MIN_SEPARATION_M = 0.2
ROUNDING_M = 1e-12
BORDER_MARGIN = 1.2  # s_bord, Table 11
CENTROID_STD_PX = 0.078  # Table 13, the worse axis of S1 and S2
POSITION_GOAL_M, ATTITUDE_GOAL_DEG = 1e-3, 0.1

CAMERA = CAMERAS["chaser_fixed"]
POINTS = {name: np.array(point) for name, point in POINTS_IN_TARGET.items()}
CLOSE_GROUP = ("5", "6", "7", "8", "9", "10")


def facing(point: Floats, range_m: float) -> RigidTransform:
    """Return the pose of a camera that looks straight down on a point of the ring plane."""
    flip = np.diag([1.0, -1.0, -1.0])
    return RigidTransform(flip, [0.0, 0.0, range_m] - flip @ [point[0], point[1], 0.0])


def seen(range_m: float) -> set[str]:
    """Names of the markers safely inside the image, the boresight through the pattern's centre."""
    pose = facing(RETROREFLECTORS.points_in_target.mean(axis=0), range_m)
    radius_px = np.rint(RETROREFLECTORS.radius_m * CAMERA.fx / range_m)
    inside = CAMERA.contains(
        CAMERA.project(pose @ RETROREFLECTORS.points_in_target), BORDER_MARGIN * radius_px
    )
    return {name for name, kept in zip(RETROREFLECTORS.names, inside, strict=True) if kept}


def span(names: tuple[str, ...]) -> float:
    points = np.array([POINTS[name] for name in names])
    return float(np.linalg.norm(points[:, None] - points, axis=-1).max())


def test_ten_retroreflectors_of_the_papers_radius() -> None:
    assert RETROREFLECTORS.names == tuple(str(k) for k in range(1, 11))
    assert RETROREFLECTORS.radius_m == 0.0127


def test_all_face_the_chaser() -> None:
    np.testing.assert_array_equal(RETROREFLECTORS.normals_in_target, [[0.0, 0.0, 1.0]] * 10)


@pytest.mark.parametrize("name", POINTS)
def test_each_stands_on_the_minus_y_half_of_the_face_outside_the_ring(name: str) -> None:
    x, y, _ = POINTS[name]
    assert y < -SUPPORT_RADIUS_M
    assert max(abs(x), abs(y)) <= FACE_HALF_WIDTH_M - SUPPORT_RADIUS_M
    assert np.hypot(x, y) >= RING_OUTER_RADIUS_M + SUPPORT_RADIUS_M


def test_nearest_neighbours_are_at_least_20_cm_apart_also_as_seen() -> None:
    assert RETROREFLECTORS.min_separation_m >= MIN_SEPARATION_M
    flat = RETROREFLECTORS.points_in_target[:, :2]
    gaps = np.linalg.norm(flat[:, None] - flat, axis=-1)[np.triu_indices(10, 1)]
    assert gaps.min() >= MIN_SEPARATION_M


def test_3_and_4_are_160_cm_apart_in_x_and_so_set_the_field_of_view() -> None:
    assert POINTS["4"][0] - POINTS["3"][0] == pytest.approx(SPAN_3_4_M, abs=ROUNDING_M)
    np.testing.assert_array_equal(POINTS["3"][1:], POINTS["4"][1:])
    needed_deg = 2.0 * np.rad2deg(np.arctan(SPAN_3_4_M / (2.0 * 1.8)))
    assert needed_deg == pytest.approx(47.92, abs=0.005)  # equation 1, two decimals


def test_1_and_2_are_spread_wider() -> None:
    assert POINTS["2"][0] - POINTS["1"][0] > SPAN_3_4_M
    assert span(("1", "2")) == span(RETROREFLECTORS.names)


def test_5_to_10_are_a_close_group_within_the_span_of_3_and_4() -> None:
    assert span(CLOSE_GROUP) < SPAN_3_4_M
    assert all(POINTS["3"][0] < POINTS[name][0] < POINTS["4"][0] for name in CLOSE_GROUP)
    assert span(("7", "8", "9", "10")) < span(CLOSE_GROUP)


def test_10_alone_is_out_of_plane() -> None:
    out = [name for name, point in POINTS.items() if point[2] != 0.0]
    assert out == ["10"]
    assert POINTS["10"][2] >= 0.1  # enough to see, at a tenth of the last range and more


def test_9_breaks_the_symmetry_about_the_y_z_plane() -> None:
    def mirrored(names: tuple[str, ...]) -> set[tuple[float, ...]]:
        return {(-x, y, z) for x, y, z in (POINTS[name].tolist() for name in names)}

    def own(names: tuple[str, ...]) -> set[tuple[float, ...]]:
        return {(x, y, z) for x, y, z in (POINTS[name].tolist() for name in names)}

    without, full = ("7", "8", "10"), ("7", "8", "9", "10")
    assert mirrored(without) == own(without)
    assert mirrored(full) != own(full)


def test_7_8_and_10_are_not_collinear_and_7_to_10_not_coplanar() -> None:
    rest = np.array([POINTS[name] for name in ("8", "9", "10")]) - POINTS["7"]
    assert np.linalg.norm(np.cross(rest[0], rest[2])) > MIN_SEPARATION_M**2 / 2.0
    assert abs(np.linalg.det(rest)) > 0.1 * MIN_SEPARATION_M**3


def test_2_and_4_are_on_the_plus_x_side() -> None:
    assert POINTS["2"][0] > 0.0
    assert POINTS["4"][0] > 0.0


def test_6_is_among_the_farthest_from_the_x_axis() -> None:
    away = sorted(POINTS, key=lambda name: -abs(POINTS[name][1]))
    assert "6" in away[:2]


def test_at_1_8_m_the_camera_sees_3_to_10_and_at_6_7_m_all_ten() -> None:
    assert seen(1.8) == set(RETROREFLECTORS.names) - {"1", "2"}
    assert seen(6.7) == set(RETROREFLECTORS.names)


def test_at_6_7_m_markers_are_the_papers_size_and_apart() -> None:
    """Section 3.1 counts in pixels of the mean angle: 8.90 px across, at least 70.09 px apart."""
    ifov_rad = np.deg2rad(50.0 / 2048.0)
    diameter_px = 2.0 * RETROREFLECTORS.radius_m / 6.7 / ifov_rad
    assert diameter_px == pytest.approx(8.90, abs=0.02)  # 0.0244 deg is rounded
    assert RETROREFLECTORS.min_separation_m / 6.7 / ifov_rad >= 70.0


@pytest.mark.parametrize("range_m", [6.7, 4.0, 1.8])
def test_the_papers_centroid_noise_allows_a_millimetre_and_a_tenth_of_a_degree(
    range_m: float,
) -> None:
    """The Cramer-Rao bound of the six pose parameters, by numerical differentiation."""
    pose = facing(RETROREFLECTORS.points_in_target.mean(axis=0), range_m)
    kept = [RETROREFLECTORS.names.index(name) for name in seen(range_m)]
    points = RETROREFLECTORS.points_in_target[kept]
    step = 1e-6
    columns = [
        (
            CAMERA.project(pose.perturbed(move[:3], move[3:]) @ points)
            - CAMERA.project(pose.perturbed(-move[:3], -move[3:]) @ points)
        ).ravel()
        / (2.0 * step)
        for move in step * np.eye(6)
    ]
    jacobian = np.stack(columns, axis=-1)
    bound = CENTROID_STD_PX * np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))
    assert np.rad2deg(bound[:3]).max() < ATTITUDE_GOAL_DEG
    assert bound[3:].max() < POSITION_GOAL_M
