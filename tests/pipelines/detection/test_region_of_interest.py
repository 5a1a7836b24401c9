from __future__ import annotations

import numpy as np

from models.camera import camera_preset
from pipelines.detection.region_of_interest import region_of_interest

CAMERA = camera_preset("eye_in_hand")


def test_half_the_larger_extent_is_added_on_every_side() -> None:
    predicted = np.array([[900.0, 1000.0], [1100.0, 1050.0], [1000.0, 1020.0]])
    region = region_of_interest(CAMERA, predicted, (0.5, 0.5))
    assert region is not None
    # Equation 15: the extents are 200 and 50 px, so 100 px are added to both axes.
    assert (region.left, region.right) == (800, 1201)
    assert (region.top, region.bottom) == (900, 1151)


def test_it_stays_within_the_image() -> None:
    region = region_of_interest(CAMERA, np.array([[5.0, 5.0], [2040.0, 900.0]]), (0.5, 0.5))
    assert region is not None
    assert (region.left, region.top, region.right) == (0, 0, 2048)


def test_markers_out_of_sight_give_none() -> None:
    assert region_of_interest(CAMERA, np.full((3, 2), np.nan), (0.5, 0.5)) is None
    assert region_of_interest(CAMERA, np.array([[-900.0, 5.0], [-880.0, 6.0]]), (0.5, 0.5)) is None
