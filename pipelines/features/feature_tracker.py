"""Tracks of an unknown target's features: born, followed, checked, lost, and known again.

A track's name stays with its place: one that was hidden, or turned away, gets its name back when
it looks the same and moves as the body does. A place is found by its first look; where that has
turned too far away a new one is taken, and the error made by then stays in the stated sigma.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np

from models.arrays import Floats, Image, Indices, Labels, Mask, Radiance
from models.camera import Camera
from models.sensors.camera_chip import Detector
from pipelines.detection.target_region import TargetRegion, find_target
from pipelines.features.anchored_patch import Anchors, fitted
from pipelines.features.appearance import described, recognised
from pipelines.features.fine_detail import fine_detail, has_corners
from pipelines.features.klt_step import follow
from pipelines.features.rigid_motion_check import moves_rigidly


@dataclass(frozen=True)
class TrackerOptions:
    """Settings.

    Attributes
    ----------
    most : int
        Live tracks.
    apart_px : float, px
        Of two of them.
    quality : float
        Of the strongest corner, see Shi and Tomasi 1994.
    rim_px : int, px
        From the border of the lit target, within which nothing is born. A corner there is a place;
        the limb is none, but it is no corner.
    floor_px : float, px
        1 sigma of a place found by its first look, whatever the noise.
    likeness : float
        Correlation with the first look, below which a new one is taken.
    farthest_px : float, px
        Of a place by its first look from where the last image has it.
    widest_turn : float
        Largest stretch of the first look, either way, before a new one is taken.
    check_every : int
        Frames between which the motion is checked.
    most_lost : int
        Tracks that are remembered.
    """

    most: int = 150
    apart_px: float = 8.0
    quality: float = 0.01
    rim_px: int = 1
    floor_px: float = 0.07
    likeness: float = 0.9
    farthest_px: float = 2.0
    widest_turn: float = 2.0
    check_every: int = 5
    most_lost: int = 2000


@dataclass(frozen=True, eq=False)
class FeaturesSeen:
    """The tracks of one image.

    Attributes
    ----------
    names : (n,) int array
    points_px : (n, 2) array, px
        As in the image, distortion and all.
    sigma_px : (n,) array, px
        Of each axis.
    region : TargetRegion or None
        Where the target shines.
    """

    names: Indices
    points_px: Floats
    sigma_px: Floats
    region: TargetRegion | None = None


@dataclass(eq=False)
class _Live:
    names: Indices = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    points: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    variance: Floats = field(default_factory=lambda: np.zeros(0))
    velocity: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    looks: Radiance = field(default_factory=lambda: np.zeros((0, 128), dtype=np.float32))
    checked: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    maps: Floats = field(default_factory=lambda: np.zeros((0, 2, 2)))
    before_anchor: Floats = field(default_factory=lambda: np.zeros(0))  # variance until then
    anchors: Anchors = field(default_factory=Anchors.none)

    def take(self, kept: Mask) -> None:
        for name, value in vars(self).items():
            own = value.take(kept) if isinstance(value, Anchors) else value[kept]
            setattr(self, name, own)


class FeatureTracker:
    """Follows features through images of one camera.

    Parameters
    ----------
    camera : Camera
    options : TrackerOptions, optional
    detector : Detector, optional
        As calibrated.
    """

    def __init__(
        self,
        camera: Camera,
        options: TrackerOptions | None = None,
        detector: Detector | None = None,
    ) -> None:
        self._camera, self._detector = camera, detector
        self._options = options or TrackerOptions()
        self._live = _Live()
        self._lost_names: list[int] = []
        self._lost_looks = np.zeros((0, 128), dtype=np.float32)
        self._before: Labels | None = None
        self._next, self._frame = 0, 0

    def track(self, image: Image) -> FeaturesSeen:
        """Take in the next image, (height, width) uint16 DN; return what is seen in it."""
        region = find_target(image, self._detector)
        if not region:  # noise has corners, too, and the last image's would be followed into it
            return self._dark(region)
        grey = fine_detail(region)
        self._follow(grey)
        if self._frame % self._options.check_every == 0:
            self._check()
        self._add_new(grey, region.lit)
        self._before = grey
        self._frame += 1
        live = self._live
        return FeaturesSeen(live.names.copy(), live.points.copy(), np.sqrt(live.variance), region)

    def _dark(self, region: TargetRegion) -> FeaturesSeen:
        """Take in an image in which nothing shines: all tracks are lost, to be known again."""
        self._lose(np.zeros(len(self._live.names), dtype=bool))
        self._before = None
        self._frame += 1
        return FeaturesSeen(np.zeros(0, dtype=np.int64), np.zeros((0, 2)), np.zeros(0), region)

    def _follow(self, grey: Labels) -> None:
        live = self._live
        if self._before is None or len(live.names) == 0:
            return
        step = follow(self._before, grey, live.points, live.points + live.velocity)
        before = live.points
        live.points = step.points_px
        live.variance = live.variance + step.step_sigma_px**2 + self._options.floor_px**2
        self._lose(step.kept)
        self._find_first_looks(grey)
        live.velocity = live.points - before[step.kept]

    def _find_first_looks(self, grey: Labels) -> None:
        """Put places where their first looks are; take new ones of those that look otherwise."""
        live, options = self._live, self._options
        found = fitted(grey, live.anchors, live.points, live.maps)
        stretch = np.linalg.svd(found.maps, compute_uv=False)
        near = np.linalg.norm(found.points_px - live.points, axis=1) < options.farthest_px
        same = near & (found.likeness > options.likeness)
        live.points = np.where(same[:, None], found.points_px, live.points)
        own = live.before_anchor + found.sigma_px**2 + options.floor_px**2
        live.variance = np.where(same, own, live.variance)
        live.maps = np.where(same[:, None, None], found.maps, live.maps)
        wide = stretch.max(axis=1, initial=1.0) > options.widest_turn
        wide |= stretch.min(axis=1, initial=1.0) < 1.0 / options.widest_turn
        anew = ~same | wide
        if anew.any():
            new = Anchors.of(grey, live.points[anew])
            live.anchors.patches[anew] = new.patches
            live.anchors.descents[anew] = new.descents
            live.maps[anew] = np.eye(2)
            live.before_anchor[anew] = live.variance[anew]

    def _check(self) -> None:
        live, camera = self._live, self._camera
        if len(live.names) == 0:
            return
        before, after = (
            camera.normalise(points) * [camera.fx, camera.fy] + [camera.cx, camera.cy]
            for points in (live.checked, live.points)
        )
        rigid = moves_rigidly(before, after, camera.matrix)
        live.checked = live.points.copy()
        live.take(rigid)  # what slid is no place, and is not to be known again

    def _lose(self, kept: Mask) -> None:
        """Keep what lost tracks looked like, to know them again."""
        gone = ~kept
        self._lost_names = [*self._lost_names, *self._live.names[gone].tolist()]
        self._lost_looks = np.concatenate([self._lost_looks, self._live.looks[gone]])
        self._lost_names = self._lost_names[-self._options.most_lost :]
        self._lost_looks = self._lost_looks[-self._options.most_lost :]
        self._live.take(kept)

    def _add_new(self, grey: Labels, lit: Mask) -> None:
        live, options = self._live, self._options
        room = options.most - len(live.names)
        if room <= 0:
            return
        free = cv2.erode(lit.astype(np.uint8), np.ones((3, 3), np.uint8), iterations=options.rim_px)
        free &= has_corners(grey, lit)
        for x, y in np.round(live.points).astype(int).tolist():
            cv2.circle(free, (x, y), round(options.apart_px), 0, -1)
        corners = cv2.goodFeaturesToTrack(
            grey, room, options.quality, options.apart_px, mask=free, blockSize=5
        )
        if corners is None:
            return
        points = np.asarray(corners.reshape(-1, 2), dtype=np.float64)
        looks = described(grey, points)
        names = np.arange(self._next, self._next + len(points), dtype=np.int64)
        self._next += len(points)
        again = recognised(self._lost_looks, looks)
        for lost, found in again:
            names[found] = self._lost_names[lost]
        gone = {lost for lost, _ in again}
        rest = [place for place in range(len(self._lost_names)) if place not in gone]
        self._lost_names = [self._lost_names[place] for place in rest]
        self._lost_looks = self._lost_looks[rest]
        live.names = np.concatenate([live.names, names])
        live.points = np.concatenate([live.points, points])
        live.variance = np.concatenate([live.variance, np.full(len(points), options.floor_px**2)])
        live.velocity = np.concatenate([live.velocity, np.zeros_like(points)])
        live.looks = np.concatenate([live.looks, looks])
        live.checked = np.concatenate([live.checked, points])
        live.maps = np.concatenate([live.maps, np.tile(np.eye(2), (len(points), 1, 1))])
        live.before_anchor = np.concatenate([live.before_anchor, np.zeros(len(points))])
        live.anchors = live.anchors.followed_by(Anchors.of(grey, points))
