from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from models.arrays import AnyArray
from models.errors import DatasetError
from models.frame import Frame
from models.markers import MarkerPattern
from pipelines.chaser_fixed.knowledge import FlightKnowledge

IMAGE = np.zeros((4, 6), np.uint16)
POINTS = np.array([[0.0, 0.0, 0.0], [0.3, 0.4, 0.0], [0.0, 2.0, 0.0]])
UP = np.tile([0.0, 0.0, 1.0], (3, 1))


def test_a_frame_holds_images_and_times_and_no_truth() -> None:
    """The truth wall as a type: whoever adds a field here argues with this list."""
    assert {field.name for field in fields(Frame)} == {
        "index",
        "time_s",
        "image_800",
        "image_850",
        "exposure_ms",
    }
    assert {field.name for field in fields(FlightKnowledge)} == {
        "camera",
        "detector",
        "markers",
        "prior",
        "prior_sigma_m",
        "prior_sigma_deg",
    }


@pytest.mark.parametrize(
    ("image_800", "image_850", "said"),
    [
        (IMAGE.astype(np.uint8), IMAGE, "frame 7: expected image_800 .* of uint8"),
        (IMAGE, IMAGE.astype(float), "frame 7: expected image_850 .* of float64"),
        (IMAGE, np.zeros((4, 6, 3), np.uint16), r"image_850 .* shape \(4, 6, 3\)"),
        (IMAGE, IMAGE[:3], r"one size, got \(4, 6\) at 800 nm and \(3, 6\) at 850 nm"),
    ],
)
def test_images_of_another_kind_are_refused(
    image_800: AnyArray, image_850: AnyArray, said: str
) -> None:
    with pytest.raises(DatasetError, match=said):
        Frame(7, 0.0, image_800, image_850, 10.0)


def test_the_nearest_two_markers() -> None:
    pattern = MarkerPattern(("a", "b", "c"), POINTS, UP, 0.01)
    assert len(pattern) == 3
    assert pattern.min_separation_m == pytest.approx(0.5)
    assert MarkerPattern(("a",), POINTS[:1], UP[:1], 0.01).min_separation_m == np.inf


@pytest.mark.parametrize(
    ("names", "points", "normals", "radius_m", "said"),
    [
        (("a", "b"), POINTS, UP, 0.01, r"2 points and normals of shape \(2, 3\)"),
        (("a", "b", "c"), POINTS, UP[:2], 0.01, r"\(2, 3\)"),
        (("a", "b", "a"), POINTS, UP, 0.01, "each marker's name once, got a, b, a"),
        (("a", "b", "c"), POINTS * np.nan, UP, 0.01, "finite points"),
        (("a", "b", "c"), POINTS, UP, 0.0, "radius in m above zero, got a radius of 0.0"),
        (("a", "b", "c"), POINTS, UP, np.nan, "radius in m above zero"),
        (("a", "b", "c"), POINTS, 2.0 * UP, 0.01, "length one, got lengths"),
        (("a", "b", "c"), POINTS, UP * np.nan, 0.01, "length one"),
    ],
)
def test_a_pattern_that_cannot_be_is_refused(
    names: tuple[str, ...], points: AnyArray, normals: AnyArray, radius_m: float, said: str
) -> None:
    with pytest.raises(ValueError, match=said):
        MarkerPattern(names, points, normals, radius_m)
