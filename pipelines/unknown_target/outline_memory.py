"""Silhouettes of the frames so far, and what ``best`` makes of them: rows of pairs, and planes."""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Indices, Mask
from models.camera import Camera
from pipelines.unknown_target.hull_planes import HullPlanes
from pipelines.unknown_target.observation_rows import Placed, Rows
from pipelines.unknown_target.outline_rows import (
    Outlines,
    doubted_outlines,
    outline_rows,
    pairs_of,
)
from pipelines.unknown_target.silhouettes import Silhouettes


class OutlineMemory:
    """Keeps silhouettes with their outlines.

    Parameters
    ----------
    camera : Camera
    outline_px : float, px
        1 sigma by which an outline errs.
    gate_sigmas : float
        Beyond it most of an outline's rows make it doubted.
    """

    def __init__(self, camera: Camera, outline_px: float, gate_sigmas: float) -> None:
        self._silhouettes, self._outlines = Silhouettes(camera), Outlines(camera)
        self._sigma_rad, self._gate = outline_px / camera.fx, gate_sigmas
        self._pairs = np.zeros((0, 2), dtype=np.int64)
        self._doubted: frozenset[int] = frozenset()
        self.hull_known = False

    @property
    def frames(self) -> Indices:
        """(n,) int array: the frames that have an outline, places among the epochs."""
        return np.array(self._outlines.frames, dtype=np.int64)

    def add(self, frame: int, covered: Mask) -> None:
        """Keep the (height, width) pixels that the target covers in a frame."""
        self._silhouettes.add(frame, covered)
        self._outlines.add(frame, covered)

    def pair(self, own: Placed) -> None:
        """Choose which outlines are compared, as the frames that have one are now placed."""
        self._pairs = pairs_of(own)

    def rows(self, own: Placed) -> Rows:
        """Return the rows of those pairs, as the frames that have an outline are placed."""
        return outline_rows(own, self._outlines, self._pairs, self._sigma_rad)

    def last_rows(self, own: Placed) -> Rows:
        """Return the rows of the last outline with earlier ones."""
        pairs = pairs_of(own)
        last = pairs[pairs[:, 1] == len(self._outlines) - 1]
        return outline_rows(own, self._outlines, last, self._sigma_rad)

    def carve(self, where: Placed, frames: Indices, points: Floats, rows: Rows) -> HullPlanes:
        """Return where beams enter the hull, carved without the outlines that most rows doubt.

        Parameters
        ----------
        where : Placed
            All frames.
        frames : (m,) int array
            Those of the beams.
        points : (n, 3) array, m
            That are believed in.
        rows : Rows
            Of the pairs, by the same poses.
        """
        self._doubted = doubted_outlines(self._outlines, self._pairs, rows, self._gate)
        planes = self.planes(where, frames, points)
        self.hull_known = bool(planes.known.any())
        return planes

    def planes(self, where: Placed, frames: Indices, points: Floats) -> HullPlanes:
        """Return where beams enter the hull; outlines that were doubted last still are.

        Parameters
        ----------
        where : Placed
            All frames.
        frames : (m,) int array
            Those of the beams.
        points : (n, 3) array, m
            That are believed in.
        """
        return self._silhouettes.planes(where, frames, points, self._doubted)
