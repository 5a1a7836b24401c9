"""A pipeline simple enough to be read at a glance, to try the bench with: no filter worth its name.

It has the face of ``pipelines.uncooperative.pipeline``. From a start it names each point by the
nearest landmark of its last pose and solves; without one it says, from the second image on, that
the target is 30 m ahead along the axes, which is right at time zero only.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from bench.scoring.pairs.cramer_rao import pose_bound
from models.estimate import Detections, Estimate, PoseEstimate
from models.frame import Frame
from models.motion.relative_state import RelativeState
from models.motion.tumble import CAM_FROM_LVLH
from models.onboard import OnboardKnowledge
from models.pose import RigidTransform
from pipelines.pipeline import RegisteredPipeline
from pipelines.uncooperative.knowledge import PointFrame, Seen, UncooperativeKnowledge, seen

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

    def process(self, frame: Frame) -> Estimate:
        """Take one frame of points."""
        self.seen += 1
        shown = seen(frame)
        if self.state is None:
            return self._search(shown)
        assert isinstance(shown, PointFrame)
        estimate = self._solve(shown, self.state.cam_from_target(CAM_FROM_LVLH))
        assert estimate.pose is not None
        lvlh_from_target = CAM_FROM_LVLH.inverse() @ estimate.pose.cam_from_target
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
        return replace(estimate, mode="tracked", states=self.state.named(spread, spread))

    def _search(self, frame: Seen) -> Estimate:
        if self.seen < 2:
            return Estimate(
                frame.index,
                frame.time_s,
                reason="one image is not enough",
                detections=Detections.none(),
                mode="searching",
            )
        ahead = CAM_FROM_LVLH @ RigidTransform(np.eye(3), np.array([0.0, 30.0, 0.0]))
        pose = PoseEstimate(ahead, np.eye(6), 1.0)
        return Estimate(
            frame.index, frame.time_s, pose, detections=Detections.none(), mode="acquired"
        )

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
        said = PoseEstimate(pose, covariance, sigma)
        return Estimate(frame.index, frame.time_s, said, detections=found)


def made(onboard: OnboardKnowledge, variant: str) -> Uncooperative:
    """Make one from what is on board, for the registry."""
    return Uncooperative(UncooperativeKnowledge.of(onboard), options_for(variant))


PIPELINE = RegisteredPipeline(
    name="stand_in",
    make=made,
    streams=("image", "chaser_orbit"),
    variants=VARIANTS,
    settings=lambda variant: repr(options_for(variant)),
    label=lambda variant: variant,
)
