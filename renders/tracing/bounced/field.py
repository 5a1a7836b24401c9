"""Bounced sunlight as a kernel looks it up: the paths that landed in a cell, drawn by chance.

The light that a surface sends to a viewer is a sum over the paths that landed around it, each
weighed by the surface's own lobe towards the viewer: a photon map's density estimate, of which a
few paths are drawn for each look-up (Jensen 1996). The place is shifted by up to half a node
before, so that nodes blend. A node's area as light sees it is that of a GGX-rough sheet of its
relief (Walter et al. 2007; Heitz 2014, Understanding the masking-shadowing function, JCGT 3(2)).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from models.arrays import AnyArray
from renders.tracing.bounced.curve import LEVELS
from renders.tracing.bounced.packed_direction import unpacked
from renders.tracing.bounced.photons import Landed
from renders.tracing.bounced.surface_cells import BRICK_M, NONE, CellFinder, Nodes
from renders.tracing.sample_sequence import points_2d

DRAWS = 4  # of paths a look-up
ENOUGH = 300  # paths of a node
OFF_SIGMA = 3.0  # by which a node may differ from what is around it and still be joined to it
LEAST_POINTS = 6  # from which a node's area was measured
LEAST_COSINE = 0.05  # at which light lands: a grazing path stands for no more than 20 of its own
FIRST_PAIR = 96  # of random dimensions; those below are the path's own


def fitting_nodes(cell: AnyArray, nodes: Nodes) -> tuple[AnyArray, AnyArray, AnyArray]:
    """Choose for each cell the node whose light stands for it, the finest in which enough landed.

    A node that is much darker or brighter than what is around it is kept, few as its paths may be:
    it lies in another light (Lepski 1990, as for the width of a kernel).

    Parameters
    ----------
    cell : (n,) sorted array of int
        In which paths landed.
    nodes : Nodes

    Returns
    -------
    level, begin, end : (cells,) arrays of int
        Level of each cell's node, and which paths landed in it.
    """
    cells = nodes.of_cell.shape[1]
    first = np.searchsorted(cell, np.arange(cells + 1))
    bounds = []
    for level in range(LEVELS):
        node = nodes.of_cell[level] - nodes.begin[level]
        edges = np.searchsorted(node, np.arange(node[-1] + 2))
        bounds.append((first[edges[:-1]][node], first[edges[1:]][node]))
    chosen = np.zeros(cells, dtype=np.int64)
    rises = np.ones(cells, dtype=bool)
    for level in range(LEVELS - 1):
        (low, high), (low_above, high_above) = bounds[level], bounds[level + 1]
        here, above = nodes.of_cell[level], nodes.of_cell[level + 1]
        points = nodes.points[here]
        expected = (high_above - low_above) * points / nodes.points[above]
        off = np.abs(high - low - expected) > OFF_SIGMA * np.sqrt(np.maximum(expected, 1.0))
        rises &= (high - low < ENOUGH) & ~off | (points < LEAST_POINTS)
        chosen[rises] = level + 1
    low, high = (np.stack(each) for each in zip(*bounds, strict=True))
    return (
        chosen,
        np.take_along_axis(low, chosen[None], axis=0)[0],
        np.take_along_axis(high, chosen[None], axis=0)[0],
    )


@dataclass(frozen=True, eq=False)
class LandedLight:
    """The paths of one light, on the device.

    Each cell has the paths of the finest node around it in which enough landed: light that is
    strong, or changes over a short length, is dense, and is kept apart there.

    Attributes
    ----------
    begin, end : (cells,) UInt32
        Paths of each cell's node.
    reach : (cells,) Float, m
        Length of the node's side.
    facing : list of five (cells,) Float
        Mean normal, area in m2 and relief of the node; see ``Nodes``.
    direction : (n,) UInt32
        From which each path came; see ``packed``.
    power : (n,) Float, W
    """

    begin: Any
    end: Any
    reach: Any
    facing: list[Any]
    direction: Any
    power: Any

    @classmethod
    def load(cls, landed: Landed, nodes: Nodes) -> LandedLight:
        """Put paths on the device."""
        level, begin, end = fitting_nodes(landed.cell, nodes)
        chosen = np.take_along_axis(nodes.of_cell, level[None], axis=0)[0]
        facing = [*nodes.normals[chosen].T, nodes.areas_m2[chosen], nodes.reliefs[chosen]]
        some = len(landed.cell) > 0  # Dr.Jit gathers nothing from nothing
        made = cls(
            mi.UInt32(begin.astype(np.uint32)),
            mi.UInt32(end.astype(np.uint32)),
            mi.Float((BRICK_M / 2.0 ** (LEVELS - 1 - level)).astype(np.float32)),
            [mi.Float(np.ascontiguousarray(each)) for each in facing],
            mi.UInt32(landed.direction) if some else mi.UInt32(0),
            mi.Float(landed.power_w) if some else mi.Float(0.0),
        )
        dr.make_opaque(made.begin, made.end, made.reach, made.facing, made.direction, made.power)
        return made

    def towards_viewer(
        self, surface: Any, band: int, cell: Any, choices: Sequence[Any], active: Any
    ) -> Any:
        """Return what surfaces send on of the light that landed around them, W m-2 sr-1.

        Parameters
        ----------
        surface : SurfaceSeen
        band : int
        cell : UInt32
        choices : sequence of Float
            From 0 to 1; each draws a path.
        active : Bool
        """
        begin = dr.gather(mi.UInt32, self.begin, cell, active)
        count = dr.gather(mi.UInt32, self.end, cell, active) - begin
        active = active & (count > 0)
        x, y, z, area, relief = (dr.gather(mi.Float, each, cell, active) for each in self.facing)
        normal = mi.Vector3f(x, y, z)
        total = mi.Float(0.0)
        for choice in choices:
            number = begin + dr.minimum(mi.UInt32(choice * mi.Float(count)), count - 1)
            towards = unpacked(dr.gather(mi.UInt32, self.direction, number, active))
            cosine = dr.dot(normal, towards)
            slant = dr.sqrt(cosine * cosine + relief * (1.0 - cosine * cosine))
            brought = dr.gather(mi.Float, self.power, number, active) * surface.value(band, towards)
            brought /= area * dr.maximum(0.5 * (cosine + slant), LEAST_COSINE)
            total += dr.select(active & surface.faces(towards), brought, 0.0)
        return total * mi.Float(count) * (1.0 / len(choices))


@dataclass(frozen=True, eq=False)
class BouncedField:
    """Cells and what landed in them of some lights.

    Attributes
    ----------
    finder : CellFinder
    lights : dict of LandedLight
        By the name of a light group.
    """

    finder: CellFinder
    lights: dict[str, LandedLight]

    def towards_viewer(
        self,
        light: Any,
        place: Any,
        mesh: Any,
        cell: Any,
        surface: Any,
        shift: Any,
        choices: Sequence[Any],
        active: Any,
    ) -> Any:
        """Return what surfaces send on of one light, W m-2 sr-1.

        Parameters
        ----------
        light : kernel light
            As ``kernel_lights.light_of`` gives it.
        place : Point3f, m
        mesh, cell : UInt32
            On which mesh, and in which cell.
        surface : SurfaceSeen
        shift : Vector3f
            By how much of a node the place is moved before it is looked up, -0.5 to 0.5.
        choices : sequence of Float
            From 0 to 1; each draws a path.
        active : Bool
        """
        landed = self.lights[light.name]
        reach = dr.gather(mi.Float, landed.reach, cell, active)
        moved = self.finder.cell(place + shift * reach, surface.normal, mesh, active)
        cell = dr.select(moved != NONE, moved, cell)
        return landed.towards_viewer(surface, light.channel, cell, choices, active)


class BouncedFields:
    """What is looked up on a path: what the target throws on itself, and by way of the chaser.

    Parameters
    ----------
    still : BouncedField, optional
        Of the target alone; its cells say where bounced light is looked up at all.
    moving : BouncedField, optional
        Of what has met the chaser at one exposure, beside it.
    """

    def __init__(
        self, still: BouncedField | None = None, moving: BouncedField | None = None
    ) -> None:
        self.still, self.moving = still, moving
        self.names = frozenset(still.lights) if still is not None else frozenset[str]()

    def looked_up(
        self,
        place: Any,
        shape: Any,
        surface: Any,
        index: Any,
        key: Any,
        depth: Any,
        active: Any,
        lights: Sequence[Any],
    ) -> tuple[Any, dict[str, Any]]:
        """Return what surfaces send on towards the viewer of the light that bounced onto them.

        Parameters
        ----------
        place : Point3f, m
            Target frame.
        shape : ShapePtr
        surface : SurfaceSeen
        index, key, depth : UInt32
            Number of the sample, random key of its pixel, number of the vertex.
        active : Bool
        lights : sequence
            As ``kernel_lights.light_of`` gives them.

        Returns
        -------
        found : Bool
            Where there is a cell.
        brought : dict of Float, W m-2 sr-1
            By the name of a light group.
        """
        assert self.still is not None
        pair = FIRST_PAIR + depth * (2 + DRAWS)
        across, up = points_2d(index, key, pair), points_2d(index, key, pair + 1)
        shift = mi.Vector3f(across.x - 0.5, across.y - 0.5, up.x - 0.5)
        mesh = self.still.finder.mesh(shape, active)
        cell = self.still.finder.cell(place, surface.normal, mesh, active)
        found = active & (cell != NONE)
        # Evenly spread over a node's paths, within the draws of one look-up and between samples.
        drawn = points_2d(index, key, pair + 2)
        brought = {}
        for light in (light for light in lights if light.name in self.names):
            total = mi.Float(0.0)
            for field, start in ((self.still, drawn.x), (self.moving, drawn.y)):
                if field is not None:
                    choices = [_turned(start, k / DRAWS) for k in range(DRAWS)]
                    total += field.towards_viewer(
                        light, place, mesh, cell, surface, shift, choices, found
                    )
            brought[light.name] = total
        return found, brought


def _turned(choice: Any, by: float) -> Any:
    moved = choice + by
    return dr.select(moved >= 1.0, moved - 1.0, moved)


NO_FIELDS = BouncedFields()
