"""Surfaces as the one-pass kernel reads them: a table of numbers, and their lobes in closed form.

One table and one formula serve every material, so that a kernel calls no function per material and
light; docs/measurements.md tells what that saves. The same lobes are Mitsuba's ``diffuse``,
``roughconductor`` and ``blendbsdf``, against which they are tested.

Sources: GGX and its Smith shadowing, Walter et al. 2007, equations 33 and 34; visible normals,
Heitz 2018, as Mitsuba draws them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from renders.tracing import foil_creases
from renders.tracing.corner_cube import CubeView, aperture_share
from renders.tracing.fine_detail import WIDEST_M, shade
from renders.tracing.foil_creases import crease_slopes, lobe_factor
from renders.tracing.retroreflector import active_aperture
from renders.tracing.surfaces import Surface

UNSEEN = 1e9  # pixels over a disc's radius where there is none
LEAST_FACING = 0.05  # cosine under which a pixel's footprint grows no more
RETURN_SHARE = 0.5  # of the directions drawn at a retroreflector that go back to where light came


class SurfaceTable:
    """Surfaces by number, on the device.

    Parameters
    ----------
    surfaces : sequence of Surface
    number_of_shape : mapping
        Which of them a shape has, by the number that Dr.Jit gives the shape.
    """

    def __init__(self, surfaces: Sequence[Surface], number_of_shape: Mapping[int, int]) -> None:
        numbers = np.zeros(max(number_of_shape, default=0) + 1, dtype=np.uint32)
        for shape, number in number_of_shape.items():
            numbers[shape] = number
        self.numbers = mi.UInt32(numbers)
        self.matt = [_column(s.matt[band] / np.pi for s in surfaces) for band in range(3)]
        self.mirror = [_column(s.mirror[band] for s in surfaces) for band in range(3)]
        self.roughness = _column(s.roughness for s in surfaces)
        self.mirror_share = _column(s.mirror_share for s in surfaces)
        self.indices = None
        if any(s.indices for s in surfaces):  # 0: a metal's, which Fresnel's law leaves alone
            self.indices = [
                _column(s.indices[band] if s.indices else 0.0 for s in surfaces)
                for band in range(3)
            ]
        self.two_sided = None
        if not all(s.two_sided for s in surfaces):
            self.two_sided = _column(float(s.two_sided) for s in surfaces)
        optics = [s.retroreflector for s in surfaces]
        self.returned = None
        if any(optics):
            returned = [[o.returned.bands[band] if o else 0.0 for o in optics] for band in range(3)]
            self.returned = [_column(each) if any(each) else None for each in returned]
            angles = [np.deg2rad(o.half_angle_deg) if o else 0.0 for o in optics]
            self.cone_cosine = _column(float(np.cos(angle)) for angle in angles)
            self.cone_sine = _column(float(np.sin(angle)) for angle in angles)
            self.glass_index = _column(o.refractive_index if o else 1.0 for o in optics)
            self.return_share = _column(
                RETURN_SHARE if o and max(o.returned.bands) > 0.0 else 0.0 for o in optics
            )
        self.creases = _varied(s.detail.crease_slope for s in surfaces)
        self.mottling = _varied(s.detail.mottling for s in surfaces)
        self.tiles = _varied(s.detail.tile_spread for s in surfaces)
        self.discs = None
        if self.returned is not None and any(s.disc for s in surfaces):
            self.discs = [_column(each) for each in zip(*map(_disc_row, surfaces), strict=True)]
        dr.make_opaque(list(vars(self).values()))

    @property
    def has_detail(self) -> bool:
        """Whether any surface differs from place to place."""
        return any(each is not None for each in (self.creases, self.mottling, self.tiles))

    def seen(
        self, si: Any, ray: Any, bands: Sequence[int], active: Any, pixel_rad: Any = None
    ) -> SurfaceSeen:
        """Return what surfaces are where rays met them.

        Parameters
        ----------
        si : SurfaceInteraction3f
            Where rays met shapes.
        ray : Ray3f
        bands : sequence of int
            Those of the three bands that are asked for.
        active : Bool
            Lanes that met something.
        pixel_rad : Float, optional
            Angle of what one pixel sees along the ray; infinite where no detail is wanted.
        """
        number = dr.gather(
            mi.UInt32, self.numbers, dr.reinterpret_array(mi.UInt32, si.shape), active
        )
        seen = SurfaceSeen(self, number, si.n, si.sh_frame.n, -ray.d, bands, active)
        if pixel_rad is not None:
            seen.look_closely(si.p, si.n, si.t, pixel_rad)
        return seen


class SurfaceSeen:
    """Surfaces at some vertices, each seen from one direction.

    Both normals are turned towards the viewer. Where the smooth one still faces away the flat one
    shades: seen from there a smooth surface would show its back and be dark (Cycles found the
    adaptor ring's inner wall 6 % too dark).

    Parameters
    ----------
    table : SurfaceTable
    number : UInt32
        Which surface each is.
    normal, shading_normal, towards_viewer : Vector3f
        Unit vectors, target frame.
    bands : sequence of int
        Those of the three bands that are asked for.
    active : Bool
    """

    def __init__(
        self,
        table: SurfaceTable,
        number: Any,
        normal: Any,
        shading_normal: Any,
        towards_viewer: Any,
        bands: Sequence[int],
        active: Any,
    ) -> None:
        def of(column: Any) -> Any:
            return dr.gather(mi.Float, column, number, active)

        self._table, self._of, self._active = table, of, active
        self.creases: Any = None
        self.cube: CubeView | None = None
        self.shade: Any = None
        side = dr.dot(normal, towards_viewer)
        flat = mi.Vector3f(dr.mulsign(normal, side))
        smooth = mi.Vector3f(dr.mulsign(shading_normal, dr.dot(shading_normal, flat)))
        self.normal = flat
        self.shading_normal = dr.select(dr.dot(smooth, towards_viewer) > 0.0, smooth, flat)
        self.towards_viewer = towards_viewer
        self.bands = bands
        self.reflects = active
        if table.two_sided is not None:
            self.reflects = active & ((side > 0.0) | (of(table.two_sided) > 0.0))
        self.matt = {band: of(table.matt[band]) for band in bands}
        self.mirror = {band: of(table.mirror[band]) for band in bands}
        self.indices = None
        if table.indices is not None:
            self.indices = {band: of(table.indices[band]) for band in bands}
        self.roughness = of(table.roughness)
        self.mirror_share = of(table.mirror_share)
        self.width = self.roughness * self.roughness
        self.cosine = dr.dot(self.shading_normal, towards_viewer)
        self.seen_facets = 0.5 * self.width / (dr.pi * (self.cosine + self._slant(self.cosine)))
        self.returned = None
        if table.returned is not None:
            columns = {band: table.returned[band] for band in bands}
            self.returned = {
                band: of(column) for band, column in columns.items() if column is not None
            }
            self.cone_cosine, self.cone_sine = of(table.cone_cosine), of(table.cone_sine)
            self.glass_index = of(table.glass_index)
            self.return_share = of(table.return_share)

    def look_closely(self, place: Any, normal: Any, distance: Any, pixel_rad: Any) -> None:
        """See the detail that pixels resolve.

        Parameters
        ----------
        place : Point3f, m
            Target frame.
        normal : Vector3f
            Of the triangle.
        distance : Float, m
            From the viewer.
        pixel_rad : Float
            Angle of what one pixel sees.
        """
        table, of = self._table, self._of
        facing = dr.abs(dr.dot(self.normal, self.towards_viewer))
        footprint = distance * pixel_rad * dr.rsqrt(dr.maximum(facing, LEAST_FACING))
        if table.has_detail:
            self._look_for_detail(place, normal, footprint)
        if table.discs is not None:
            x, y, z, *axes, radius = (of(column) for column in table.discs)
            there = radius > 0.0
            scale = dr.select(there, 1.0 / dr.maximum(radius, 1e-6), 0.0)
            off = (place - mi.Point3f(x, y, z)) * scale
            along, across = mi.Vector3f(*axes[:3]), mi.Vector3f(*axes[3:])
            pixel = dr.select(there, footprint * scale, UNSEEN)
            near = radius / distance
            self.cube = CubeView(dr.dot(off, along), dr.dot(off, across), pixel, near)
            self._cube_axes = along, across

    def _look_for_detail(self, place: Any, normal: Any, footprint: Any) -> None:
        table, of = self._table, self._of
        zero = dr.zeros(mi.Float, dr.width(footprint))
        creases, mottling, tiles = (
            zero if column is None else of(column)
            for column in (table.creases, table.mottling, table.tiles)
        )

        def shade_at(*args: Any) -> Any:
            return shade(dr, *args)

        def slopes_at(place: Any, width: Any) -> tuple[Any, ...]:
            slopes, variance = crease_slopes(dr, place, width)
            return mi.Vector3f(*slopes), variance

        args = mi.Vector3f(place), mi.Vector3f(normal), footprint, mottling, tiles
        near = self._active & (footprint < WIDEST_M)
        self.shade = dr.if_stmt(args, near, shade_at, lambda *_: mi.Float(1.0))
        if table.creases is not None:
            near = self._active & (footprint < foil_creases.WIDEST_M) & (creases > 0.0)
            slopes, variance = dr.if_stmt(
                (args[0], footprint), near, slopes_at, lambda *_: (mi.Vector3f(0.0), mi.Float(0.0))
            )
            slopes -= self.shading_normal * dr.dot(self.shading_normal, slopes)
            self.creases = (slopes * creases, variance * creases * creases)

    def _slant(self, cosine: Any) -> Any:
        """Return ``c (1 + 2 Lambda)`` of Smith's shadowing, whose G1 is ``2 c / (c + that)``."""
        squared = cosine * cosine
        return dr.sqrt(squared + self.width * (1.0 - squared))

    def _spread(self, cosine: Any, half_squared: Any) -> Any:
        """Return what GGX's density is the inverse square of, but for its width.

        The cosine ``n.h`` of the half vector is ``(n.v + n.l) / |v + l|``.
        """
        both = self.cosine + cosine
        return 1.0 + both * both / half_squared * (self.width - 1.0)

    def _half_squared(self, towards: Any) -> Any:
        """Return ``|v + l|^2``, not as ``2 + 2 v.l``: where light grazes, that has few digits."""
        return dr.squared_norm(self.towards_viewer + towards)

    def value(self, band: int, towards: Any) -> Any:
        """Return ``f cos`` towards the viewer of light from a direction, 1/sr.

        Parameters
        ----------
        band : int
        towards : Vector3f
            Unit vector towards where light comes from; what it gives below the surface is for the
            caller to discard.
        """
        cosine = dr.dot(self.shading_normal, towards)
        half_squared = self._half_squared(towards)
        spread = self._spread(cosine, half_squared)
        mirrored = 2.0 * self.mirror[band] * self.seen_facets * cosine
        mirrored /= spread * spread * (cosine + self._slant(cosine))
        if self.indices is not None:
            index = self.indices[band]
            incidence_cosine = 0.5 * dr.sqrt(half_squared)
            share = mi.fresnel(incidence_cosine, dr.maximum(index, 1.0))[0]
            mirrored *= dr.select(index > 0.0, share, 1.0)
        if self.creases is not None:
            slopes, variance = self.creases
            both = self.cosine + cosine
            lean = dr.dot(self.towards_viewer + towards, slopes) / both
            steep = dr.maximum(half_squared / (both * both) - 1.0, 0.0)
            creased = dr.squared_norm(slopes)
            mirrored *= lobe_factor(dr, lean, steep, creased, self.width, variance)
        total = self.matt[band] * cosine + mirrored
        if self.shade is not None:
            total *= self.shade
        if self.returned and band in self.returned:  # a cube sends no sunlight back to the camera
            half_cosine = (self.cosine + cosine) * dr.rsqrt(half_squared)
            aperture = active_aperture(half_cosine, self.glass_index)
            if self.cube is not None:
                half = (self.towards_viewer + towards) * dr.rsqrt(half_squared)
                x, y = (dr.dot(half, axis) for axis in self._cube_axes)
                aperture = aperture_share(dr, self.cube, x, y, self.glass_index, aperture)
            lobe = self.returned[band] * aperture * cosine
            within = dr.dot(self.towards_viewer, towards) >= self.cone_cosine
            within &= self.returned[band] > 0.0
            total += dr.select(within, lobe / (dr.pi * self.cone_sine * self.cone_sine), 0.0)
        return total

    def faces(self, towards: Any) -> Any:
        """Tell whether a direction is above the surface, as it is and as it is shaded."""
        above = dr.dot(self.normal, towards) > 0.0
        return self.reflects & above & (dr.dot(self.shading_normal, towards) > 0.0)

    def density(self, towards: Any) -> Any:
        """Return the density with which ``sample`` draws a direction, 1/sr."""
        cosine = dr.dot(self.shading_normal, towards)
        spread = self._spread(cosine, self._half_squared(towards))
        facets = self.seen_facets / (spread * spread)
        face = self.mirror_share * facets + (1.0 - self.mirror_share) * cosine / dr.pi
        return self._with_cone(face, towards)

    def density_back(self, towards: Any) -> Any:
        """Return the density with which ``sample`` would draw the viewer, seen from a direction.

        Parameters
        ----------
        towards : Vector3f
            Unit vector towards what would be the viewer.
        """
        cosine = dr.dot(self.shading_normal, towards)
        spread = self._spread(cosine, self._half_squared(towards))
        facets = 0.5 * self.width / (dr.pi * (cosine + self._slant(cosine)) * spread * spread)
        face = self.mirror_share * facets + (1.0 - self.mirror_share) * self.cosine / dr.pi
        return self._with_cone(face, towards)

    def _with_cone(self, face: Any, towards: Any) -> Any:
        """Return a density with what retroreflectors draw back to where light came from."""
        if self.returned is None:
            return face
        within = dr.dot(self.towards_viewer, towards) >= self.cone_cosine
        cone = dr.select(within, 0.5 / (dr.pi * (1.0 - self.cone_cosine)), 0.0)
        share = self.return_share
        return dr.select(share > 0.0, share * cone + (1.0 - share) * face, face)

    def sample(self, square: Any) -> tuple[Any, Any, dict[int, Any]]:
        """Draw the direction that a path goes on to.

        Parameters
        ----------
        square : Point2f
            A point of the unit square. Its first coordinate chooses the lobe and is stretched
            again, so that points spread evenly stay so within each lobe.

        Returns
        -------
        direction : Vector3f
        density : Float, 1/sr
        weights : dict of Float, by band
            ``f cos / density``; 0 below the surface.
        """
        frame = mi.Frame3f(self.shading_normal)
        viewer = frame.to_local(self.towards_viewer)
        first, back = square.x, None
        if self.returned is not None:
            back = first < self.return_share
            rest = (first - self.return_share) / (1.0 - self.return_share)
            first = dr.select(back, first / self.return_share, rest)
        share = self.mirror_share
        from_mirror = first < share
        stretched = dr.select(from_mirror, first / share, (first - share) / (1.0 - share))
        point = mi.Point2f(dr.minimum(stretched, dr.one_minus_epsilon(mi.Float)), square.y)
        facets = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, self.roughness)
        mirrored = mi.reflect(viewer, facets.sample(viewer, point)[0])
        scattered = mi.warp.square_to_cosine_hemisphere(point)
        direction = frame.to_world(dr.select(from_mirror, mirrored, scattered))
        if self.returned is not None:
            cone = mi.warp.square_to_uniform_cone(mi.Point2f(first, square.y), self.cone_cosine)
            returned = mi.Frame3f(self.towards_viewer).to_world(cone)
            direction = dr.select(back, returned, direction)
        density = self.density(direction)
        good = self.faces(direction) & (density > 0.0)
        weights = {
            band: dr.select(good, self.value(band, direction) / density, 0.0) for band in self.bands
        }
        return direction, density, weights


def _varied(values: Iterable[float]) -> Any:
    every = list(values)
    return _column(every) if any(every) else None


def _disc_row(surface: Surface) -> tuple[float, ...]:
    disc = surface.disc
    if disc is None:
        return (0.0,) * 10
    return (*disc.centre, *disc.along, *disc.across, disc.radius_m)


def _column(values: Iterable[float]) -> Any:
    return mi.Float(np.fromiter(values, dtype=np.float32))
