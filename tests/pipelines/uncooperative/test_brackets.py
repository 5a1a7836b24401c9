"""Further exposures of an image are one before anything is looked for, in all frames or in none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.arrays import Floats
from models.errors import DatasetError
from models.estimate import Detections, Estimate
from models.frame import BRACKET, Frame
from models.motion.relative_state import ChaserState
from models.motion.tumble import CAM_FROM_LVLH
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector
from pipelines.detection.exposure_fusion import fused_exposures
from pipelines.uncooperative.knowledge import (
    ImageFrame,
    UncooperativeKnowledge,
    image_frame,
    seen,
)
from pipelines.uncooperative.pipeline import Uncooperative, options_for
from tests.support.point_targets import CAMERA, telescope_target

DETECTOR = Detector()
KNOWLEDGE = UncooperativeKnowledge(
    CAMERA, telescope_target(), CAM_FROM_LVLH, 1.0, detector=DETECTOR
)
CHASER = ChaserState(0.0, np.array([4.2e7, 0.0, 0.0]), np.array([0.0, 3.07e3, 0.0]))
METERED_MS, LEVELS = 2.0, ((0.25, 600), (4.0, 4000))  # the longest is saturated


class Watching:
    """Finds nothing, and notes what it is shown."""

    found_anew = False

    def __init__(self) -> None:
        self.shown = list[ImageFrame]()

    def acquire(self, frame: ImageFrame) -> Estimate:
        self.shown.append(frame)
        return Estimate(frame.index, frame.time_s, reason="none", detections=Detections.none())

    def track(self, frame: ImageFrame, predicted: RigidTransform, covariance: Floats) -> Estimate:
        raise NotImplementedError

    def matched_share(self, frame: ImageFrame, estimate: Estimate) -> float:
        return 0.0


def of_level(level_dn: int) -> np.ndarray:
    return np.full((4, 4), level_dn, dtype=np.uint16)


def framed(index: int, bracketed: bool) -> Frame:
    further = [(of_level(level), factor * METERED_MS) for factor, level in LEVELS]
    image = of_level(2100)
    return image_frame(index, float(index), image, METERED_MS, CHASER, further if bracketed else ())


def test_exposures_are_readings_of_the_frame() -> None:
    frame = framed(0, bracketed=True)
    assert [name for name in frame.readings if name.startswith(BRACKET)] == [
        f"{BRACKET}0",
        f"{BRACKET}1",
    ]
    shown = seen(frame)
    assert isinstance(shown, ImageFrame)
    assert [each.exposure_ms for each in shown.bracket] == [0.5, 8.0]
    plain = seen(framed(0, bracketed=False))
    assert isinstance(plain, ImageFrame)
    assert plain.bracket == ()


@pytest.mark.parametrize("variant", ["best", "paper"])
def test_what_is_looked_at_is_one_image_of_the_longest_exposure(variant: str) -> None:
    """2000 DN in 2 ms and 500 in 0.5 ms: 8000 in 8 ms, beyond the converter's end."""
    watching = Watching()
    pipeline = Uncooperative(KNOWLEDGE, options_for(variant), images=watching)
    for index in range(2):
        assert not pipeline.process(framed(index, bracketed=True))
    for shown in watching.shown:
        assert shown.bracket == ()
        assert shown.exposure_ms == 8.0
        np.testing.assert_allclose(shown.image, DETECTOR.bias_dn + 8000.0, rtol=1e-3)


def test_the_detector_that_the_search_reckons_with_holds_what_it_is_shown() -> None:
    further = seen(framed(0, bracketed=True))
    assert isinstance(further, ImageFrame)
    fused = fused_exposures(further.bracket, DETECTOR)
    assert fused.detector.saturation_dn > 8000.0 > DETECTOR.saturation_dn


@pytest.mark.parametrize("first", [True, False])
def test_a_run_has_them_in_all_frames_or_in_none(first: bool) -> None:
    pipeline = Uncooperative(KNOWLEDGE, options_for("best"), images=Watching())
    pipeline.process(framed(0, bracketed=first))
    with pytest.raises(DatasetError, match="in all frames of a run or in none"):
        pipeline.process(framed(1, bracketed=not first))


def test_without_a_detector_nothing_can_be_made_one() -> None:
    unknown = replace(KNOWLEDGE, detector=None)
    pipeline = Uncooperative(unknown, options_for("best"), images=Watching())
    with pytest.raises(DatasetError, match=r"detector\.toml"):
        pipeline.process(framed(0, bracketed=True))
