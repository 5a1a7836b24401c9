"""The beginning: images are gathered until two of them tell how the target turns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from models.arrays import Mask
from models.camera import Camera
from pipelines.unknown_target.start_guess import StartGuess
from pipelines.unknown_target.tracked_frame import TrackedFrame
from pipelines.unknown_target.two_view_start import BARELY, WELL, TwoViews, two_views

MOST_GATHERED = 90  # images, beyond which the oldest go
APART = (10, 15, 20, 30)  # images between the two
PATIENCE = 60  # images gathered, after which two that tell barely enough are taken
UNKNOWN_RANGE_M, UNKNOWN_SIGMA = 20.0, 0.5  # where nothing tells of it; relative
BEHIND, BEHIND_SIGMA = 0.4, 0.8  # of half its width: the centre of mass, behind the surface
LOOSE = 10.0  # points seen are all on the near side: a tight prior would draw the centre to them
SIGMA_M_S = 0.02  # two spacecraft that stay together drift by millimetres a second


@dataclass(frozen=True, eq=False)
class Started:
    """What to begin from.

    Attributes
    ----------
    guess : StartGuess
    frames : list of TrackedFrame
        Those between the two images, without the tracks that do not move as most do.
    """

    guess: StartGuess
    frames: list[TrackedFrame]


class ImageStart:
    """Gathers images.

    Parameters
    ----------
    camera : Camera
    mean_motion_rad_s : float, rad/s
    range_m : (float, float) or None, m
        Nearest and farthest, where a coarse range is known.
    """

    def __init__(
        self, camera: Camera, mean_motion_rad_s: float, range_m: tuple[float, float] | None
    ) -> None:
        self._camera, self._motion, self._range_m = camera, mean_motion_rad_s, range_m
        self._frames: list[TrackedFrame] = []

    def __len__(self) -> int:
        return len(self._frames)

    def take(self, frame: TrackedFrame) -> Started | None:
        """Take in an image; return what to begin from once there is enough."""
        self._frames.append(frame)
        del self._frames[:-MOST_GATHERED]
        demands = (WELL, BARELY) if len(self._frames) >= PATIENCE else (WELL,)
        for demand in demands:
            for apart in APART:
                if apart < len(self._frames):
                    first = self._frames[-1 - apart]
                    views = two_views(self._camera, self._motion, first, frame, demand)
                    if views is not None:
                        return self._started(views, self._frames[-1 - apart :])
        return None

    def _started(self, views: TwoViews, frames: list[TrackedFrame]) -> Started:
        first = frames[0]
        rays = self._camera.normalise(first.points_px)
        middle, extent = np.median(rays, axis=0), float(np.ptp(rays, axis=0).max())
        depth_m, sigma_m = self._depth(frames)
        size_m = max(0.5 * extent * depth_m, 0.1)
        if sigma_m == 0.0:  # what was read is the near side
            depth_m, sigma_m = depth_m + BEHIND * size_m, BEHIND_SIGMA * size_m
        in_cam = np.array([*(middle * depth_m), depth_m])
        guess = StartGuess(
            -first.R_cam_from_lvlh.T @ in_cam,
            float(max(sigma_m, BEHIND_SIGMA * size_m)),
            sigma_m_s=SIGMA_M_S,
            omega_in_target=views.omega_in_target,
            sigma_rad_s=views.sigma_rad_s,
            size_m=LOOSE * size_m,
        )
        return Started(guess, without(frames, views))

    def _depth(self, frames: Sequence[TrackedFrame]) -> tuple[float, float]:
        """Return how far the target is thought to be, and its sigma, m: none where it was read."""
        read = [frame.range_m for frame in frames if frame.range_m is not None]
        if read:
            return float(np.median(read)), 0.0
        if self._range_m is not None:
            near, far = self._range_m
            return 0.5 * (near + far), 0.5 * (far - near)
        return UNKNOWN_RANGE_M, UNKNOWN_SIGMA * UNKNOWN_RANGE_M


def without(frames: Sequence[TrackedFrame], views: TwoViews) -> list[TrackedFrame]:
    """Return frames without the tracks that disagree.

    Parameters
    ----------
    frames : sequence of TrackedFrame
    views : TwoViews
    """
    return [_kept(frame, ~np.isin(frame.tracks, views.disagreeing)) for frame in frames]


def _kept(frame: TrackedFrame, which: Mask) -> TrackedFrame:
    return replace(
        frame,
        tracks=frame.tracks[which],
        points_px=frame.points_px[which],
        sigma_px=frame.sigma_px[which],
    )
