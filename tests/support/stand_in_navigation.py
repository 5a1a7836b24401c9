"""A pipeline simple enough to be read at a glance, to try the bench with: no filter worth its name.

It has the face of ``pipelines.uncooperative.pipeline``. From a start it names each point by the
nearest landmark of its last pose and solves; without one it says, from the second image on, that
the target is 30 m ahead along the axes, which is right at time zero only.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from bench.scoring.pairs.cramer_rao import pose_bound
from models.estimate import Detections, Estimate, NoPose, PoseEstimate
from models.motion.relative_state import RelativeState
from models.motion.tumble import CAM_FROM_LVLH
from models.pose import RigidTransform
from models.uncooperative import NavigationEstimate
from pipelines.uncooperative.knowledge import PointFrame, UncooperativeKnowledge

VARIANTS = ("paper", "best")
NEAR_PX = 40.0


@dataclass(frozen=True)
class StandInOptions:
    """Settings of the stand-in."""

    variant: str
    blend: float


def options_for(variant: str) -> StandInOptions:
    """Return a variant's settings: ``best`` blends a pose with its last one."""
    return StandInOptions(variant, 1.0 if variant == "paper" else 0.5)


class Uncooperative:
    """See the module."""

    def __init__(
        self,
        knowledge: UncooperativeKnowledge,
        options: StandInOptions,
        start: RelativeState | None = None,
    ) -> None:
        self.knowledge = knowledge
        self.options = options
        self.state = start
        self.seen = 0

    def process(self, frame: PointFrame) -> NavigationEstimate:
        """Take one frame."""
        self.seen += 1
        if self.state is None:
            return self._search(frame)
        pose = self._solve(frame, self.state.cam_from_target(CAM_FROM_LVLH))
        if isinstance(pose, PoseEstimate):
            lvlh_from_target = CAM_FROM_LVLH.inverse() @ pose.cam_from_target
            blend = self.options.blend
            rho = self.state.rho_in_lvlh
            self.state = RelativeState(
                frame.time_s,
                rho + blend * (lvlh_from_target.translation - rho),
                np.zeros(3),
                lvlh_from_target.rotation,
                np.zeros(3),
            )
        spread = np.diag(np.repeat([0.05, 0.01], 3) ** 2)
        mode = "tracked" if pose else "predicted"
        return NavigationEstimate(frame.index, frame.time_s, mode, pose, self.state, spread, spread)

    def _search(self, frame: PointFrame) -> NavigationEstimate:
        none = Detections(np.zeros((0, 2)), np.zeros((0, 2)), (), ())
        pose: Estimate = NoPose(frame.index, frame.time_s, "one image is not enough", none)
        if self.seen >= 2:
            ahead = CAM_FROM_LVLH @ RigidTransform(np.eye(3), np.array([0.0, 30.0, 0.0]))
            pose = PoseEstimate(frame.index, frame.time_s, ahead, np.eye(6), none, 1.0)
        mode = "acquired" if pose else "searching"
        return NavigationEstimate(frame.index, frame.time_s, mode, pose, None, None, None)

    def _solve(self, frame: PointFrame, guess: RigidTransform) -> Estimate:
        camera, target = self.knowledge.camera, self.knowledge.target
        expected = camera.project(guess @ target.points_in_target)
        apart = np.linalg.norm(expected[:, None] - frame.points_px[None], axis=2)
        nearest = apart.argmin(axis=1)
        named = apart.min(axis=1) < NEAR_PX
        points, pixels = target.points_in_target[named], frame.points_px[nearest[named]]
        matrix = np.array([[camera.fx, 0, camera.cx], [0, camera.fy, camera.cy], [0, 0, 1]])
        turn, shift = cv2.solvePnPRefineLM(
            points, pixels, matrix, None,
            cv2.Rodrigues(guess.rotation)[0], guess.translation.reshape(3, 1).copy(),
        )  # fmt: skip
        pose = RigidTransform(Rotation.from_rotvec(turn.ravel()).as_matrix(), shift.ravel())
        sigma = self.knowledge.sigma_px
        found = Detections(pixels, np.full(pixels.shape, sigma), tuple(np.flatnonzero(named)),
                           (True,) * int(named.sum()))  # fmt: skip
        covariance = pose_bound(camera, points, pose, [sigma, sigma])
        assert covariance is not None
        return PoseEstimate(frame.index, frame.time_s, pose, covariance, found, sigma)
