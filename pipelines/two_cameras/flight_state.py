"""The chaser-fixed camera's pose and rates, and what lasts in all that tells of them.

Of a camera's stated covariance C = L L' some lasts, for a calibration is wrong alike in all frames,
and some is drawn anew, as where a shadow's edge moves over a board; a pose does not say how much.
So both are allowed for: error = v + sqrt(share) L b with v of covariance C, and b, six numbers of
unit variance, is carried beside the state, fading slowly. Frames that err alike make no pose surer
than they should, and a pose that errs unlike the last is not refused for it.

Source: a Kalman filter of a state beside first-order Gauss-Markov errors (Gelb, Applied Optimal
Estimation, 1974, sections 3.6 and 4.2); turns multiply, and the pose is the one linearised about
(Lefferts, Markley and Shuster, J. Guidance 5, 1982).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.estimate import PoseEstimate
from models.pose import RigidTransform
from pipelines.filters import kalman
from pipelines.two_cameras.arm_chain import POSE, difference

CameraName: TypeAlias = Literal["hand", "chaser"]

RATES = slice(POSE, 2 * POSE)
LASTING: dict[CameraName, slice] = {
    "hand": slice(2 * POSE, 3 * POSE),
    "chaser": slice(3 * POSE, 4 * POSE),
}
ARM = slice(4 * POSE, None)
UNKNOWN = np.array([*3 * [1.0], *3 * [10.0]])  # rad and m, 1 sigma: tells nothing beside a camera


@dataclass(frozen=True)
class FlightOptions:
    """What is assumed of motion and cameras.

    Attributes
    ----------
    velocity_m_s, velocity_deg_s : float
        1 sigma of the rates before anything is known.
    acceleration_m_s2, acceleration_deg_s2 : float
        1 sigma of the departure from even motion.
    acceleration_lasts_s : float, s
        How long one such departure lasts.
    lasting_share : float
        Of a pose's stated covariance, what may be alike from frame to frame.
    lasting_s : float, s
        Time in which that fades to 1/e: geometry changes by then.
    """

    velocity_m_s: float = 0.03
    velocity_deg_s: float = 0.1
    acceleration_m_s2: float = 2e-4
    acceleration_deg_s2: float = 2e-3
    acceleration_lasts_s: float = 10.0
    lasting_share: float = 0.9
    lasting_s: float = 100.0


@dataclass(frozen=True, eq=False)
class FlightState:
    """What is known at one time.

    Attributes
    ----------
    time_s : float, s
    pose : RigidTransform
        ``cam_from_target`` of the chaser-fixed camera.
    numbers : (24 + n,) array
        Six zeros, turn rate (rad/s) and velocity (m/s) in the camera's axes, what lasts of the hand
        camera's and of the chaser-fixed one's errors (sigmas), and of the arm's.
    covariance : (24 + n, 24 + n) array
        Of the pose's error (rad and m) and of the others.
    options : FlightOptions
    """

    time_s: float
    pose: RigidTransform
    numbers: Floats
    covariance: Floats
    options: FlightOptions

    @classmethod
    def unknown(
        cls, time_s: float, guess: RigidTransform, arm_sigmas: Floats, options: FlightOptions
    ) -> FlightState:
        """Return a state that knows nothing but where to linearise.

        Parameters
        ----------
        time_s : float, s
        guess : RigidTransform
        arm_sigmas : (n,) array
            As ``ArmChain.spread`` has them.
        options : FlightOptions
        """
        rates = [*3 * [np.deg2rad(options.velocity_deg_s)], *3 * [options.velocity_m_s]]
        sigmas = np.concatenate([UNKNOWN, rates, np.ones(2 * POSE), arm_sigmas])
        return cls(time_s, guess, np.zeros(len(sigmas)), np.diag(sigmas**2), options)

    @property
    def arm_errors(self) -> Floats:
        """(n,) What the arm is told wrong by, as far as known."""
        return self.numbers[ARM]

    def known(self, jacobian: Floats) -> Floats:
        """Return the (6, 6) covariance of a pose that follows from pose and arm.

        Parameters
        ----------
        jacobian : (6, 6 + n) array
            As ``chained_jacobian`` has it.
        """
        rows = np.zeros((POSE, len(self.numbers)))
        rows[:, :POSE], rows[:, ARM] = jacobian[:, :POSE], jacobian[:, POSE:]
        spread = rows @ self.covariance @ rows.T
        return np.asarray(0.5 * (spread + spread.T))

    def later(self, time_s: float) -> FlightState:
        """Return the state carried on at even rates.

        Parameters
        ----------
        time_s : float, s

        Raises
        ------
        ValueError
            If time runs backwards.
        """
        ahead_s, option = time_s - self.time_s, self.options
        if ahead_s < 0.0:
            raise ValueError(f"expected a time from {self.time_s} s on, got {time_s}")
        rates = self.numbers[RATES]
        turn, shift = rates[:3] * ahead_s, rates[3:] * ahead_s
        kept = float(np.exp(-ahead_s / option.lasting_s))
        flow, noise = np.eye(len(self.numbers)), np.zeros_like(self.covariance)
        flow[:3, :3] = Rotation.from_rotvec(turn).as_matrix()
        flow[:POSE, RATES] = ahead_s * np.eye(POSE)
        density = option.acceleration_lasts_s * np.array(
            [*3 * [np.deg2rad(option.acceleration_deg_s2) ** 2], *3 * [option.acceleration_m_s2**2]]
        )
        noise[:POSE, :POSE] = np.diag(density * ahead_s**3 / 3.0)
        noise[:POSE, RATES] = noise[RATES, :POSE] = np.diag(density * ahead_s**2 / 2.0)
        noise[RATES, RATES] = np.diag(density * ahead_s)
        for place in LASTING.values():
            flow[place, place] *= kept
            noise[place, place] = (1.0 - kept**2) * np.eye(POSE)
        numbers, covariance = kalman.predict(self.numbers, self.covariance, flow, noise)
        numbers[:POSE] = 0.0
        return FlightState(
            time_s, self.pose.perturbed(turn, shift), numbers, covariance, self.options
        )

    def told(
        self, camera: CameraName, said: PoseEstimate, predicted: RigidTransform, jacobian: Floats
    ) -> tuple[FlightState, float]:
        """Take in a camera's pose; return the state, and the innovation's chi2 of six numbers.

        Parameters
        ----------
        camera : str
        said : PoseEstimate
        predicted : RigidTransform
            That camera's pose by this state.
        jacobian : (6, 6 + n) array
            How it follows pose and arm.

        Raises
        ------
        ValueError
            If no covariance is stated.
        """
        share = self.options.lasting_share
        effect = np.sqrt(share) * np.linalg.cholesky(said.stated_covariance)
        rows = np.zeros((POSE, len(self.numbers)))
        rows[:, :POSE], rows[:, ARM] = jacobian[:, :POSE], jacobian[:, POSE:]
        rows[:, LASTING[camera]] = effect
        left = difference(said.cam_from_target, predicted) - effect @ self.numbers[LASTING[camera]]
        found = kalman.update(
            self.numbers,
            self.covariance,
            left + rows @ self.numbers,
            rows,
            said.stated_covariance,
        )
        moved = found.state.copy()
        pose = self.pose.perturbed(moved[:3], moved[3:POSE])
        moved[:POSE] = 0.0
        return FlightState(self.time_s, pose, moved, found.covariance, self.options), found.nis
