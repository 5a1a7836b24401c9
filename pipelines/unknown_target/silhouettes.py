"""Where a beam enters the hull that silhouettes carve: a surface without a point on it.

A tube under the Sun has no place that can be followed: its highlights slide, and what moves as a
point of it lies inside. Its outline against black space is no point either, but what lies outside
of one outline is not the target, from wherever it is seen (Laurentini, The Visual Hull Concept for
Silhouette-Based Image Understanding, IEEE PAMI 16, 1994). So a range is read at the place where
its beam first enters what no image has carved away.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np

from models.arrays import Floats, Indices, Labels, Mask
from models.camera import Camera
from pipelines.detection.target_region import TargetRegion
from pipelines.unknown_target.observation_rows import Placed

BORDER_PX = 3  # within which the light of an edge spreads beyond it
LOCAL_PX = 7
EDGE_LEVEL = 0.4  # of the brightest about it: where an edge is
CARVED = 0.03  # share of the images that may lack a place: a shadow, a pose that errs
STEPS = 100  # along the beam, twice: within the reach, and within one step of that
REACHED = 0.95  # of the points lie within what is looked through
FEWEST = 20  # silhouettes
WIDEST_GAP = (
    0.2  # cosine below zero: views must go so far round, or the hull is a cone before the target
)


def silhouette(region: TargetRegion) -> Mask:
    """Return the pixels that the target covers, (height, width), to about half a pixel.

    Parameters
    ----------
    region : TargetRegion
        Its ``lit`` is wider by what the lens spreads and the smoothing adds.
    """
    lit = region.lit.astype(np.uint8)
    core = cv2.erode(lit, np.ones((2 * BORDER_PX + 1, 2 * BORDER_PX + 1), np.uint8))
    top = cv2.dilate(region.signal, np.ones((LOCAL_PX, LOCAL_PX), np.uint8))
    return np.asarray(region.lit & ((core > 0) | (region.signal > EDGE_LEVEL * top)))


@dataclass(eq=False)
class Silhouettes:
    """Outlines of some frames.

    Attributes
    ----------
    camera : Camera
    frames : list of int
        Places among the epochs.
    packed : list of (height, width / 8) uint8 arrays
        Eight pixels a byte.
    """

    camera: Camera
    frames: list[int] = field(default_factory=list)
    packed: list[Labels] = field(default_factory=list)

    def add(self, frame: int, covered: Mask) -> None:
        """Keep one more.

        Parameters
        ----------
        frame : int
        covered : (height, width) bool array
        """
        self.frames.append(frame)
        self.packed.append(np.packbits(covered, axis=1))

    def shares(self, where: Placed, frames: Indices, points: Floats) -> Floats:
        """Return at which share of the distance to the centre of mass beams enter, (m,).

        NaN where it is not known. As the hull grows with that distance, the share does not.

        Parameters
        ----------
        where : Placed
            All frames.
        frames : (m,) int array
            Those of the beams, places in ``where``.
        points : (n, 3) array, m
            That are believed in: they tell how large the target is.
        """
        beams = where.take(frames)
        if not len(points) or not self.frames:
            return np.full(len(frames), np.nan)
        reach_m = float(np.quantile(np.linalg.norm(points, axis=1), REACHED))
        own = where.take(np.array(self.frames, dtype=np.int64))
        entry_m = self.entries(own, beams, reach_m)
        return np.asarray(entry_m / np.linalg.norm(beams.t_cam_from_target, axis=1))

    def entries(self, own: Placed, beams: Placed, reach_m: float) -> Floats:
        """Return how far along the boresight the hull begins, (m,) m; NaN where it is not known.

        Parameters
        ----------
        own : Placed
            The frames of the silhouettes.
        beams : Placed
            The frames of the ranges.
        reach_m : float, m
            Before and behind the centre of mass, within which the hull is looked for.
        """
        count = len(beams.t_cam_from_target)
        if len(self.frames) < FEWEST or not _all_round(own):
            return np.full(count, np.nan)
        turn = beams.R_cam_from_target
        eye = -np.einsum("mji,mj->mi", turn, beams.t_cam_from_target)
        beam = turn[:, 2]
        middle = np.maximum(beams.t_cam_from_target[:, 2], 2.0 * reach_m)
        steps = np.linspace(-reach_m, reach_m, STEPS)
        near, whole = self._first_kept(own, eye, beam, middle[:, None] + steps)
        finer = near[:, None] + (steps[1] - steps[0]) * np.linspace(-1.0, 0.0, STEPS)
        entry, _ = self._first_kept(own, eye, beam, finer)
        return np.where(whole, entry, np.nan)

    def _first_kept(
        self, own: Placed, eye: Floats, beam: Floats, depths: Floats
    ) -> tuple[Floats, Mask]:
        """Return the first depth that is not carved, and whether one before it is."""
        places = eye[:, None] + depths[..., None] * beam[:, None]
        kept = (self._missing(own, places.reshape(-1, 3)) <= CARVED).reshape(depths.shape)
        first = kept.argmax(axis=1)
        rows = np.arange(len(depths))
        return depths[rows, first], kept.any(axis=1) & (first > 0)

    def _missing(self, own: Placed, places: Floats) -> Floats:
        """Return the share of silhouettes that lack each of (n, 3) places."""
        lacking = np.zeros(len(places))
        counted = np.zeros(len(places))
        for packed, turn, origin in zip(
            self.packed, own.R_cam_from_target, own.t_cam_from_target, strict=True
        ):
            in_cam = places @ turn.T + origin
            columns, rows = self._pixels(in_cam)
            height, width = len(packed), self.camera.width
            inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
            column, row = columns[inside], rows[inside]
            covered = (packed[row, column >> 3] >> (7 - (column & 7))) & 1
            lacking[inside] += covered == 0
            counted += inside
        return np.asarray(lacking / np.maximum(counted, 1.0))

    def _pixels(self, in_cam: Floats) -> tuple[Indices, Indices]:
        pixels = np.round(self.camera.project(in_cam))
        whole = np.where(np.isfinite(pixels), pixels, -1.0).astype(np.int64)
        return whole[:, 0], whole[:, 1]


def _all_round(own: Placed) -> bool:
    """Tell whether the views go far enough round the body."""
    views = own.R_cam_from_target[:, 2]
    return bool((views @ views.T).min() < -WIDEST_GAP)
