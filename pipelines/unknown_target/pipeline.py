"""The pipeline for an unknown target: tracks and ranges in, motion, shape and inertia out."""

from __future__ import annotations

import numpy as np

from models.camera import Camera
from models.estimate import Estimate, NamedState, PoseEstimate
from models.frame import Frame
from models.pose import RigidTransform
from pipelines.unknown_target.batch_estimator import BatchEstimator
from pipelines.unknown_target.options import UnknownTargetOptions
from pipelines.unknown_target.paper_filter import PaperEstimate, PaperFilter
from pipelines.unknown_target.start_guess import StartGuess
from pipelines.unknown_target.target_estimate import TargetEstimate, of_batch, of_filter
from pipelines.unknown_target.tracked_frame import TrackedFrame, seen

MOTION, SHAPE, INERTIA = "relative_motion", "shape", "inertia"
FEWEST_POINTS = 4  # of which a pose is told: three leave four ways to stand


class UnknownTarget:
    """Follows one target from its first frame on.

    Parameters
    ----------
    camera : Camera
    mean_motion_rad_s : float, rad/s
        Of the target's orbit, taken as circular.
    start : StartGuess
    options : UnknownTargetOptions
    """

    def __init__(
        self,
        camera: Camera,
        mean_motion_rad_s: float,
        start: StartGuess,
        options: UnknownTargetOptions,
    ) -> None:
        self._filter: PaperFilter | None = None
        self._batch: BatchEstimator | None = None
        self._said: PaperEstimate | None = None
        if options.variant == "paper":
            self._filter = PaperFilter(camera, mean_motion_rad_s, start, options.unscented)
        else:
            self._batch = BatchEstimator(camera, mean_motion_rad_s, start, options.batch)

    def take(self, frame: TrackedFrame) -> TargetEstimate:
        """Take in what was seen at one time; return what is known after it."""
        self.add(frame)
        return self.known()

    def add(self, frame: TrackedFrame) -> None:
        """Take in what was seen at one time."""
        if self._filter is not None:
            self._said = self._filter.add(frame)
            return
        assert self._batch is not None
        self._batch.add(frame)

    def known(self) -> TargetEstimate:
        """Return what is known after the last frame; there was one."""
        if self._batch is not None:
            return of_batch(self._batch.solution())
        assert self._said is not None
        return of_filter(self._said)

    def process(self, frame: Frame) -> Estimate:
        """Take in a frame; its pose is that of the target's centre of mass.

        Raises
        ------
        DatasetError
            If a stream is missing or says what cannot be.
        """
        tracked = seen(frame)
        return estimate_of(self.take(tracked), tracked)


def estimate_of(known: TargetEstimate, frame: TrackedFrame) -> Estimate:
    """Return what is known after a frame as the estimate of that frame.

    Parameters
    ----------
    known : TargetEstimate
    frame : TrackedFrame
    """
    clear = known.of_shape
    shape = {
        "points_in_target_m": known.points_in_target[clear],
        "track": np.array(known.names, dtype=np.float64)[clear],
    }
    if known.sigma_m is not None:
        shape["sigma_m"] = known.sigma_m[clear]
    states = {
        MOTION: NamedState(
            {
                "rho_in_lvlh_m": known.rho_in_lvlh,
                "rho_dot_in_lvlh_m_s": known.rho_dot_in_lvlh,
                "omega_in_target_rad_s": known.omega_in_target,
            },
            known.covariance,
        ),
        SHAPE: NamedState(shape),
        INERTIA: NamedState({"inertia_of_trace_1": known.inertia}),
    }
    if len(known.names) < FEWEST_POINTS:
        told = f"{len(known.names)} points known, expected {FEWEST_POINTS} or more"
        return Estimate(frame.index, frame.time_s, reason=told, states=states)
    origin = -frame.R_cam_from_lvlh @ known.rho_in_lvlh
    pose = PoseEstimate(
        RigidTransform(known.R_cam_from_target, origin), _pose_covariance(known, frame)
    )
    mode = "tracked" if len(frame.tracks) else "predicted"
    return Estimate(frame.index, frame.time_s, pose, mode=mode, states=states)


def _pose_covariance(known: TargetEstimate, frame: TrackedFrame) -> np.ndarray:
    """Return (6, 6): of the turn and the place, in camera axes."""
    by_motion = np.zeros((6, 12))
    by_motion[:3, 6:9] = known.R_cam_from_target
    by_motion[3:, :3] = -frame.R_cam_from_lvlh
    covariance = by_motion @ known.covariance @ by_motion.T
    return np.asarray(0.5 * (covariance + covariance.T))
