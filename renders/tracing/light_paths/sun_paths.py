"""Sunlight followed from the Sun, and written down wherever it lands after one bounce or more.

What foil and rings throw onto what they face is found from a lens by luck alone; followed from the
Sun each path that lands there counts the same. More start where a first few brought more (two-stage
sampling: the paths that chose are not counted). What the lens finds better is left to it: of that
few are kept, and count for more.

Source: Veach 1997, chapter 10; for shading normals his equation 5.19.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from models.arrays import AnyArray, Floats
from renders.tracing.kernel_lights import SunLight
from renders.tracing.leaving import leaving
from renders.tracing.light_groups import SunGroup
from renders.tracing.light_paths.landed import Landed
from renders.tracing.light_paths.packed_direction import packed
from renders.tracing.light_paths.weights import SAMPLES, projected, share_from_sun
from renders.tracing.sample_sequence import points_2d
from renders.tracing.surface_table import SurfaceTable

PILOT = 32  # paths from each field before it is known what they bring
FLOOR = 0.03  # of a field's share: what brought nothing yet is not left out
PER_LAUNCH = 1 << 20
KEPT = 0.25  # share of a path's light that it brings, from which it is always kept


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
    light: Any,
    corner: Any,
    across: Any,
    along: Any,
    grid: Any,
    field: Any,
    index: Any,
    weight: Any,
    paths_per_m2: Any,
    footprint: Any,
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
    ratio = mi.Float(paths_per_m2)
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
        worth = share_from_sun(ratio * footprint)
        kept = dr.minimum(1.0, worth * (1.0 / KEPT))
        chance = points_2d(index, own, 3 + 2 * depth).x
        lands = active & counted & (depth > 0) & surface.reflects & (chance < kept)
        slot = lane * (max_depth - 1) + depth - 1
        dr.scatter(landed[0], si.p.x, slot, lands)
        dr.scatter(landed[1], si.p.y, slot, lands)
        dr.scatter(landed[2], si.p.z, slot, lands)
        dr.scatter(landed[3], packed(-ray.d), slot, lands)
        dr.scatter(landed[4], carried / kept, slot, lands)
        dr.scatter(landed[5], ratio, slot, lands)
        brought += dr.select(active & counted & (depth > 0), carried * worth, 0.0)
        direction, density, weights = surface.sample(points_2d(index, own, 2 + 2 * depth))
        back = projected(surface.density_back(direction), surface.normal, -ray.d)
        forth = projected(density, surface.normal, direction)
        cosine = dr.abs(dr.dot(surface.normal, -ray.d))
        ratio *= forth * dr.select(depth == 0, cosine, 1.0 / back)
        slant = dr.dot(surface.shading_normal, -ray.d) * dr.dot(surface.normal, direction)
        slant /= dr.dot(surface.shading_normal, direction) * cosine
        carried *= weights[band] * slant
        depth += 1
        active &= (depth < max_depth) & (carried > 0.0) & surface.reflects
        ray = leaving(si.p, surface.normal, direction)
    return brought


@dataclass(frozen=True, eq=False)
class SunTracer:
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

    def landing(
        self, group: SunGroup, picture: SunPicture, footprint_m2: float, paths: int, seed: int
    ) -> Landed:
        """Follow a Sun's light.

        Parameters
        ----------
        group : SunGroup
        picture : SunPicture
        footprint_m2 : float, m2
            That a pixel covers of what it sees, about.
        paths : int
            Beside those that choose where they start.
        seed : int
        """
        sides = [
            mi.Vector3f(*(dr.opaque(mi.Float, float(x)) for x in each))
            for each in (picture.corner, picture.across, picture.along)
        ]
        common = (self.scene, self.surfaces, self.only_by, SunLight(group), *sides)
        depth = dr.opaque(mi.UInt32, self.max_depth)
        grid, fields_in = dr.opaque(mi.UInt32, self.grid), self.grid**2
        per_m2 = paths / picture.area_m2
        ends = (
            dr.opaque(mi.Float, per_m2),
            dr.opaque(mi.Float, float(np.pi * footprint_m2 / SAMPLES)),
        )

        def follow(
            fields: AnyArray, index: AnyArray, weight: AnyArray, turn: int
        ) -> tuple[AnyArray, Landed]:
            slots = len(fields) * (self.max_depth - 1)
            landed = (
                *(dr.zeros(mi.Float, slots) for _ in range(3)),
                dr.zeros(mi.UInt32, slots),
                *(dr.zeros(mi.Float, slots) for _ in range(2)),
            )
            brought = _follow(
                *common,
                grid,
                mi.UInt32(fields.astype(np.uint32)),
                mi.UInt32(index.astype(np.uint32)),
                mi.Float(weight.astype(np.float32)),
                *ends,
                landed,
                depth,
                dr.opaque(mi.UInt32, (2 * seed + turn) % 2**32),
            )
            dr.eval(brought, landed)
            x, y, z, direction, power, ratio = (np.array(each) for each in landed)
            there = power > 0.0
            places = np.stack([x, y, z], axis=1)
            return np.array(brought), Landed(
                places[there], direction[there], power[there], ratio[there]
            )

        fields = np.repeat(np.arange(fields_in), PILOT)
        index = np.tile(np.arange(PILOT), fields_in)
        brought, _ = follow(fields, index, np.ones(len(fields)), 1)
        if not brought.any():
            return Landed.joined([])
        share = np.sqrt((brought.reshape(-1, PILOT) ** 2).mean(axis=1))
        share = _smoothed(share)
        share += FLOOR * share.sum() / len(share)
        number = np.maximum(1, np.round(paths * share / share.sum())).astype(np.int64)
        weight = group.irradiance_w_m2 * picture.area_m2 / fields_in / number
        parts = _launches(number)
        return Landed.joined([follow(part[0], part[1], weight[part[0]], 0)[1] for part in parts])


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
