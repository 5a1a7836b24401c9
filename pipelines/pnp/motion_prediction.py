"""The next pose from the last ones: as it was, or at constant velocity, with its uncertainty."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.pose import RigidTransform, euler_321_from_rotation
from pipelines.pnp.flight_knowledge import FlightKnowledge
from pipelines.pnp.predicted_pose import PredictedPose
from pipelines.pnp.projection_jacobian import turn_from_euler_rates

Prediction: TypeAlias = Literal["last_pose", "constant_velocity"]

LONGEST_REACH = 20.0  # an extrapolation beyond this many of its baselines is held there


class PredictionOptions(Protocol):
    """What is read of a pipeline's settings; ``pipelines.chaser_fixed.options`` tells of each."""

    @property
    def prediction(self) -> Prediction:
        """Guess of the next pose: the last one, or the last two carried on."""

    @property
    def acceleration_m_s2(self) -> float:
        """1-sigma departure from constant velocity, in translation."""

    @property
    def acceleration_deg_s2(self) -> float:
        """The same in rotation."""

    @property
    def velocity_m_s(self) -> float:
        """1-sigma of the velocity while only one pose is known."""

    @property
    def velocity_deg_s(self) -> float:
        """The same of the rate."""


@dataclass(frozen=True, eq=False)
class _TimedPose:
    time_s: float
    pose: RigidTransform
    covariance: Floats


def prior_covariance(knowledge: FlightKnowledge) -> Floats:
    """Turn the prior's sigmas in (alpha, beta, gamma) and t into a (6, 6) covariance."""
    euler_rad = np.deg2rad(euler_321_from_rotation(knowledge.prior.rotation))
    turn = turn_from_euler_rates(euler_rad) * np.deg2rad(knowledge.prior_sigma_deg)
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = turn @ turn.T
    covariance[3:, 3:] = np.diag(knowledge.prior_sigma_m**2)
    return covariance


class MotionPrediction:
    """Remembers the last two poses; before the first one, the prior, surest at the first frame."""

    def __init__(self, knowledge: FlightKnowledge, options: PredictionOptions) -> None:
        self._prior = knowledge.prior
        self._prior_covariance = prior_covariance(knowledge)
        self._options = options
        self._prior_s: float | None = None
        self._known: deque[_TimedPose] = deque(maxlen=2)
        self._lost_frames = 0

    def found(self, time_s: float, pose: RigidTransform, covariance: Floats) -> None:
        """Take in a pose.

        Parameters
        ----------
        time_s : float, s
        pose : RigidTransform
            ``cam_from_target``.
        covariance : (6, 6) array, rad and m
            Rotation first, as in ``RigidTransform.perturbed``.
        """
        if self._known and time_s <= self._known[-1].time_s:
            self._known.clear()  # time stood still or ran back: there is no velocity
        self._known.append(_TimedPose(time_s, pose, covariance))
        self._lost_frames = 0

    def lost(self) -> None:
        """Take in that a frame gave no pose."""
        self._lost_frames += 1

    def predict(self, time_s: float) -> PredictedPose:
        """Predict the pose at a time; the first time asked for is that of the prior."""
        if not self._known:
            self._prior_s = time_s if self._prior_s is None else self._prior_s
            since_s = max(time_s - self._prior_s, 0.0)
            grown = self._prior_covariance + self._velocity_covariance(since_s)
            return PredictedPose(self._prior, grown, self._lost_frames)
        last = self._known[-1]
        ahead_s = max(time_s - last.time_s, 0.0)
        if self._options.prediction == "last_pose" or len(self._known) == 1:
            still = last.covariance + self._velocity_covariance(ahead_s)
            return PredictedPose(last.pose, still, self._lost_frames)
        return self._carried_on(ahead_s)

    def shortly_before(
        self, time_s: float, pose: RigidTransform, ago_s: float
    ) -> RigidTransform | None:
        """Return the pose ``ago_s`` before ``pose``, at the mean velocity since the last one.

        None before there is a last pose, or where time stood still: the velocity is unknown.

        Parameters
        ----------
        time_s : float, s
            Of ``pose``.
        pose : RigidTransform
            ``cam_from_target``.
        ago_s : float, s
        """
        if not self._known or time_s <= self._known[-1].time_s:
            return None
        last = self._known[-1]
        share = min(ago_s / (time_s - last.time_s), 1.0)
        turn = Rotation.from_matrix(last.pose.rotation @ pose.rotation.T).as_rotvec()
        return pose.perturbed(share * turn, share * (last.pose.translation - pose.translation))

    def with_stamp_error(
        self, time_s: float, pose: RigidTransform, covariance: Floats, sigma_s: float
    ) -> Floats:
        """Return a pose's covariance widened by what its stamp may be off; before ``found``.

        The pose is that of another instant: it errs by the rate times the stamp's error. The rate
        is the mean since the last pose; where there is none, any that the target may have.

        Parameters
        ----------
        time_s : float, s
            As stamped.
        pose : RigidTransform
            ``cam_from_target``.
        covariance : (6, 6) array, rad and m
            Of the pose at the instant at which it was seen, rotation first.
        sigma_s : float, s
            1-sigma of the stamp; with 0 the covariance stays as it is.

        Returns
        -------
        (6, 6) array, rad and m
            What is added is of rank one where the rate is known.
        """
        if sigma_s == 0.0:
            return covariance
        if not self._known or time_s <= self._known[-1].time_s:
            return covariance + self._velocity_covariance(sigma_s)
        last = self._known[-1]
        turn = Rotation.from_matrix(pose.rotation @ last.pose.rotation.T).as_rotvec()
        moved = np.concatenate([turn, pose.translation - last.pose.translation])
        off = sigma_s / (time_s - last.time_s) * moved
        return np.asarray(covariance + np.outer(off, off))

    def _carried_on(self, ahead_s: float) -> PredictedPose:
        before, last = self._known
        baseline_s = last.time_s - before.time_s
        ratio = min(ahead_s / baseline_s, LONGEST_REACH)
        turn = Rotation.from_matrix(last.pose.rotation @ before.pose.rotation.T).as_rotvec()
        shift = last.pose.translation - before.pose.translation
        pose = last.pose.perturbed(ratio * turn, ratio * shift)
        covariance = (1.0 + ratio) ** 2 * last.covariance + ratio**2 * before.covariance
        # A constant acceleration a leaves a / 2 * ahead * (ahead + baseline).
        lever = 0.5 * ahead_s * (ahead_s + baseline_s)
        covariance = covariance + self._process(
            self._options.acceleration_deg_s2 * lever, self._options.acceleration_m_s2 * lever
        )
        return PredictedPose(pose, covariance, self._lost_frames)

    def _velocity_covariance(self, ahead_s: float) -> Floats:
        return self._process(
            self._options.velocity_deg_s * ahead_s, self._options.velocity_m_s * ahead_s
        )

    @staticmethod
    def _process(sigma_deg: float, sigma_m: float) -> Floats:
        return np.diag([*3 * [np.deg2rad(sigma_deg) ** 2], *3 * [sigma_m**2]])
