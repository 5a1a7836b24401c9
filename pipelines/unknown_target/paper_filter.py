"""The filter of Volpe et al. 2017: an unscented one of 91 numbers for twelve points.

Its state has every point twice, and neither its dynamics nor its observables (equation 23) ever
look at the second set: from a diagonal first covariance, as printed, that set would learn nothing.
The paper's Figure 6b shows it learn. So the redundancy is taken in as what it is: in every frame
equation 15, ``rho_i = rho + R P_i``, is a measurement of zero.

There is no process noise, as printed. Points are those of the first frame; one that is not seen in
a later frame is not measured then.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.camera import Camera
from models.motion.boresight_pointing import HILL_FROM_LVLH
from pipelines.filters.unscented import SigmaPoints, cross_covariance, weighted_mean
from pipelines.unknown_target.options import UnscentedOptions
from pipelines.unknown_target.paper_dynamics import PaperState, observed, redundancy, step
from pipelines.unknown_target.start_guess import StartGuess
from pipelines.unknown_target.tracked_frame import TrackedFrame

UNSEEN_PX = 1e6  # 1 sigma of a point that is not seen
UNREAD_M = 1e6


@dataclass(frozen=True, eq=False)
class PaperEstimate:
    """What the filter holds at one time.

    Attributes
    ----------
    state : (6 n + 19,) array
        See ``pipelines.unknown_target.paper_dynamics``.
    covariance : (6 n + 19, 6 n + 19) array
    names : tuple of int
        Track of each point.
    """

    state: Floats
    covariance: Floats
    names: tuple[int, ...]

    @property
    def layout(self) -> PaperState:
        """Where everything is in it."""
        return PaperState(len(self.names))


class PaperFilter:
    """One target, followed from the first frame on.

    Parameters
    ----------
    camera : Camera
    mean_motion_rad_s : float, rad/s
        Of the target's circular orbit.
    start : StartGuess
    options : UnscentedOptions
    """

    def __init__(
        self, camera: Camera, mean_motion_rad_s: float, start: StartGuess, options: UnscentedOptions
    ) -> None:
        self._camera, self._motion, self._start = camera, mean_motion_rad_s, start
        self._options = options
        self._now: PaperEstimate | None = None
        self._time_s = 0.0

    def add(self, frame: TrackedFrame) -> PaperEstimate:
        """Take in a frame; return what is known after it."""
        if self._now is None:
            now = self._begin(frame)
        else:
            now = self._predict(self._now, frame.time_s - self._time_s)
        self._now = self._update(now, frame)
        self._time_s = frame.time_s
        return self._now

    def _begin(self, frame: TrackedFrame) -> PaperEstimate:
        """Return the guess of section 7.1: points as far as the target is thought to be."""
        start, names = self._start, tuple(frame.tracks.tolist())
        layout = PaperState(len(names))
        state, sigma = np.zeros(layout.size), np.zeros(layout.size)
        rho = HILL_FROM_LVLH @ start.rho_in_lvlh
        distance = float(np.linalg.norm(rho))
        rays = self._camera.normalise(frame.points_px)
        points = distance * np.column_stack([rays, np.ones(len(rays))])
        state[layout.from_chaser] = points.ravel()
        state[layout.from_centre] = (points - [0.0, 0.0, distance]).ravel()
        state[layout.quaternion] = [0.0, 0.0, 0.0, 1.0]
        state[layout.omega] = start.omega_in_target
        state[layout.rho], state[layout.rho_dot] = rho, HILL_FROM_LVLH @ start.rho_dot_in_lvlh
        inertia = start.inertia_kg_m2
        state[layout.inertia] = [*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2]]
        beside, depth = self._options.sigma_beside_m, self._options.sigma_depth_m
        sigma[layout.from_chaser] = np.tile([beside, beside, depth], len(names))
        sigma[layout.from_centre] = sigma[layout.from_chaser]
        sigma[layout.quaternion] = self._options.sigma_attitude
        sigma[layout.omega] = start.sigma_rad_s
        sigma[layout.rho], sigma[layout.rho_dot] = start.sigma_m, start.sigma_m_s
        sigma[layout.inertia] = start.sigma_kg_m2
        return PaperEstimate(state, np.diag(sigma**2), names)

    def _sigma_points(self, size: int) -> SigmaPoints:
        return SigmaPoints(size, self._options.alpha, self._options.beta, self._options.kappa)

    def _predict(self, now: PaperEstimate, step_s: float) -> PaperEstimate:
        chosen = self._sigma_points(len(now.state))
        points = step(now.layout, chosen.around(now.state, now.covariance), self._motion, step_s)
        mean = weighted_mean(points, chosen)
        away = points - mean
        return PaperEstimate(mean, cross_covariance(away, away, chosen), now.names)

    def _update(self, now: PaperEstimate, frame: TrackedFrame) -> PaperEstimate:
        """Take in range, pixels and the redundancy together."""
        layout, chosen = now.layout, self._sigma_points(len(now.state))
        camera = self._camera
        points = chosen.around(now.state, now.covariance)
        predicted = np.column_stack(
            [observed(layout, points, (camera.fx, camera.fy)), redundancy(layout, points)]
        )
        measured, noise = self._measured(now, frame)
        mean = weighted_mean(predicted, chosen)
        away, apart = predicted - mean, points - now.state
        spread = cross_covariance(away, away, chosen) + np.diag(noise**2)
        scale = 1.0 / np.sqrt(np.diag(spread))
        scaled = spread * np.outer(scale, scale)
        both = cross_covariance(apart, away, chosen) * scale
        gain = np.linalg.solve(scaled, both.T).T
        state = now.state + gain @ ((measured - mean) * scale)
        quaternion = state[layout.quaternion]
        state[layout.quaternion] = quaternion / np.linalg.norm(quaternion)
        covariance = now.covariance - gain @ scaled @ gain.T
        return PaperEstimate(state, 0.5 * (covariance + covariance.T), now.names)

    def _measured(self, now: PaperEstimate, frame: TrackedFrame) -> tuple[Floats, Floats]:
        """Return all that is measured, and its 1 sigma."""
        layout, count = now.layout, len(now.names)
        ideal = self._camera.normalise(frame.points_px) * [self._camera.fx, self._camera.fy]
        pixels, sigma = np.zeros((count, 2)), np.full((count, 2), UNSEEN_PX)
        rows = {name: row for row, name in enumerate(frame.tracks.tolist())}
        for place, name in enumerate(now.names):
            if name in rows:
                pixels[place], sigma[place] = ideal[rows[name]], frame.sigma_px[rows[name]]
        read = frame.range_m is not None and frame.range_sigma_m is not None
        distance = frame.range_m if read else float(np.linalg.norm(now.state[layout.rho]))
        held = np.full(3 * count, self._options.sigma_constraint_m)
        return (
            np.concatenate([[distance], pixels.ravel(), np.zeros(3 * count)]),
            np.concatenate([[frame.range_sigma_m if read else UNREAD_M], sigma.ravel(), held]),
        )
