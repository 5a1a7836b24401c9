"""A known target in the Earth's shadow: predicted ever less surely, not lost, and found again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.arrays import Floats
from models.camera import Camera
from models.estimate import Detections, Estimate, PoseEstimate
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.tumble import CAM_FROM_LVLH, Tumble
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector
from models.spacecraft.wireframes import wireframe_by_name
from pipelines.uncooperative.image_pose_finder import NO_LIGHT, ImagePoseFinder
from pipelines.uncooperative.knowledge import ImageFrame, UncooperativeKnowledge
from pipelines.uncooperative.pipeline import Uncooperative, options_for

ORBIT = KeplerOrbit.from_elements_deg(
    a_km=7143.1,
    e=1.4e-4,
    i_deg=98.2,
    raan_deg=79.2,
    argument_of_perigee_deg=85.9,
    true_anomaly_deg=0.0,
)
INTO_SHADOW = np.array([0.8376, 0.0704, -0.5417])  # of that orbit: umbra from 240 s to 840 s
CAMERA = Camera(256, 256, 274.5, 274.5, 127.5, 127.5)
STEP_S, FRAMES, UMBRA = 60.0, 20, range(4, 15)
KNOWLEDGE = UncooperativeKnowledge(
    CAMERA,
    wireframe_by_name("xmm"),
    CAM_FROM_LVLH,
    2.0,
    detector=Detector(),
    sun_dir_in_inertial=INTO_SHADOW / np.linalg.norm(INTO_SHADOW),
    earth_hides_sun=True,
)
TUMBLE = Tumble(
    ORBIT,
    np.array([0.0, 30.0, 0.0]),
    np.zeros(3),
    np.deg2rad([0.2, 0.05, 0.1]),
    np.diag([1.0, 1.0, 1.0]),
    STEP_S * FRAMES,
)
SIGMA_RAD, SIGMA_M = np.deg2rad(0.5), 0.02


class SeenByDay:
    """Finds the true pose where there is light, and says what ours says where there is none."""

    found_anew = False

    def __init__(self) -> None:
        self.ours = ImagePoseFinder(KNOWLEDGE, options_for("best"))

    def acquire(self, frame: ImageFrame) -> Estimate:
        if KNOWLEDGE.sunlit_share(frame.chaser) <= 0.0:
            return self.ours.acquire(frame)
        covariance = np.diag([*3 * [SIGMA_RAD], *3 * [SIGMA_M]]) ** 2
        pose = PoseEstimate(TUMBLE.cam_from_target(frame.time_s), covariance, 0.5)
        return Estimate(frame.index, frame.time_s, pose, detections=Detections.none())

    def track(self, frame: ImageFrame, predicted: RigidTransform, covariance: Floats) -> Estimate:
        if KNOWLEDGE.sunlit_share(frame.chaser) <= 0.0:
            return self.ours.track(frame, predicted, covariance)
        return self.acquire(frame)

    def matched_share(self, frame: ImageFrame, estimate: Estimate) -> float:
        return 1.0


def frame_at(index: int) -> ImageFrame:
    bias = np.full((CAMERA.height, CAMERA.width), Detector().bias_dn, dtype=np.uint16)
    return ImageFrame(
        index, STEP_S * index, bias, TUMBLE.chaser_state(STEP_S * index), exposure_ms=4.0
    )


@pytest.fixture(scope="module")
def said() -> list[Estimate]:
    options = replace(options_for("best"), image_share_to_doubt=0.0)
    pipeline = Uncooperative(KNOWLEDGE, options, images=SeenByDay())
    return [pipeline.process_seen(frame_at(index)) for index in range(FRAMES)]


def test_frames_of_the_umbra_are_lost_with_a_reason_and_predicted(said: list[Estimate]) -> None:
    dark = [each for each in said if each.reason == NO_LIGHT]
    assert [each.frame for each in dark] == [*UMBRA]
    for each in dark:
        assert each.pose is None
        assert each.mode == "predicted"


def test_what_is_not_seen_is_known_ever_less(said: list[Estimate]) -> None:
    for name in said[UMBRA.start].states:
        sizes = [np.trace(said[index].states[name].covariance) for index in UMBRA]
        assert (np.diff(sizes) > 0.0).all()


def test_with_the_light_it_goes_on_from_what_was_predicted(said: list[Estimate]) -> None:
    after = said[UMBRA.stop :]
    assert {each.mode for each in after[1:]} == {"tracked"}
    assert all(each.pose is not None for each in after[1:])


def test_without_a_state_it_searches_and_says_why() -> None:
    pipeline = Uncooperative(KNOWLEDGE, options_for("best"), images=SeenByDay())
    estimate = pipeline.process_seen(frame_at(8))
    assert (estimate.mode, estimate.reason) == ("searching", NO_LIGHT)


def test_a_lamp_in_the_dark_is_looked_at() -> None:
    frame = frame_at(8)
    lit = frame.image.copy()
    lit[100:150, 100:150] += 1000
    pipeline = Uncooperative(KNOWLEDGE, options_for("best"))
    assert pipeline.process_seen(replace(frame, image=lit)).reason != NO_LIGHT
    assert pipeline.process_seen(frame).reason == NO_LIGHT
