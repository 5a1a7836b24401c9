from __future__ import annotations

import numpy as np
import pytest

from models.sensors.bayer_mosaic import mosaicked
from models.sensors.camera_chip import Detector
from pipelines.detection.bayer_grey import LUMA, demosaiced_grey, quad_grey

DETECTOR = Detector(mosaic="rggb")
ROUNDING_DN = 1.0  # the mosaic is of whole numbers


def raw_of(red: float, green: float, blue: float) -> np.ndarray:
    planes = [np.full((12, 16), level) for level in (red, green, blue)]
    return np.rint(mosaicked(planes) + DETECTOR.bias_dn).astype(np.uint16)


def test_the_luma_of_an_even_field_is_that_of_its_colour() -> None:
    grey = demosaiced_grey(raw_of(900.0, 500.0, 200.0), DETECTOR)
    assert grey.shape == (12, 16)
    assert grey == pytest.approx(np.dot(LUMA, [900.0, 500.0, 200.0]), abs=ROUNDING_DN)


def test_quads_are_means_of_four_pixels() -> None:
    grey = quad_grey(raw_of(900.0, 500.0, 200.0), DETECTOR)
    assert grey.shape == (6, 8)
    assert grey == pytest.approx((900.0 + 2.0 * 500.0 + 200.0) / 4.0, abs=ROUNDING_DN)


def test_a_camera_without_filters_is_grey_already() -> None:
    raw = np.arange(100, 196, dtype=np.uint16).reshape(8, 12)
    assert np.array_equal(demosaiced_grey(raw, Detector()), raw.astype(np.float32) - 100.0)
