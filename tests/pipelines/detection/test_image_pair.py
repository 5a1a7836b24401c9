from __future__ import annotations

import numpy as np
import pytest

from models.errors import DatasetError
from models.frame import IMAGE_800, Frame, ImageReading
from pipelines.detection.image_pair import ImagePair, image_pair
from tests.support.synthetic_pair import pair_frame

IMAGE = np.arange(24, dtype=np.uint16).reshape(4, 6)


def test_a_pair_is_a_frames_two_images() -> None:
    pair = image_pair(pair_frame(7, 1.0, IMAGE, IMAGE + 1))
    np.testing.assert_array_equal(pair.image_850, pair.image_800 + 1)


def test_images_of_two_sizes_are_no_pair() -> None:
    said = r"expected two images of one size, got \(4, 6\) at 800 nm and \(3, 6\) at 850 nm"
    with pytest.raises(DatasetError, match="^" + said):
        ImagePair(IMAGE, IMAGE[:3])
    with pytest.raises(DatasetError, match="^frame 7: " + said):
        image_pair(pair_frame(7, 1.0, IMAGE, IMAGE[:3]))


def test_half_a_pair_is_told() -> None:
    frame = Frame(7, 1.0, {IMAGE_800: ImageReading(IMAGE, 1.0, 20.0)})
    with pytest.raises(DatasetError, match=r"^frame 7: expected an image of .*'image_850'"):
        image_pair(frame)
