"""Sunlight followed from the Sun, and counted where it lands after one bounce or more.

What foil and rings throw onto what they face is found from a camera by luck alone; followed from
the Sun each path that lands there counts the same. More start where a first few brought more
(two-stage sampling: the paths that chose are not counted).

Source: Jensen 1996, Global illumination using photon maps; for shading normals, Veach 1997,
equation 5.19.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import drjit as dr
import mitsuba as mi
import numpy as np

from models.arrays import AnyArray, Floats
from renders.tracing.bounced.packed_direction import packed
from renders.tracing.bounced.surface_cells import NONE, CellFinder
from renders.tracing.kernel_lights import SunLight
from renders.tracing.leaving import leaving
from renders.tracing.light_groups import SunGroup
from renders.tracing.sample_sequence import points_2d
from renders.tracing.surface_table import SurfaceTable

PILOT = 32  # paths from each field before it is known what they bring
FLOOR = 0.03  # of a field's share: what brought nothing yet is not left out
PER_LAUNCH = 1 << 20
COLUMNS = 4096  # of the image that paths are kept in


@dataclass(frozen=True, eq=False)
class SunPicture:
    """A rectangle across the sunlight, cut into fields.

    Attributes
    ----------
    corner, across, along : (3,) arrays, m
        A corner in the target frame, and the two sides.
    """

    corner: Floats
    across: Floats
    along: Floats

    @classmethod
    def of(cls, group: SunGroup, corners: Floats) -> SunPicture:
        """Return one that all light towards some places, (n, 3) m, crosses."""
        towards = np.asarray(group.direction_in_target)
        helper = np.eye(3)[int(np.argmin(np.abs(towards)))]
        x = np.cross(towards, helper)
        x /= np.linalg.norm(x)
        y = np.cross(towards, x)
        flat = np.stack([corners @ x, corners @ y, corners @ towards], axis=1)
        low, high = flat.min(axis=0), flat.max(axis=0)
        spread = group.sine_of_radius * (high[2] - low[2] + 1.0) + 1e-3
        low[:2] -= spread
        high[:2] += spread
        corner = low[0] * x + low[1] * y + (high[2] + 1.0) * towards
        return cls(corner, (high[0] - low[0]) * x, (high[1] - low[1]) * y)

    @property
    def area_m2(self) -> float:
        """Its size."""
        return float(np.linalg.norm(self.across) * np.linalg.norm(self.along))


@dr.syntax(recursive=False)  # type: ignore[untyped-decorator]
def _follow(
    scene: Any,
    surfaces: Any,
    only_by: Any,
    finder: Any,
    light: Any,
    corner: Any,
    across: Any,
    along: Any,
    grid: Any,
    field: Any,
    index: Any,
    weight: Any,
    landed: Any,
    max_depth: Any,
    key: Any,
) -> Any:
    """Follow paths; write where they land into ``landed`` and return what each brought."""
    own = mi.sample_tea_32(field, key)[0]
    lane = dr.arange(mi.UInt32, dr.width(field))
    place = points_2d(index, own, mi.UInt32(0))
    disc = mi.warp.square_to_uniform_disk_concentric(points_2d(index, own, mi.UInt32(1)))
    towards = light.sample(mi.Point3f(0.0), disc, mi.Float(0.5))[0]
    x = (mi.Float(field % grid) + place.x) / mi.Float(grid)
    y = (mi.Float(field // grid) + place.y) / mi.Float(grid)
    ray = mi.Ray3f(corner + across * x + along * y, -towards)
    carried, brought = mi.Float(weight), mi.Float(0.0)
    depth = mi.UInt32(0)
    counted = mi.Bool(only_by is None)
    active = mi.Bool(True)
    band = light.channel
    while active:
        si = scene.ray_intersect(ray, mi.RayFlags.ShadingFrame, depth == 0, active)
        active &= si.is_valid()
        surface = surfaces.seen(si, ray, [band], active)
        if dr.hint(only_by is not None, mode="scalar"):
            shape = dr.reinterpret_array(mi.UInt32, si.shape)
            counted |= dr.gather(mi.Bool, only_by, shape, active)
        mesh = finder.mesh(si.shape, active)
        cell = finder.cell(si.p, surface.normal, mesh, active & (depth > 0))
        lands = active & counted & (depth > 0) & (cell != NONE)
        slot = lane * (max_depth - 1) + depth - 1
        dr.scatter(landed[0], cell, slot, lands)
        dr.scatter(landed[1], packed(-ray.d), slot, lands)
        dr.scatter(landed[2], carried, slot, lands)
        brought += dr.select(lands, carried, 0.0)
        direction, _, weights = surface.sample(points_2d(index, own, 2 + depth))
        slant = dr.dot(surface.shading_normal, -ray.d) * dr.dot(surface.normal, direction)
        slant /= dr.dot(surface.shading_normal, direction) * dr.dot(surface.normal, -ray.d)
        carried *= weights[band] * slant
        depth += 1
        active &= (depth < max_depth) & (carried > 0.0) & surface.reflects
        ray = leaving(si.p, surface.normal, direction)
    return brought


@dataclass(frozen=True, eq=False)
class Landed:
    """Where paths landed, and what they brought.

    Attributes
    ----------
    cell : (n,) uint32 array
    direction : (n,) uint32 array
        From which the light came; see ``packed``.
    power_w : (n,) float32 array, W
    """

    cell: AnyArray
    direction: AnyArray
    power_w: AnyArray

    CHANNELS: ClassVar = ("cell", "direction", "power_w")

    @classmethod
    def joined(cls, parts: Iterable[Landed]) -> Landed:
        """Return all of several, sorted by cell and else in order."""
        every = [cls(*(np.empty(0, dtype=d) for d in ("u4", "u4", "f4"))), *parts]
        cell = np.concatenate([each.cell for each in every])
        order = np.argsort(cell, kind="stable")
        direction = np.concatenate([each.direction for each in every])[order]
        return cls(cell[order], direction, np.concatenate([e.power_w for e in every])[order])

    def channels(self) -> dict[str, AnyArray]:
        """Return them as an image of a file, rows of ``COLUMNS``, the last filled up."""
        rows = max(1, -(-len(self.cell) // COLUMNS))
        filled = {
            "cell": np.full(rows * COLUMNS, NONE, dtype=np.uint32),
            "direction": np.zeros(rows * COLUMNS, dtype=np.uint32),
            "power_w": np.zeros(rows * COLUMNS, dtype=np.float32),
        }
        for name, values in filled.items():
            values[: len(self.cell)] = getattr(self, name)
        return {name: values.reshape(rows, COLUMNS) for name, values in filled.items()}

    @classmethod
    def of_channels(cls, channels: Mapping[str, AnyArray]) -> Landed:
        """Return them from such an image."""
        cell, direction, power = (channels[name].ravel() for name in cls.CHANNELS)
        there = cell != NONE
        return cls(cell[there], direction[there], power[there])


@dataclass(frozen=True, eq=False)
class PhotonTracer:
    """What sunlight meets.

    Attributes
    ----------
    scene : mitsuba.Scene
    surfaces : SurfaceTable
    max_depth : int
        Surfaces that light meets on its way to a lens, the last one that it lands on included.
    only_by : Bool, optional
        By the number of a shape, whether light is counted after it has met it; all light, unless
        given.
    grid : int
        Fields of the picture that the Sun has of the scene, along each side.
    """

    scene: Any
    surfaces: SurfaceTable
    max_depth: int
    only_by: Any = None
    grid: int = 96

    def arriving(
        self,
        group: SunGroup,
        picture: SunPicture,
        finder: CellFinder,
        photons: int,
        seed: int,
    ) -> Landed:
        """Follow a Sun's light.

        Parameters
        ----------
        group : SunGroup
        picture : SunPicture
        finder : CellFinder
            Of the cells in which light is counted.
        photons : int
            Paths, beside those that choose where they start.
        seed : int

        Returns
        -------
        Landed
        """
        sides = [
            mi.Vector3f(*(dr.opaque(mi.Float, float(x)) for x in each))
            for each in (picture.corner, picture.across, picture.along)
        ]
        common = (self.scene, self.surfaces, self.only_by, finder, SunLight(group), *sides)
        depth = dr.opaque(mi.UInt32, self.max_depth)
        grid, fields_in = dr.opaque(mi.UInt32, self.grid), self.grid**2

        def follow(
            fields: AnyArray, index: AnyArray, weight: AnyArray, turn: int
        ) -> tuple[AnyArray, Landed]:
            slots = len(fields) * (self.max_depth - 1)
            landed = (
                dr.full(mi.UInt32, NONE, slots),
                dr.zeros(mi.UInt32, slots),
                dr.zeros(mi.Float, slots),
            )
            brought = _follow(
                *common,
                grid,
                mi.UInt32(fields.astype(np.uint32)),
                mi.UInt32(index.astype(np.uint32)),
                mi.Float(weight.astype(np.float32)),
                landed,
                depth,
                dr.opaque(mi.UInt32, (2 * seed + turn) % 2**32),
            )
            dr.eval(brought, landed)
            cell, direction, power = (np.array(each) for each in landed)
            there = cell != NONE
            return np.array(brought), Landed(cell[there], direction[there], power[there])

        fields = np.repeat(np.arange(fields_in), PILOT)
        index = np.tile(np.arange(PILOT), fields_in)
        brought, _ = follow(fields, index, np.ones(len(fields)), 1)
        if not brought.any():
            return Landed.joined([])
        share = np.sqrt((brought.reshape(-1, PILOT) ** 2).mean(axis=1))
        share = _smoothed(share)
        share += FLOOR * share.sum() / len(share)
        number = np.maximum(1, np.round(photons * share / share.sum())).astype(np.int64)
        weight = group.irradiance_w_m2 * picture.area_m2 / fields_in / number
        parts = _launches(number)
        return Landed.joined(follow(part[0], part[1], weight[part[0]], 0)[1] for part in parts)


def _smoothed(share: Floats) -> Floats:
    """Return what fields and those around them brought: few paths miss a small mirror."""
    from scipy.ndimage import uniform_filter

    side = round(len(share) ** 0.5)
    square = share.reshape(side, side)
    return np.asarray(np.maximum(square, uniform_filter(square, 3)).ravel())


def _launches(number: AnyArray) -> Sequence[tuple[AnyArray, AnyArray]]:
    """Return fields and indices of all paths, a launch's at a time."""
    fields = np.repeat(np.arange(len(number), dtype=np.uint32), number)
    begin = np.cumsum(number) - number
    index = np.arange(len(fields)) - begin[fields]
    cuts = range(PER_LAUNCH, len(fields), PER_LAUNCH)
    return list(zip(np.split(fields, cuts), np.split(index, cuts), strict=True))
