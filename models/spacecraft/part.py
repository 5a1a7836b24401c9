"""A spacecraft as named parts: a mesh in the target frame and the name of its material."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from models.arrays import Floats
from models.markers import MarkerPattern
from models.materials import MATERIALS, Material

if TYPE_CHECKING:
    import trimesh


@dataclass(frozen=True, eq=False)
class Part:
    """One named piece of a spacecraft.

    Attributes
    ----------
    name : str
        What an engineer calls it: ``launch_adaptor_ring``, ``solar_wing_plus_y``. Parts that
        share a name share a label.
    mesh : trimesh.Trimesh
        Triangles in its frame, m; normals outward.
    material : str
        A key of ``models.materials.MATERIALS``, or of the spacecraft's own.
    smooth : bool
        Whether vertex normals are interpolated over the faces (curved parts) or not (flat ones).
    frame : int
        Of those that move in each other: 0 the body's, k that of the link after an arm's joint k.
    """

    name: str
    mesh: trimesh.Trimesh
    material: str
    smooth: bool = False
    frame: int = 0


@dataclass(frozen=True, eq=False)
class Spacecraft:
    """A target or chaser.

    Attributes
    ----------
    name : str
    parts : tuple of Part
        Everything but the markers' faces, in the body frame, m.
    markers : MarkerPattern or None
        The retroreflectors; the renderer makes their discs.
    centre_of_mass : (3,) array, m
        In the body frame.
    materials : mapping of str to Material
        Its own, beside those of ``models.materials``.
    """

    name: str
    parts: tuple[Part, ...]
    markers: MarkerPattern | None
    centre_of_mass: Floats
    materials: Mapping[str, Material] = field(default_factory=lambda: MappingProxyType({}))

    def material_of(self, part: Part) -> Material:
        """Return what a part of it is made of."""
        return self.materials.get(part.material) or MATERIALS[part.material]

    @property
    def part_names(self) -> tuple[str, ...]:
        """The names in order of first use; label k + 1 means ``part_names[k]``."""
        return tuple(dict.fromkeys(part.name for part in self.parts))

    @property
    def bounds(self) -> Floats:
        """(2, 3) array, m: lowest and highest corner of the bounding box."""
        corners = np.array([part.mesh.bounds for part in self.parts])
        return np.stack([corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)])
