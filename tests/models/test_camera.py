from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arrays import Floats
from models.camera import CAMERAS, Camera, camera_preset
from models.errors import ScenarioError

ROUNDING_PX = 1e-9  # doubles at 2048 px keep 4e-13; distortion and its undoing cost some digits
TABLE_1_FOCAL_PX = 2195.98  # Opromolla et al. 2022, from its field of view; two decimals
TABLE_3_FOCAL_PX = 2472.15
TABLE_TOLERANCE_PX = 0.005
OPENCV_UNDISTORT_PX = 1e-6  # its own fixed point, run to the end, keeps some nine digits

CHASER = CAMERAS["chaser_fixed"]
BARREL = replace(CHASER, cx=1020.3, cy=1031.8, k1=-0.25, k2=0.08, p1=1e-3, p2=-7e-4, k3=-0.01)
PINCUSHION = replace(Camera.from_fov(2048, 2048, 90.0), k1=0.3, k2=0.1)


def distorted_cameras() -> st.SearchStrategy[Camera]:
    """Lenses as calibrations find them, over a 50 deg image.

    None folds over inside it: at the worst corner of these intervals the radius turns back at a
    distorted 0.71, and the image's corner lies at 0.66.
    """
    return st.builds(
        lambda k1, k2, p1, p2, k3: replace(CHASER, k1=k1, k2=k2, p1=p1, p2=p2, k3=k3),
        st.floats(-0.15, 0.15),
        st.floats(-0.1, 0.1),
        st.floats(-0.003, 0.003),
        st.floats(-0.003, 0.003),
        st.floats(-0.05, 0.05),
    )


def pixels() -> st.SearchStrategy[Floats]:
    return st.tuples(st.floats(-0.5, 2047.5), st.floats(-0.5, 2047.5)).map(np.array)


def grid(camera: Camera, steps: int = 9) -> Floats:
    u = np.linspace(-0.5, camera.width - 0.5, steps)
    v = np.linspace(-0.5, camera.height - 0.5, steps)
    return np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)


def test_presets_have_the_papers_focal_lengths_and_centres() -> None:
    for name, focal in (("chaser_fixed", TABLE_1_FOCAL_PX), ("eye_in_hand", TABLE_3_FOCAL_PX)):
        camera = camera_preset(name)
        assert (camera.width, camera.height) == (2048, 2048)
        assert camera.fx == camera.fy == pytest.approx(focal, abs=TABLE_TOLERANCE_PX)
        assert (camera.cx, camera.cy) == (1023.5, 1023.5)
        assert not camera.distorted


def test_an_unknown_preset_is_told_which_there_are() -> None:
    with pytest.raises(ScenarioError, match=r"chaser_fixed, eye_in_hand, .*, got 'chaser'"):
        camera_preset("chaser")


def test_the_field_of_view_ends_at_the_outer_edges_of_the_outer_pixels() -> None:
    half = np.tan(np.deg2rad(25.0))
    corners = CHASER.project([[-half, -half, 1.0], [half, half, 1.0]])
    np.testing.assert_allclose(corners, [[-0.5, -0.5], [2047.5, 2047.5]], atol=ROUNDING_PX)


def test_axes_are_right_down_forward() -> None:
    centre, right, down = CHASER.project([[0, 0, 2.0], [0.1, 0, 2.0], [0, 0.1, 2.0]])
    np.testing.assert_array_equal(centre, [1023.5, 1023.5])
    assert right[0] > centre[0]
    assert right[1] == centre[1]
    assert down[1] > centre[1]
    assert down[0] == centre[0]


def test_what_is_not_in_front_has_no_projection() -> None:
    projected = BARREL.project([[0.1, 0.1, 0.0], [0.1, 0.1, -3.0], [0.1, 0.1, 3.0]])
    np.testing.assert_array_equal(np.isnan(projected).all(axis=1), [True, True, False])
    assert not CHASER.contains(projected)[:2].any()


@pytest.mark.parametrize("camera", [CHASER, BARREL, PINCUSHION])
def test_projection_agrees_with_opencv(camera: Camera) -> None:
    rng = np.random.default_rng(3)
    points = rng.uniform([-0.8, -0.8, 1.8], [0.8, 0.8, 6.7], size=(500, 3))
    theirs, _ = cv2.projectPoints(
        points, np.zeros(3), np.zeros(3), camera.matrix, camera.distortion
    )
    np.testing.assert_allclose(camera.project(points), theirs[:, 0], atol=ROUNDING_PX)


def test_undistortion_agrees_with_opencv() -> None:
    points_px = grid(BARREL)
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 500, 1e-14)
    theirs = cv2.undistortPoints(
        points_px[:, None], BARREL.matrix, BARREL.distortion, criteria=criteria
    )[:, 0]
    difference_px = (BARREL.normalise(points_px) - theirs) * BARREL.fx
    np.testing.assert_allclose(difference_px, 0.0, atol=OPENCV_UNDISTORT_PX)


STEP = 1e-6
OF_A_STEP = 1e-6  # what central differences err by, and rounding


def test_a_lens_bends_neighbouring_rays_by_the_slopes_that_newton_takes() -> None:
    lens = Camera(640, 480, 500.0, 500.0, 320.0, 240.0, k1=-0.3, k2=0.2, p1=2e-3, p2=-3e-3, k3=-0.1)
    places = np.array([[0.3, -0.2], [-0.5, 0.1], [0.2, 0.4], [0.0, 0.0]])
    ahead, aside, down = lens._distortion_slopes(places)
    for axis, expected in ((0, (ahead, aside)), (1, (aside, down))):
        step = STEP * np.eye(2)[axis]
        bent = (lens.distort(places + step) - lens.distort(places - step)) / (2.0 * STEP)
        np.testing.assert_allclose(bent, np.stack(expected, axis=-1), atol=OF_A_STEP)


@given(distorted_cameras(), pixels())
def test_a_pixels_ray_projects_to_the_pixel(camera: Camera, pixel: Floats) -> None:
    ray = camera.rays(pixel)
    assert np.linalg.norm(ray) == pytest.approx(1.0, abs=1e-15)
    np.testing.assert_allclose(camera.project(7.0 * ray), pixel, atol=ROUNDING_PX)


@given(distorted_cameras(), st.floats(-0.4, 0.4), st.floats(-0.4, 0.4))
def test_undistorting_undoes_distorting(camera: Camera, x: float, y: float) -> None:
    back = camera.undistort(camera.distort([x, y]))
    np.testing.assert_allclose(back, [x, y], atol=ROUNDING_PX / camera.fx)


@pytest.mark.parametrize("strength", [0.2, 0.8, 3.0])
def test_a_pincushion_can_be_undone_however_strong(strength: float) -> None:
    """With k1 > 0 alone the radius grows without a fold."""
    camera = replace(PINCUSHION, k1=strength, k2=0.0)
    corners = grid(camera)
    np.testing.assert_allclose(camera.project(camera.rays(corners)), corners, atol=ROUNDING_PX)


@pytest.mark.parametrize("k1", [-0.5, -3.0])
def test_a_pixel_beyond_the_fold_is_refused(k1: float) -> None:
    """Since x (1 + k1 x^2) turns back at x^2 = -1 / (3 k1): nothing lies beyond its value there."""
    camera = replace(CHASER, width=512, height=512, cx=255.5, cy=255.5, k1=k1)
    fold = 1.0 / np.sqrt(-3.0 * k1)
    edge_px = camera.cx + camera.fx * fold * 2.0 / 3.0
    assert np.isfinite(camera.normalise([edge_px - 1.0, camera.cy])).all()
    with pytest.raises(ValueError, match="1 of 2 points have no way back; check the coefficients"):
        camera.normalise([[camera.cx, camera.cy], [edge_px + 1.0, camera.cy]])


def test_a_missing_pixel_stays_missing() -> None:
    normalised = BARREL.normalise([[np.nan, np.nan], [1020.3, 1031.8]])
    assert np.isnan(normalised[0]).all()
    np.testing.assert_allclose(normalised[1], 0.0, atol=1e-15)


def test_no_pixel_at_all_is_no_error() -> None:
    assert BARREL.normalise(np.empty((0, 2))).shape == (0, 2)
    assert CHASER.project(np.empty((0, 3))).shape == (0, 2)


def test_one_point_and_many_agree() -> None:
    points = np.array([[0.3, -0.2, 2.0], [-0.1, 0.5, 3.0]])
    np.testing.assert_array_equal(BARREL.project(points)[1], BARREL.project(points[1]))


def test_contains_counts_from_the_images_outer_edge() -> None:
    camera = Camera.from_fov(100, 50, 50.0)
    assert camera.contains([[-0.5, -0.5], [99.5, 49.5]]).all()
    assert not camera.contains([[-0.51, 0], [0, -0.51], [99.51, 0], [0, 49.51]]).any()
    assert camera.contains([[1.5, 1.5], [97.5, 47.5]], margin_px=2.0).all()
    assert not camera.contains([[1.4, 9], [9, 1.4], [97.6, 9], [9, 47.6]], margin_px=2.0).any()
    assert not camera.contains([np.nan, np.nan])


@given(pixels(), st.sampled_from([64, 256, 512, 4096]))
def test_a_resized_camera_sees_the_same_ray_at_the_scaled_place(pixel: Floats, width: int) -> None:
    small = BARREL.resized(width)
    scale = width / BARREL.width
    ray = BARREL.rays(pixel)
    expected = (pixel + 0.5) * scale - 0.5
    np.testing.assert_allclose(small.project(ray), expected, atol=2.0 * ROUNDING_PX)


@given(
    st.one_of(
        st.builds(
            lambda camera, focal, centre: replace(camera, fy=focal, cy=centre),
            distorted_cameras(),
            st.floats(2196.0, 1e6),  # a longer focus keeps the image within the lens
            st.floats(1000.0, 1048.0),
        ),
        st.builds(
            lambda focal, centre: replace(CHASER, fy=focal, cy=centre),
            st.floats(2.1, 1e6),
            st.floats(-1e4, 1e4),
        ),
    )
)
def test_a_camera_file_comes_back_exactly(camera: Camera) -> None:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "camera.toml"
        path.write_text(camera.to_toml())
        assert Camera.from_toml(path) == camera


@given(distorted_cameras())
def test_lenses_as_calibrations_find_them_can_be_undone(camera: Camera) -> None:
    spread = camera.spread_px()
    np.testing.assert_allclose(camera.project(camera.rays(spread)), spread, atol=ROUNDING_PX)


@pytest.mark.parametrize("k", [(-5.0, 0.0, 0.0), (1.0, -30.0, 60.0)])
def test_a_lens_that_folds_the_image_over_is_refused(k: tuple[float, float, float]) -> None:
    """Also where it folds at mid-field and the corners might find a way back."""
    with pytest.raises(ScenarioError, match="one-to-one over the image"):
        replace(CHASER, k1=k[0], k2=k[1], k3=k[2])


def test_numpys_numbers_are_written_as_numbers(tmp_path: Path) -> None:
    camera = replace(CHASER, fx=np.float64(2200.125))
    path = tmp_path / "camera.toml"
    path.write_text(camera.to_toml())
    assert Camera.from_toml(path) == camera


GOOD = CHASER.to_toml()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (GOOD.replace("fx =", "focal ="), r"unknown: focal; missing: fx"),
        (GOOD.replace("width = 2048\n", ""), r"missing: width"),
        (GOOD.replace("width = 2048", "width = 2048.0"), r"expected an integer width, got 2048.0"),
        (GOOD.replace("width = 2048", "width = true"), r"expected a number for width, got True"),
        (GOOD.replace("width = 2048", "width = 0"), r"expected width in px above zero, got 0"),
        (GOOD.replace("k1 = 0.0", "k1 = nan"), r"expected a finite k1, got nan"),
        (GOOD.replace("k1 = 0.0", 'k1 = "0.1"'), r"expected a number for k1, got '0.1'"),
        (GOOD.replace("k1 = 0.0", "k1 = [0.1]"), r"expected a number for k1, got \[0.1\]"),
        (GOOD.replace("k1 = 0.0", "k1 = -5"), r"camera.toml: expected a distortion that is one-to"),
        (GOOD.replace("cx = 1023.5", "cx = 1e300"), r"camera.toml: expected cx from -32768 to"),
        ("not toml at all", r"expected a camera as TOML, got: "),
        pytest.param("fx = " + 5000 * "[", r"got: in line 1: nested more than 32 deep", id="deep"),
        (GOOD.replace("fx = ", "fx = 1e300 #"), r"expected fx from 2.048 to .*, got 1e\+300"),
        (GOOD.replace("fy = ", "fy = 1e-300 #"), r"expected fy from 2.048 to .*, got 1e-300"),
        (
            GOOD.replace("cx = ", "cx = -1e9 #"),
            r"expected cx from -32768 to 32768 .*, got -1000000",
        ),
        (GOOD.replace("width = ", "width = 70000 #"), r"expected width from 1 to 16384 .* 70000"),
        (GOOD.replace("fx = ", f"fx = {10**400} #"), r"got a whole number of some 400 digits"),
        (GOOD.replace("k1 = 0.0", "k1 = 1e300"), r"expected k1 from .*, got 1e\+300"),
        pytest.param(GOOD + 4_000_000 * "#", r"more than 4 MB", id="4 MB"),
    ],
)
def test_a_bad_camera_file_is_refused_with_a_reason(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "camera.toml"
    path.write_text(text)
    with pytest.raises(ScenarioError, match=said) as caught:
        Camera.from_toml(path)
    assert str(caught.value).startswith(str(path))


def test_a_camera_file_may_begin_with_a_byte_order_mark(tmp_path: Path) -> None:
    path = tmp_path / "camera.toml"
    path.write_text("\ufeff" + GOOD)
    assert Camera.from_toml(path) == CHASER


def test_a_missing_or_binary_camera_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "camera.toml"
    with pytest.raises(ScenarioError, match=r"expected a camera as TOML, got: .*No such file"):
        Camera.from_toml(path)
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ScenarioError, match="expected a camera as TOML"):
        Camera.from_toml(path)
    path.unlink()
    os.mkfifo(path)  # whose reader would wait for ever
    with pytest.raises(ScenarioError, match=r"expected a camera as TOML, got: .*a pipe"):
        Camera.from_toml(path)


@pytest.mark.parametrize("fov_deg", [0.0, 180.0, -50.0, float("nan")])
def test_an_impossible_field_of_view_is_refused(fov_deg: float) -> None:
    with pytest.raises(ScenarioError, match="expected fov_deg between 0 and 180"):
        Camera.from_fov(2048, 2048, fov_deg)


@pytest.mark.parametrize("name", ["fx", "fy", "height"])
def test_a_size_of_zero_is_refused(name: str) -> None:
    with pytest.raises(ScenarioError, match=f"expected {name} in px above zero"):
        replace(CHASER, **{name: 0})
