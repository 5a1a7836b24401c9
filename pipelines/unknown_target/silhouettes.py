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
from pipelines.unknown_target.hull_planes import HullPlanes
from pipelines.unknown_target.observation_rows import Placed

BORDER_PX = 3  # within which the light of an edge spreads beyond it
LOCAL_PX = 7
EDGE_LEVEL = 0.4  # of the brightest about it: where an edge is
CARVED = 0.015  # share of the images that may lack a place: a shadow, a pose that errs
MORE = 0.03  # and of those by which is told how sparsely views carve; two at least
UNEVEN = 2.0  # 1 sigma of how far the hull is set back, of that: views do not carve evenly
SPARSE = 0.1  # of the reach, where views carve so sparsely that this is not to be told
EDGE_PX = 3.5  # about the place where a beam crosses an edge, from which the edge is read
ONE_SIDED = 0.2  # of that, by which what is covered there must lie to one side: no thin boom
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

    def planes(
        self, where: Placed, frames: Indices, points: Floats, doubted: frozenset[int] = frozenset()
    ) -> HullPlanes:
        """Return the plane of the silhouette's edge where each beam enters the hull.

        The views that come round carve nearer and nearer to a flat side, and if they do so evenly,
        a view that looked along it would come next, one gap behind the last. So the surface lies
        behind the hull by that gap, and one more for each view that is let pass: the gap is read
        from the place where some more are let pass. By so much the hull is set back, and by twice
        as much it may err; where a side is round, many carve close to it, and the gap is small.

        Parameters
        ----------
        where : Placed
            All frames.
        frames : (m,) int array
            Those of the beams, places in ``where``.
        points : (n, 3) array, m
            That are believed in: they tell how large the target is.
        doubted : frozenset of int
            Frames whose silhouettes carve nothing.
        """
        if doubted:
            return self._without(doubted).planes(where, frames, points)
        if not len(points) or not self.frames:
            return HullPlanes.none(len(frames))
        beams = where.take(frames)
        reach_m = float(np.quantile(np.linalg.norm(points, axis=1), REACHED))
        own = where.take(np.array(self.frames, dtype=np.int64))
        passed = int(CARVED * len(self.frames))
        more = max(2, round(MORE * len(self.frames)))
        entry_m, sooner_m = self._entries(own, beams, reach_m, (passed, passed + more))
        found = np.flatnonzero(np.isfinite(entry_m))
        if not len(found):
            return HullPlanes.none(len(frames))
        step_m = 2.0 * reach_m / (STEPS - 1)
        along = beams.R_cam_from_target[found, 2]
        eye = -np.einsum(
            "mji,mj->mi", beams.R_cam_from_target[found], beams.t_cam_from_target[found]
        )
        at, before = (
            eye + (entry_m[found] - less)[:, None] * along for less in (0.0, step_m / (STEPS - 1))
        )
        kept, lacking = ~self._lacking(own, at), self._lacking(own, before)
        crossed = (kept & lacking).argmax(axis=0)
        normal = self._edges(own, crossed, at)
        gap_m = (entry_m - sooner_m)[found]
        behind_m = np.where(np.isfinite(gap_m), gap_m, 0.0) * (passed + 1) / more
        spread_m = np.where(np.isfinite(gap_m), UNEVEN * behind_m, SPARSE * reach_m)
        good = (kept & lacking).any(axis=0) & np.isfinite(normal).all(axis=1)
        told = HullPlanes.none(len(frames))
        told.view[found[good]] = np.array(self.frames)[crossed[good]]
        told.normal[found[good]] = normal[good]
        told.behind_m[found[good]] = behind_m[good]
        told.spread_m[found[good]] = spread_m[good]
        return told

    def _without(self, doubted: frozenset[int]) -> Silhouettes:
        pairs = zip(self.frames, self.packed, strict=True)
        kept = [(frame, packed) for frame, packed in pairs if frame not in doubted]
        return Silhouettes(
            self.camera, [frame for frame, _ in kept], [packed for _, packed in kept]
        )

    def _edges(self, own: Placed, which: Indices, places: Floats) -> Floats:
        """Return the outward normals of planes through edges near (m, 3) places, camera axes.

        An edge is taken as straight within a disc: what is covered of it tells how far off it is,
        and the middle of that to which side. NaN where no such edge is.
        """
        turn, origin = own.R_cam_from_target[which], own.t_cam_from_target[which]
        centre = self.camera.project(np.einsum("mij,mj->mi", turn, places) + origin)
        reach = int(np.ceil(EDGE_PX)) + 1
        grid = np.arange(-reach, reach + 1)
        columns, rows = (each.ravel() for each in np.meshgrid(grid, grid))
        normal = np.full((len(which), 3), np.nan)
        for place, (silhouette_of, middle) in enumerate(zip(which.tolist(), centre, strict=True)):
            packed = self.packed[silhouette_of]
            if not np.isfinite(middle).all():
                continue
            column = columns + round(float(middle[0]))
            row = rows + round(float(middle[1]))
            away = np.column_stack([column, row]) - middle
            height, width = len(packed), self.camera.width
            near = np.sum(away**2, axis=1) < EDGE_PX**2
            near &= (column >= 0) & (column < width) & (row >= 0) & (row < height)
            column, row, away = column[near], row[near], away[near]
            covered = ((packed[row, column >> 3] >> (7 - (column & 7))) & 1) > 0
            if not covered.any() or covered.all():
                continue
            side = -away[covered].mean(axis=0)
            length = float(np.linalg.norm(side))
            if length < ONE_SIDED * EDGE_PX:
                continue
            side /= length
            edge = middle + (covered.mean() - 0.5) * 0.5 * np.pi * EDGE_PX * side
            ends = np.array([edge, edge + side[::-1] * [-1.0, 1.0]])
            rays = np.column_stack([self.camera.normalise(ends), np.ones(2)])
            across = np.cross(rays[0], rays[1])
            outwards = np.sign(across[:2] @ side) or 1.0
            normal[place] = outwards * across / np.linalg.norm(across[:2])
        return normal

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
        return self._entries(own, beams, reach_m, (int(CARVED * len(self.frames)),))[0]

    def _entries(
        self, own: Placed, beams: Placed, reach_m: float, let_pass: tuple[int, ...]
    ) -> list[Floats]:
        """Return where the hull begins for each number of silhouettes that may lack a place."""
        count = len(beams.t_cam_from_target)
        if len(self.frames) < FEWEST or not _all_round(own):
            return [np.full(count, np.nan)] * len(let_pass)
        turn = beams.R_cam_from_target
        eye = -np.einsum("mji,mj->mi", turn, beams.t_cam_from_target)
        beam = turn[:, 2]
        middle = np.maximum(beams.t_cam_from_target[:, 2], 2.0 * reach_m)
        steps = np.linspace(-reach_m, reach_m, STEPS)
        coarse = middle[:, None] + steps
        missing = self._missing_along(own, eye, beam, coarse)
        found = []
        for number in let_pass:
            share = (number + 0.5) / len(self.frames)
            near, whole = _first_kept(coarse, missing <= share)
            finer = near[:, None] + (steps[1] - steps[0]) * np.linspace(-1.0, 0.0, STEPS)
            kept = self._missing_along(own, eye, beam, finer) <= share
            found.append(np.where(whole, _first_kept(finer, kept)[0], np.nan))
        return found

    def _missing_along(self, own: Placed, eye: Floats, beam: Floats, depths: Floats) -> Floats:
        """Return the share of silhouettes that lack places at (m, k) depths of beams."""
        places = eye[:, None] + depths[..., None] * beam[:, None]
        return self._missing(own, places.reshape(-1, 3)).reshape(depths.shape)

    def _missing(self, own: Placed, places: Floats) -> Floats:
        """Return the share of silhouettes that lack each of (n, 3) places."""
        lacking = np.zeros(len(places))
        counted = np.zeros(len(places))
        for place in range(len(self.packed)):
            inside, lacks = self._lacks(own, place, places)
            lacking += lacks
            counted += inside
        return np.asarray(lacking / np.maximum(counted, 1.0))

    def _lacking(self, own: Placed, places: Floats) -> Mask:
        """Return which of the silhouettes lack each of (n, 3) places, (silhouettes, n)."""
        return np.array([self._lacks(own, k, places)[1] for k in range(len(self.packed))])

    def _lacks(self, own: Placed, place: int, places: Floats) -> tuple[Mask, Mask]:
        """Return which places are in one image, and which of them it leaves out."""
        packed = self.packed[place]
        in_cam = places @ own.R_cam_from_target[place].T + own.t_cam_from_target[place]
        columns, rows = self._pixels(in_cam)
        height, width = len(packed), self.camera.width
        inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
        lacks = np.zeros(len(places), dtype=bool)
        column, row = columns[inside], rows[inside]
        lacks[inside] = ((packed[row, column >> 3] >> (7 - (column & 7))) & 1) == 0
        return inside, lacks

    def _pixels(self, in_cam: Floats) -> tuple[Indices, Indices]:
        pixels = np.round(self.camera.project(in_cam))
        whole = np.where(np.isfinite(pixels), pixels, -1.0).astype(np.int64)
        return whole[:, 0], whole[:, 1]


def _first_kept(depths: Floats, kept: Mask) -> tuple[Floats, Mask]:
    """Return the first depth of each row that is not carved, and whether one before it is."""
    first = kept.argmax(axis=1)
    return depths[np.arange(len(depths)), first], kept.any(axis=1) & (first > 0)


def _all_round(own: Placed) -> bool:
    """Tell whether the views go far enough round the body."""
    views = own.R_cam_from_target[:, 2]
    return bool((views @ views.T).min() < -WIDEST_GAP)
