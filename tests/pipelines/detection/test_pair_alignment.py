"""The motion within a pair is taken out before the images are subtracted."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arrays import Floats
from models.sensors.camera_chip import Detector
from pipelines.detection.disc_fit import ExpectedBlur, fit_disc
from pipelines.detection.pair_alignment import aligned_patch

SIZE, RADIUS = 41, 6.0
CENTRE = np.array([20.3, 19.8])
DETECTOR = Detector()
BLUR = ExpectedBlur(0.5, 0.25, 0.5)
LEVEL = DETECTOR.saturation_dn


def scene(centre: Floats, disc_dn: float, surround_dn: float) -> Floats:
    """Return a disc on a bright plate, area-sampled and blurred by half a pixel."""
    fine = (np.arange(SIZE * 16) + 0.5) / 16 - 0.5
    inside = (fine[None, :] - centre[0]) ** 2 + (fine[:, None] - centre[1]) ** 2 < RADIUS**2
    kernel = np.exp(-0.5 * (np.arange(-48, 49) / 8.0) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        inside = np.apply_along_axis(np.convolve, axis, inside.astype(float), kernel, "same")
    share = inside.reshape(SIZE, 16, SIZE, 16).mean(axis=(1, 3))
    return DETECTOR.bias_dn + surround_dn + (disc_dn - surround_dn) * share


def centre_error(motion: Floats, compensated: bool) -> Floats:
    """Fit a marker on a sunlit plate that is ten times brighter than the marker's dark face."""
    image_850 = scene(CENTRE, 1500.0, 200.0)
    image_800 = scene(CENTRE - motion, 20.0, 200.0)
    believed = motion if compensated else np.zeros(2)
    half = np.full(2, RADIUS)
    patch = aligned_patch(image_800, image_850, CENTRE, half, believed, LEVEL)
    shape = RADIUS**2 * np.eye(2)
    at = CENTRE - patch.corner_px
    fit = fit_disc(patch.image_800, patch.image_850, at, shape, DETECTOR, LEVEL, BLUR)
    assert fit is not None
    return np.asarray(fit.parameters.centre_px)


def test_a_sunlit_surround_pulls_the_centre_unless_the_motion_is_taken_out() -> None:
    motion = np.array([0.3, -0.2])
    pulled, freed = centre_error(motion, compensated=False), centre_error(motion, compensated=True)
    contrast = 180.0 / 1480.0  # of plate over dark face, over the marker's own signal
    a_quarter = 0.25  # the pull is shared with the fit's other parameters
    np.testing.assert_allclose(pulled, -contrast * motion, rtol=a_quarter)
    assert np.linalg.norm(freed) < 0.15 * np.linalg.norm(pulled)


@given(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5))
def test_a_linear_image_is_moved_exactly(x: float, y: float) -> None:
    v, u = np.mgrid[0:SIZE, 0:SIZE].astype(float)
    image = 500.0 + 7.0 * u - 3.0 * v
    patch = aligned_patch(image, image, CENTRE, np.full(2, 2.0), np.array([x, y]), LEVEL)
    inner = (slice(3, -3), slice(3, -3))
    expected = patch.image_850 - 7.0 * x + 3.0 * y
    np.testing.assert_allclose(patch.image_800[inner], expected[inner], atol=1e-9)


def test_without_motion_nothing_changes() -> None:
    image = scene(CENTRE, 1500.0, 200.0)
    patch = aligned_patch(image, image, CENTRE, np.full(2, RADIUS), np.zeros(2), LEVEL)
    np.testing.assert_array_equal(patch.image_800, patch.image_850)


@pytest.mark.parametrize("corner", [(0.0, 0.0), (40.0, 40.0), (-5.0, 60.0)])
def test_at_the_images_edge_there_is_still_a_patch(corner: tuple[float, float]) -> None:
    image = scene(CENTRE, 1500.0, 200.0)
    at = np.array(corner)
    patch = aligned_patch(image, image, at, np.full(2, 4.0), np.array([0.4, 0.4]), LEVEL)
    assert patch.image_800.size > 0
    assert patch.image_800.shape == patch.image_850.shape


def test_saturation_moves_along() -> None:
    image = np.full((SIZE, SIZE), 500.0)
    image[20, 20] = 4095.0
    patch = aligned_patch(image, image, CENTRE, np.full(2, 4.0), np.array([0.5, 0.0]), LEVEL)
    assert np.count_nonzero(patch.image_800 >= LEVEL) == 2
