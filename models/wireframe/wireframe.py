"""The simplified model of a known target that a flight computer carries: landmarks, edges, faces.

A landmark is a corner that an image shows; an edge is a straight line between two of them; the
triangles are there to hide what lies behind them, and for nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from models.arrays import Floats, Indices, Mask
from models.wireframe.finish import Finish

ROTATION_TOLERANCE = 1e-9  # symmetries are computed, not typed


@dataclass(frozen=True, eq=False)
class Wireframe:
    """A target as landmarks, edges and hiding faces, in the target frame.

    Attributes
    ----------
    name : str
        The target's name in ``models.spacecraft.catalogue``.
    landmark_names : tuple of str
        One for each landmark: ``sunshield_top_left``.
    points_in_target : (m, 3) array, m
        The landmarks.
    appendage : (m,) array of bool
        Whether a landmark belongs to the subset T of Pesce et al. 2019, section III: those on
        components clearly apart from the centre of mass.
    edges : (e, 2) array of int
        Pairs of landmarks that a straight edge of the target joins.
    triangles_in_target : (f, 3, 3) array, m
        Corners of the simplified surface, that hides landmarks and edges behind it.
    symmetries : tuple of (3, 3) arrays
        Rotations other than the identity, about the frame's origin, that carry the wireframe onto
        itself: poses that no image of these edges can tell apart.
    finish : Finish or None
        Of the triangles, if it is known what they are made of.

    Raises
    ------
    ValueError
        If a shape is wrong, a name comes twice, an edge joins no two landmarks, a value is not
        finite, a symmetry is not a rotation, or finishes are not as many as triangles.
    """

    name: str
    landmark_names: tuple[str, ...]
    points_in_target: Floats
    appendage: Mask
    edges: Indices
    triangles_in_target: Floats
    symmetries: tuple[Floats, ...] = field(default=())
    finish: Finish | None = None

    def __post_init__(self) -> None:
        count = len(self.landmark_names)
        if len(set(self.landmark_names)) < count:
            raise ValueError(f"{self.name}: expected each landmark's name once")
        if self.points_in_target.shape != (count, 3) or self.appendage.shape != (count,):
            raise ValueError(
                f"{self.name}: expected {count} landmarks as (m, 3) points and (m,) flags, got "
                f"{self.points_in_target.shape} and {self.appendage.shape}"
            )
        if self.edges.ndim != 2 or self.edges.shape[1] != 2:
            raise ValueError(f"{self.name}: expected (e, 2) edges, got {self.edges.shape}")
        if self.edges.size and not (0 <= self.edges.min() <= self.edges.max() < count):
            raise ValueError(f"{self.name}: expected edges between landmarks 0 to {count - 1}")
        if (self.edges[:, 0] == self.edges[:, 1]).any():
            raise ValueError(f"{self.name}: expected edges between two landmarks; one joins itself")
        if self.triangles_in_target.ndim != 3 or self.triangles_in_target.shape[1:] != (3, 3):
            raise ValueError(
                f"{self.name}: expected (f, 3, 3) triangles, got {self.triangles_in_target.shape}"
            )
        if not all(np.isfinite(a).all() for a in (self.points_in_target, self.triangles_in_target)):
            raise ValueError(f"{self.name}: expected finite landmarks and triangles")
        for turn in self.symmetries:
            if turn.shape != (3, 3) or np.abs(turn @ turn.T - np.eye(3)).max() > ROTATION_TOLERANCE:
                raise ValueError(f"{self.name}: expected symmetries as (3, 3) rotations")
        if self.finish is not None and len(self.finish) != len(self.triangles_in_target):
            raise ValueError(
                f"{self.name}: expected a finish for each of {len(self.triangles_in_target)} "
                f"triangles, got {len(self.finish)}"
            )

    def __len__(self) -> int:
        return len(self.landmark_names)

    @property
    def radius_m(self) -> float:
        """Distance of the outermost landmark from the origin, m."""
        return float(np.linalg.norm(self.points_in_target, axis=1).max())
