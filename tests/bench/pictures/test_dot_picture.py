"""A colour image laid open: what is lost stands in the region of interest by name."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.pictures.dot_picture import draw
from bench.pictures.frame_record import FrameRecord
from bench.pictures.marker_overlay import DETECTION_RED
from models.estimate import Detections, Estimate, PoseEstimate
from models.frame import IMAGE, Frame, ImageReading
from models.onboard import OnboardKnowledge
from models.spacecraft.grasp_markers import GRASP_MARKERS
from tests.support.synthetic_dots import CAMERA, DETECTOR, DotScene, facing, raw_image

POSE = facing(0.8, [3.0, -4.0, 5.0])
RAW = raw_image(DotScene(POSE, coarse=4))


def picture_of(used: tuple[bool, bool, bool], mode: str) -> NDArray[np.uint8]:
    places = CAMERA.project(POSE @ GRASP_MARKERS.points_in_target)
    seen = Detections(places, np.full(places.shape, 0.1), (0, 1, 2), used)
    return draw(
        FrameRecord(
            frame=Frame(0, 0.0, {IMAGE: ImageReading(RAW, 0.0, 3.0)}),
            exposure_ms=3.0,
            onboard=OnboardKnowledge(CAMERA, DETECTOR, GRASP_MARKERS),
            variant="best",
            estimate=Estimate(0, 0.0, PoseEstimate(POSE), detections=seen, mode=mode),
            truth=None,
        )
    )


def reds_beside(picture: NDArray[np.uint8]) -> int:
    """Count what is red in the last third of the images, where the region is."""
    part = picture[: picture.shape[0] // 2, 2 * picture.shape[1] // 3 :].astype(int)
    return int((np.abs(part - np.array(DETECTION_RED)).max(axis=-1) < 30).sum())


def test_a_lost_dot_is_named_in_the_region_of_interest() -> None:
    """The circles are the same; beneath a dot that is not used stand words in red."""
    whole, lost = picture_of((True,) * 3, "dots"), picture_of((False, True, True), "outline")
    assert whole.shape == lost.shape
    assert reds_beside(lost) > reds_beside(whole) + 60
    assert (whole[:120] != lost[:120]).any()  # the heading says whose pose it is
