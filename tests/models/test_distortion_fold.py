"""Where a lens folds: closed forms, and the sign of the Jacobian of OpenCV's own polynomial."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from models.arrays import Floats
from models.camera import CAMERAS, Camera
from models.distortion_fold import fold_radius
from models.errors import ScenarioError

ROUNDING_PX = 1e-6  # near a fold the way back loses half its digits
JUST_INSIDE = 0.999  # of the fold's radius: there the least slope is a thousandth
CHASER = CAMERAS["chaser_fixed"]
FAR_AXIS = Camera(2048, 2048, 2196.0, 2196.0, 1023.5, 1023.5, k1=-0.3)
WEAK = Camera(2048, 2048, 2196.0, 2196.0, 1023.5, 1023.5, k1=-0.08, k2=0.01, p1=5e-4, p2=-3e-4)


def lenses() -> st.SearchStrategy[tuple[float, ...]]:
    radial, tangential = st.floats(-2.0, 2.0), st.floats(-0.1, 0.1)
    return st.tuples(radial, radial, tangential, tangential, radial)


def polar(radius: float, count: int = 72) -> Floats:
    angle = 2.0 * np.pi * np.arange(count) / count
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def opencv_distorted(points: Floats, lens: tuple[float, ...]) -> Floats:
    """Distort by OpenCV: K is the identity."""
    ahead = np.concatenate([points, np.ones((len(points), 1))], axis=1)
    projected, _ = cv2.projectPoints(ahead, np.zeros(3), np.zeros(3), np.eye(3), np.array(lens))
    return np.asarray(projected[:, 0])


def least_slope(points: Floats, lens: tuple[float, ...]) -> Floats:
    """Return the lesser eigenvalue of OpenCV's Jacobian, by central differences."""
    step = 1e-6
    columns = [
        np.subtract(*(opencv_distorted(points + way * axis, lens) for way in (step, -step)))
        / (2.0 * step)
        for axis in np.eye(2)
    ]
    jacobian = np.stack(columns, axis=-1)
    return np.linalg.eigvalsh(0.5 * (jacobian + jacobian.swapaxes(1, 2)))[:, 0]


@pytest.mark.parametrize("k1", [-1e-3, -0.3, -5.0])
def test_a_barrel_of_k1_alone_folds_where_its_radius_turns_back(k1: float) -> None:
    assert fold_radius(k1, 0.0, 0.0, 0.0, 0.0) == pytest.approx((-3.0 * k1) ** -0.5, rel=1e-12)


def test_a_pincushion_never_folds_and_neither_does_no_lens() -> None:
    assert fold_radius(0.3, 0.1, 0.0, 0.0, 0.0) == np.inf
    assert fold_radius(0.0, 0.0, 0.0, 0.0, 0.0) == np.inf
    assert CHASER.fold_radius == np.inf


def test_a_barrel_that_k2_opens_again_in_time_does_not_fold() -> None:
    """1 - 3 u + 5 k2 u^2 has no root once k2 > 9/20."""
    assert fold_radius(-1.0, 0.46, 0.0, 0.0, 0.0) == np.inf
    assert fold_radius(-1.0, 0.44, 0.0, 0.0, 0.0) < 1.0


@given(lenses())
def test_inside_the_fold_opencvs_jacobian_is_positive(lens: tuple[float, ...]) -> None:
    fold = min(fold_radius(*lens), 3.0)
    for share in (0.3, 0.7, JUST_INSIDE):
        assert least_slope(polar(share * fold), lens).min() > 0.0


@given(lenses())
def test_a_barrels_fold_is_where_opencvs_jacobian_loses_its_sign(lens: tuple[float, ...]) -> None:
    """The bound is tight where the radius turns back, in the worst direction (5 deg of it)."""
    k1, k2, p1, p2, k3 = lens
    radius = fold_radius(*lens)
    assume(radius < 3.0)
    u = radius**2
    along = 1.0 + u * (3.0 * k1 + u * (5.0 * k2 + u * 7.0 * k3))
    across = 1.0 + u * (k1 + u * (k2 + u * k3))
    assume(along < across)
    worst = -radius * np.array([[p2, p1]]) / max(np.hypot(p1, p2), 1e-12)
    beyond = worst if np.hypot(p1, p2) > 1e-12 else polar(radius)[:1]
    assert least_slope(beyond, lens)[0] == pytest.approx(0.0, abs=1e-6)


@given(lenses(), st.floats(0.0, JUST_INSIDE), st.floats(0.0, 2.0 * np.pi))
def test_inside_the_fold_no_two_directions_share_a_place(
    lens: tuple[float, ...], share: float, angle: float
) -> None:
    """A gradient of a strictly convex potential: (D(a) - D(b)) . (a - b) > 0."""
    fold = min(fold_radius(*lens), 3.0)
    one = share * fold * np.array([[np.cos(angle), np.sin(angle)]])
    others = np.concatenate([polar(0.5 * fold, 24), polar(JUST_INSIDE * fold, 24)])
    others = others[np.linalg.norm(others - one, axis=1) > 1e-3 * fold]
    moved = opencv_distorted(others, lens) - opencv_distorted(one, lens)
    assert ((moved * (others - one)).sum(axis=1) > 0.0).all()


@given(st.floats(-0.3, 0.3), st.floats(-0.1, 0.1), st.floats(0.0, 0.95), st.floats(0.0, 6.28))
def test_what_projects_comes_back_by_its_ray(
    k1: float, k2: float, share: float, angle: float
) -> None:
    """Project after rays is the identity inside the fold, in the image or beyond its edge."""
    try:
        camera = replace(CHASER, k1=k1, k2=k2, p1=1e-3, p2=-5e-4)
    except ScenarioError:
        assume(False)
    reach = share * min(camera.fold_radius, 0.9)
    point = np.array([reach * np.cos(angle), reach * np.sin(angle), 1.0])
    pixel = camera.project(point)
    assert np.isfinite(pixel).all()
    np.testing.assert_allclose(camera.project(camera.rays(pixel)), pixel, atol=ROUNDING_PX)


def test_a_point_far_off_axis_does_not_come_back_into_the_image() -> None:
    """A barrel of k1 = -0.3 folds 46.5 deg off axis; a point at 60 deg fell on (1403.9, 1023.5)."""
    at = [[np.tan(np.deg2rad(angle)), 0.0, 1.0] for angle in (20.0, 46.0, 47.0, 60.0, 89.0)]
    pixels = FAR_AXIS.project(at)
    np.testing.assert_array_equal(np.isnan(pixels[:, 0]), [False, False, True, True, True])
    assert not FAR_AXIS.contains(pixels)[2:].any()
    folded = opencv_distorted(np.array(at)[3:4, :2], (-0.3, 0.0, 0.0, 0.0, 0.0))
    assert 2196.0 * folded[0, 0] + 1023.5 == pytest.approx(1403.9, abs=0.1)


@given(st.floats(0.0, 89.9), st.floats(0.0, 2.0 * np.pi), st.sampled_from([FAR_AXIS, WEAK]))
def test_what_an_image_holds_lies_within_its_corners(
    off_axis_deg: float, angle: float, camera: Camera
) -> None:
    tangent = np.tan(np.deg2rad(off_axis_deg))
    point = np.array([tangent * np.cos(angle), tangent * np.sin(angle), 1.0])
    corners = camera.rays([[-0.5, -0.5], [2047.5, -0.5], [-0.5, 2047.5], [2047.5, 2047.5]])
    if camera.contains(camera.project(point)):
        assert point[2] / np.linalg.norm(point) >= corners[:, 2].min() - 1e-12


def test_within_a_lenss_range_nothing_changes_by_a_bit() -> None:
    points = np.random.default_rng(2).uniform([-0.8, -0.8, 1.8], [0.8, 0.8, 6.7], size=(500, 3))
    plain = WEAK.distort(points[:, :2] / points[:, 2:])
    np.testing.assert_array_equal(
        WEAK.project(points), plain * [WEAK.fx, WEAK.fy] + [WEAK.cx, WEAK.cy]
    )
    assert np.isfinite(plain).all()


def test_points_at_the_edge_of_what_numbers_hold_do_not_warn() -> None:
    far = [[1e200, 0.0, 1e-3], [1e-200, 1e200, 1.0], [0.0, 0.0, 1e-300]]
    pixels = FAR_AXIS.project(far)
    np.testing.assert_array_equal(np.isnan(pixels[:, 0]), [True, True, False])


@pytest.mark.parametrize(
    "change",
    [
        {"k1": -5.0},
        {"k1": -0.5},
        {"k1": -0.2, "k2": -1.0},
        {"k3": -20.0},
        {"p1": 0.3},
        {"cx": 0.0, "cy": 0.0, "k1": -0.3},  # the far corner is twice as far off axis
    ],
)
def test_a_camera_that_folds_inside_its_image_is_refused(change: dict[str, float]) -> None:
    with pytest.raises(ScenarioError, match=r"one-to-one over the image, got k1 .* deg off axis"):
        replace(CHASER, **change)


@given(st.floats(0.3, 1.0))
def test_it_is_refused_exactly_from_where_its_corner_meets_the_fold(fold: float) -> None:
    """With k1 alone the fold maps to two thirds of its radius; the corner lies at 0.6595."""
    corner = np.hypot(1024.0, 1024.0) / CHASER.fx
    assume(abs(2.0 / 3.0 * fold / corner - 1.0) > 1e-3)
    k1 = -1.0 / (3.0 * fold**2)
    if 2.0 / 3.0 * fold > corner:
        assert replace(CHASER, k1=k1).fold_radius == pytest.approx(fold)
    else:
        with pytest.raises(ScenarioError, match="inside the 2048 x 2048 px"):
            replace(CHASER, k1=k1)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"fx": 1e300}, r"expected fx from 2.048 to 2.048e\+07 .*got 1e\+300"),
        ({"fy": 1e-9}, "expected fy from 2.048"),
        ({"cx": -1e9}, "expected cx from -32768 to 32768"),
        ({"cy": 1e300}, "expected cy from -32768 to 32768"),
        ({"width": 10**400}, "expected width from 1 to 16384 .*got a whole number of"),
        ({"height": 20000}, "expected height from 1 to 16384 .*got 20000"),
        ({"k3": 1e300}, r"expected k3 from -1e\+06 to 1e\+06"),
        ({"p2": -(10**5000)}, "expected p2 .*got a whole number of"),
    ],
)
def test_numbers_no_camera_has_are_refused(change: dict[str, float], said: str) -> None:
    with pytest.raises(ScenarioError, match=said):
        replace(CHASER, **change)
