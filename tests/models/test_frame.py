"""What a pipeline may see: the wall as a type, and readings that are what they say."""

from __future__ import annotations

import pickle
from dataclasses import fields

import numpy as np
import pytest

from models.arrays import AnyArray
from models.errors import DatasetError
from models.estimate import Estimate, PoseEstimate
from models.frame import IMAGE_800, IMAGE_850, Frame, ImageReading, TableReading
from models.onboard import FlightExpectations, OnboardKnowledge, PosePrior
from models.pose import RigidTransform

IMAGE = np.arange(24, dtype=np.uint16).reshape(4, 6)
TABLE = TableReading(("range_m", "sigma_m"), np.array([0.1, 0.2]), np.array([[9.0, 1.0], [8.0, 2]]))
SAID = Estimate(6, 1.0, PoseEstimate(RigidTransform.identity()), mode="tracked")
FRAME = Frame(
    7,
    1.5,
    {
        IMAGE_800: ImageReading(IMAGE, 1.467, 20.0),
        IMAGE_850: ImageReading(IMAGE[::-1], 1.5, 20.0),
        "ranges": TABLE,
        "other": SAID,
    },
)


def test_a_frame_holds_readings_and_times_and_no_truth() -> None:
    """The truth wall as a type: whoever adds a field here argues with these lists."""
    held = {
        kind.__name__: {field.name for field in fields(kind)}
        for kind in (
            Frame,
            ImageReading,
            TableReading,
            OnboardKnowledge,
            PosePrior,
            FlightExpectations,
        )
    }
    assert held == {
        "Frame": {"index", "time_s", "readings"},
        "ImageReading": {"image", "time_s", "exposure_ms"},
        "TableReading": {"columns", "time_s", "rows"},
        "OnboardKnowledge": {
            "camera",
            "detector",
            "markers",
            "prior",
            "wireframe",
            "expectations",
            "psf_sigma_px",
            "sigmas",
            "tables",
        },
        "PosePrior": {"cam_from_target", "sigma_m", "sigma_deg"},
        "FlightExpectations": {
            "cam_from_lvlh",
            "sigma_px",
            "chaser_sigma_m",
            "chaser_sigma_m_s",
            "range_m",
            "inertia_kg_m2",
            "sun_dir_in_inertial",
            "sun_sigma_deg",
            "earth_shines",
            "earth_hides_sun",
            "earth_dir_in_inertial",
            "white_dn_ms",
        },
    }


def test_a_reading_is_taken_by_its_stream_and_kind() -> None:
    assert FRAME.image(IMAGE_850).image[0, 0] == 18
    assert FRAME.table("ranges").column("sigma_m").tolist() == [1.0, 2.0]
    assert FRAME.estimate("other") is SAID


@pytest.mark.parametrize(
    ("kind", "stream", "expected"),
    [
        ("image", "image", "expected an image of the stream 'image', got image_800 .an image., "),
        ("image", "ranges", "expected an image of the stream 'ranges', got .*ranges .a table."),
        ("table", "other", "expected a table of the stream 'other', got .*other .an estimate."),
        ("estimate", IMAGE_800, "expected an estimate of the stream 'image_800'"),
    ],
)
def test_a_reading_that_is_not_there_is_told_with_those_that_are(
    kind: str, stream: str, expected: str
) -> None:
    with pytest.raises(DatasetError, match=f"frame 7: {expected}"):
        getattr(FRAME, kind)(stream)


def test_a_frame_without_readings_says_so() -> None:
    with pytest.raises(DatasetError, match=r"frame 2: .* got no reading at all"):
        Frame(2, 0.0, {}).image(IMAGE_850)


def test_a_column_that_is_not_there_is_told() -> None:
    with pytest.raises(DatasetError, match="column 'range', got a table of range_m, sigma_m"):
        TABLE.column("range")


@pytest.mark.parametrize(
    ("image", "said"),
    [
        (IMAGE.astype(np.uint8), "of uint8"),
        (IMAGE.astype(float), "of float64"),
        (np.zeros((4, 6, 3), np.uint16), r"shape \(4, 6, 3\)"),
    ],
)
def test_images_of_another_kind_are_refused(image: AnyArray, said: str) -> None:
    with pytest.raises(DatasetError, match=rf"expected an image as a .*uint16 array, got .*{said}"):
        ImageReading(image, 0.0, 10.0)


@pytest.mark.parametrize(
    ("time_s", "rows"),
    [
        (np.zeros(2), np.zeros((3, 2))),
        (np.zeros(2), np.zeros((2, 3))),
        (np.zeros(4), np.zeros(4)),
        (np.zeros((2, 1)), np.zeros((2, 2))),
    ],
)
def test_rows_that_do_not_fit_their_columns_are_refused(time_s: AnyArray, rows: AnyArray) -> None:
    with pytest.raises(DatasetError, match="one for each time and with the columns a, b"):
        TableReading(("a", "b"), time_s, rows)


def test_a_frame_goes_to_another_process_and_back() -> None:
    back = pickle.loads(pickle.dumps(FRAME))
    assert (back.index, back.time_s, list(back.readings)) == (7, 1.5, list(FRAME.readings))
    assert back.image(IMAGE_800).time_s == 1.467
    np.testing.assert_array_equal(back.image(IMAGE_850).image, IMAGE[::-1])
    np.testing.assert_array_equal(back.table("ranges").rows, TABLE.rows)
    assert back.estimate("other").mode == "tracked"
