"""A state that images speak against is given up within three; what is undecided stays so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.estimate import Detections, Estimate, PoseEstimate
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.relative_state import relative_state
from models.motion.tumble import CAM_FROM_LVLH, Tumble
from models.pose import RigidTransform
from pipelines.acquisition.from_image import FoundPose, ImageAcquisition
from pipelines.filters.rotation_process import turn_between
from pipelines.tracking.edge_fit import EdgeFit, EdgeSteps
from pipelines.tracking.model_edges import EdgeSamples
from pipelines.tracking.pose_check import NO_FIT
from pipelines.uncooperative.image_pose_finder import undecided
from pipelines.uncooperative.knowledge import ImageFrame, UncooperativeKnowledge
from pipelines.uncooperative.pipeline import Uncooperative, options_for
from tests.support.point_targets import CAMERA, telescope_target

KNOWLEDGE = UncooperativeKnowledge(CAMERA, telescope_target(), CAM_FROM_LVLH, 1.0)
TUMBLE = Tumble(
    KeplerOrbit(7.1431e6, 1.4e-4, np.deg2rad(98.2), 1.38, 1.5, 0.0),
    np.array([0.0, 30.0, 0.0]),
    np.array([0.0, 1e-4, 0.0]),
    np.deg2rad([0.5, -0.3, 0.2]),
    np.diag([7000.0, 129000.0, 131000.0]),
    60.0,
)
SIGMA = np.array([*3 * [np.deg2rad(0.3)], 0.01, 0.01, 0.05])
COVARIANCE = np.diag(SIGMA**2)
STEP_S = 3.0
FRAMES = 12
WRONG_UNTIL = 4  # frames at which all that is found is the wrong pose
WRONG_DEG = 25.0
MOST_WRONG = 3  # images in a row that speak against a state


def pose_at(time_s: float, off_deg: float = 0.0) -> RigidTransform:
    turn = np.deg2rad(off_deg) * np.array([0.0, 1.0, 0.0])
    return TUMBLE.cam_from_target(time_s).perturbed(turn, np.zeros(3))


class Scripted:
    """Finds a wrong pose up to a frame, then the right one; anew, or near the prediction."""

    def __init__(self, anew: bool) -> None:
        self._anew = anew
        self.found_anew = False

    def acquire(self, frame: ImageFrame) -> Estimate:
        return self._found(frame)

    def track(self, frame: ImageFrame, predicted: RigidTransform, covariance: Floats) -> Estimate:
        self.found_anew = self._anew and frame.index >= WRONG_UNTIL
        return self._found(frame)

    def matched_share(self, frame: ImageFrame, estimate: Estimate) -> float:
        return 1.0

    def _found(self, frame: ImageFrame) -> Estimate:
        off_deg = WRONG_DEG if frame.index < WRONG_UNTIL else 0.0
        pose = PoseEstimate(pose_at(frame.time_s, off_deg), COVARIANCE, 0.5)
        return Estimate(frame.index, frame.time_s, pose, detections=Detections.none())


def attitudes_deg(finder: Scripted) -> list[float]:
    """Return by how much the state of each frame is off."""
    options = replace(options_for("best"), image_share_to_doubt=0.0)
    pipeline = Uncooperative(KNOWLEDGE, options, images=finder)
    off = []
    for index in range(FRAMES):
        time_s = STEP_S * index
        image = np.zeros((2, 2), dtype=np.uint16)
        frame = ImageFrame(index, time_s, image, TUMBLE.chaser_state(time_s))
        state = relative_state(pipeline.process_seen(frame))
        assert state is not None
        turn = turn_between(state.cam_from_target(CAM_FROM_LVLH).rotation, pose_at(time_s).rotation)
        off.append(float(np.rad2deg(np.linalg.norm(turn))))
    return off


def test_a_sure_pose_found_anew_is_believed_at_once() -> None:
    off = attitudes_deg(Scripted(anew=True))
    assert min(off[:WRONG_UNTIL]) > 0.9 * WRONG_DEG
    assert max(off[WRONG_UNTIL:]) < 1.0


def test_filters_that_refuse_pose_after_pose_start_again() -> None:
    off = np.array(attitudes_deg(Scripted(anew=False)))
    assert off[WRONG_UNTIL] > 10.0  # refused, so that the case is what it says
    assert (off[WRONG_UNTIL + MOST_WRONG - 1 :] < 1.0).all()


@pytest.mark.parametrize(("apart_deg", "expected"), [(5.0, True), (180.0, False)])
def test_a_prediction_decides_only_between_poses_that_it_tells_apart(
    apart_deg: float, expected: bool
) -> None:
    """Six degrees of uncertainty tell half a turn from none, and not five degrees."""
    truth = pose_at(0.0)
    turn = Rotation.from_rotvec(np.deg2rad([0.0, apart_deg, 0.0])).as_matrix()
    other = RigidTransform(turn @ truth.rotation, truth.translation)
    rivals = tuple(laid(pose) for pose in (truth, other))
    wide = np.diag([*3 * [np.deg2rad(6.0)], 0.1, 0.1, 0.3]) ** 2
    assert (
        undecided(ImageAcquisition(None, "two fit alike", rivals=rivals), truth, wide) is expected
    )
    assert not undecided(ImageAcquisition(rivals[0], ""), truth, wide)


def laid(pose: RigidTransform) -> FoundPose:
    """Return a fit of which the pose alone matters."""
    none = np.zeros(0)
    samples = EdgeSamples(
        np.zeros((0, 3)), np.zeros((0, 2)), np.zeros((0, 2)), none.astype(int), none.astype(bool)
    )
    steps = EdgeSteps(none, none.astype(bool))
    return FoundPose(EdgeFit(pose, samples, steps, none, np.eye(6), 0.5), NO_FIT)
