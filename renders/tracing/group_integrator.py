"""One path-traced pass that keeps every light in its own channel (JIT variants).

Primary hits and bounces are shared: at each vertex every light is sampled on its own, its
contribution goes to its own sum, and one direction carries the path on for all of them. The
random numbers of a pixel depend on the seed and the pixel alone, not on the lights or on the window
that is rendered; how its samples are added up does not either: equal seeds give equal bits.

No path is ended by chance (Russian roulette): sixteen lanes walk the scene together, so that a dead
lane saves little, and what it loses shows as noise. Shadow rays are: a light that would add little
to what its path already brought is asked for by chance, in proportion, and then counts for more.
Measured, not assumed; see docs/measurements.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from models.arrays import AnyArray, Radiance
from models.camera import Camera
from models.pose import RigidTransform
from renders.tracing.camera_plugin import ray_direction_in_cam
from renders.tracing.kernel_lights import light_of
from renders.tracing.leaving import leaving
from renders.tracing.light_groups import LightGroup
from renders.tracing.light_paths.from_sun import NOTHING, FromSun
from renders.tracing.light_paths.pixel_solid_angle import solid_angle
from renders.tracing.light_paths.weights import lens_end, projected, share_from_lens
from renders.tracing.sample_sequence import points_2d
from renders.tracing.surface_table import SurfaceTable

PAIRS_PER_VERTEX = 3  # of random dimensions: place on a disc, choice of LED, lobe
MOST_LANES = 16  # of a pixel, as many as a wide packet; more samples are walked in turns
ADDED_LANES = 8  # in the kernel: one packet's or two's, whose sum does not depend on their order
FAINT = 0.3  # of what a light's samples brought so far: what adds less is left to chance
CUDA_SAMPLES = 16  # a lane there walks at least as many: the sums of all lie in memory


def power_share(one: Any, other: Any) -> Any:
    """Return the power heuristic's weight of ``one`` density beside ``other``, exponent two."""
    ratio = other / one
    return 1.0 / (1.0 + ratio * ratio)


@dr.syntax(recursive=False)  # type: ignore[untyped-decorator]
def _trace(
    scene: Any,
    surfaces: Any,
    bands: Any,
    ray_of: Any,
    lights: Any,
    paths: Any,
    pixels: Any,
    first: Any,
    last: Any,
    limits: Any,
    moments: Any,
    width: Any,
    max_depth: Any,
    segments: Any,
    pixel_rad: Any,
    key: Any,
) -> Any:
    """Return lists, one array over the lanes for each light: sums of radiance, and its moments.

    Where there are limits each light ends at its own number of samples. Where there are
    ``moments`` they are summed too: first and second of the light that came straight, second of
    all other.
    """
    sums = [dr.zeros(mi.Float, dr.width(pixels)) for _ in lights]
    straight = [dr.zeros(mi.Float, dr.width(pixels)) for _ in moments]
    straight_squared = [dr.zeros(mi.Float, dr.width(pixels)) for _ in moments]
    bounced_squared = [dr.zeros(mi.Float, dr.width(pixels)) for _ in moments]
    column = mi.Float(pixels % width)
    row = mi.Float(pixels // width)
    index = mi.UInt32(first)
    while index < last:
        place = points_2d(index, key, mi.UInt32(0))
        ray, pixel_sr = ray_of(column + place.x - 0.5, row + place.y - 0.5)
        throughput = {band: mi.Float(1.0) for band in bands}
        depth = mi.UInt32(0)
        active = mi.Bool(True)
        met_chaser = mi.Bool(False)
        ratio = mi.Float(1.0)  # of what the Sun finds over what the lens does; see ``weights``
        ray_density = mi.Float(dr.inf)  # of its direction; the camera's rays are certain
        faint = FAINT / mi.Float(index - first + 1)
        before = [mi.Float(each) for each in sums]
        after_first = [mi.Float(each) for each in sums]
        while active:
            si = scene.ray_intersect(ray, mi.RayFlags.ShadingFrame, depth == 0, active)
            escaped = active & ~si.is_valid()
            active &= si.is_valid() & (depth < max_depth)
            seen_by = dr.select(depth == 0, pixel_rad, dr.inf)  # bounced light sees the mean
            surface = surfaces.seen(si, ray, bands, active, seen_by)
            if dr.hint(len(paths.names) > 0, mode="scalar"):
                end = lens_end(surface.normal, -ray.d, si.t, pixel_sr)
                ratio = dr.select(depth == 0, end, ratio)
                met_chaser |= paths.meets_chaser(si.shape, active)
            pair = 1 + depth * PAIRS_PER_VERTEX
            disc = mi.warp.square_to_uniform_disk_concentric(points_2d(index, key, pair))
            choice = points_2d(index, key, pair + 1)
            for number, light in enumerate(lights):
                wanted = mi.Bool(active)
                if dr.hint(len(limits) > 0, mode="scalar"):
                    wanted &= index < limits[number]
                if dr.hint(light.wide, mode="scalar"):
                    arrived = throughput[light.channel] * light.radiance(ray.d)
                    arrived *= power_share(ray_density, light.density)
                    sums[number] += dr.select(escaped, arrived, 0.0)
                towards, distance, irradiance = light.sample(si.p, disc, choice.x)
                share = surface.value(light.channel, towards)
                share *= throughput[light.channel] * irradiance
                if dr.hint(light.wide, mode="scalar"):
                    share *= power_share(light.density, surface.density(towards))
                if dr.hint(light.name in paths.names, mode="scalar"):
                    from_sun = projected(surface.density_back(towards), surface.normal, -ray.d)
                    from_sun *= ratio * paths.of(light.name, met_chaser)
                    from_sun *= dr.abs(dr.dot(surface.normal, towards))
                    share *= dr.select(depth == 0, 1.0, share_from_lens(from_sun))
                least = faint * sums[number]
                facing = wanted & surface.faces(towards) & (share > choice.y * least)
                shadow = leaving(si.p, surface.normal, towards)
                shadow.maxt = distance * (1.0 - 1e-4)
                dark = scene.ray_test(shadow, depth == 0, facing)
                sums[number] += dr.select(facing & ~dark, dr.maximum(share, least), 0.0)
            for number in range(len(moments)):
                after_first[number] = dr.select(depth == 0, sums[number], after_first[number])
            depth += 1
            active &= (depth < segments) & surface.reflects
            direction, ray_density, weights = surface.sample(points_2d(index, key, pair + 2))
            if dr.hint(len(paths.names) > 0, mode="scalar"):
                back = projected(surface.density_back(direction), surface.normal, -ray.d)
                ratio *= dr.select(depth == 1, 1.0, back)
                ratio /= dr.maximum(projected(ray_density, surface.normal, direction), 1e-9)
            carried = mi.Bool(False)
            for band in bands:
                throughput[band] *= weights[band]
                carried |= throughput[band] > 0.0
            active &= carried
            ray = leaving(si.p, surface.normal, direction)
        for number in range(len(limits)):
            sums[number] = dr.select(index < limits[number], sums[number], before[number])
        for number in range(len(moments)):
            first_light = after_first[number] - before[number]
            straight[number] += first_light
            straight_squared[number] += dr.square(first_light)
            bounced_squared[number] += dr.square(sums[number] - after_first[number])
        index += 1
    return sums, straight, straight_squared, bounced_squared


def pixel_keys(seed: int, pixels: Any) -> Any:
    """Return a random key for each pixel; the seed is opaque: a literal would compile anew."""
    return mi.sample_tea_32(pixels, dr.opaque(mi.UInt32, seed))[0]


def lanes_per_pixel(samples: int, least: int = 1) -> int:
    """Return into how many lanes, a power of two, the samples of a pixel are shared evenly.

    Parameters
    ----------
    samples : int
    least : int
        Samples that a lane should walk if a pixel has several.
    """
    shares = 1
    while samples % (2 * shares) == 0 and samples // (2 * shares) >= least and shares < MOST_LANES:
        shares *= 2
    return shares


def pixel_means(sums: Sequence[Any], lanes: Any, shares: int, samples: int) -> list[Radiance]:
    """Add up what the lanes of each pixel found, in an order that its company does not change.

    On a processor a few lanes are added up in the kernel, so that little of what is a lane's own
    goes to memory. On CUDA they would race: there all of it does.

    Parameters
    ----------
    sums : sequence of Float, W m-2 sr-1
        One a group: what each lane's samples add up to.
    lanes : UInt32
        0, 1, 2, ...; those of a pixel follow each other.
    shares : int
        Lanes a pixel.
    samples : int
        Of a pixel, by all of its lanes.

    Returns
    -------
    list of (n,) float32 arrays, W m-2 sr-1
        One a group, one number a pixel.
    """
    together = min(shares, ADDED_LANES)
    if dr.backend_v(mi.Float) == dr.JitBackend.CUDA:
        totals = [dr.block_sum(each, together, mode="evaluated") for each in sums]
    else:
        totals = [dr.zeros(mi.Float, dr.width(lanes) // together) for _ in sums]
        place = lanes // dr.opaque(mi.UInt32, together)
        for total, each in zip(totals, sums, strict=True):
            dr.scatter_add(total, each, place, mode=dr.ReduceMode.Local)
    dr.eval(totals)
    means = []
    for total in totals:
        parts = np.array(total).reshape(-1, shares // together)
        mean = parts[:, 0].copy()
        for part in parts.T[1:]:  # NumPy's own sum over so short an axis is ten times slower
            mean += part
        means.append(mean * np.float32(1.0 / samples))
    return means


class Walk:
    """A kernel for some groups and one camera: it walks samples of pixels, and adds up their light.

    Parameters
    ----------
    scene : mitsuba.Scene
        Geometry in the target frame; its emitters and BSDFs are not used.
    surfaces : SurfaceTable
        What its shapes return.
    camera : Camera
    cam_from_target : RigidTransform
    groups : sequence of LightGroup
    max_depth : int
        Surface interactions a path may have; 1 is direct light only.
    found : FromSun
        What of some groups' light is found from the Sun, and not by this walk.
    """

    def __init__(
        self,
        scene: Any,
        surfaces: SurfaceTable,
        camera: Camera,
        cam_from_target: RigidTransform,
        groups: Sequence[LightGroup],
        max_depth: int,
        found: FromSun = NOTHING,
    ) -> None:
        self.scene, self.surfaces, self.camera = scene, surfaces, camera
        self.paths = found.kernel()
        self.groups, self.max_depth = groups, max_depth
        target_from_cam = cam_from_target.inverse()
        self.rotation = [
            mi.Vector3f(*(dr.opaque(mi.Float, float(x)) for x in target_from_cam.rotation[:, axis]))
            for axis in range(3)
        ]
        self.lens = mi.Point3f(
            *(dr.opaque(mi.Float, float(x)) for x in target_from_cam.translation)
        )
        self.lights = [light_of(group, cam_from_target) for group in groups]

    def ray_of(self, u: Any, v: Any) -> tuple[Any, Any]:
        """Return the ray through a pixel, target frame, and the pixel's solid angle, sr.

        Pixel centres are integers.
        """
        in_cam = ray_direction_in_cam(self.camera, u, v)
        x, y, z = self.rotation
        ray = mi.Ray3f(self.lens, dr.normalize(x * in_cam.x + y * in_cam.y + z * in_cam.z))
        return ray, solid_angle(self.camera, in_cam.x / in_cam.z, in_cam.y / in_cam.z)

    def __call__(
        self,
        pixels: Any,
        first: Any,
        last: Any,
        seed: int,
        limits: Sequence[Any] = (),
        moments: bool = False,
    ) -> tuple[list[Any], ...]:
        """Walk the samples from ``first`` to before ``last`` of a pixel, lane by lane.

        Parameters
        ----------
        pixels, first, last : UInt32
            Indices ``row * width + column``, and numbers of samples.
        seed : int
        limits : sequence of UInt32
            The number of samples that each group wants of the lane's pixel; all, unless given.
        moments : bool
            Whether to sum more than radiance.

        Returns
        -------
        four lists of Float, one array over the lanes for each group
            Sums of radiance, W m-2 sr-1; with ``moments``, of that part of it which came straight
            from the light to the surface that is seen, of that part's square, and of the square of
            all other.
        """
        # A wide light is also met by the ray that leaves a path's last surface.
        wide = any(light.wide for light in self.lights)
        return _trace(
            self.scene,
            self.surfaces,
            sorted({light.channel for light in self.lights}),
            self.ray_of,
            self.lights,
            self.paths,
            pixels,
            first,
            last,
            list(limits),
            [number for number in range(len(self.lights)) if moments],
            mi.UInt32(self.camera.width),
            dr.opaque(mi.UInt32, self.max_depth),
            dr.opaque(mi.UInt32, self.max_depth + 1 if wide else self.max_depth),
            dr.opaque(mi.Float, 1.0 / max(self.camera.fx, self.camera.fy)),
            pixel_keys(seed, pixels),
        )


def trace_groups(
    scene: Any,
    surfaces: SurfaceTable,
    camera: Camera,
    cam_from_target: RigidTransform,
    groups: Sequence[LightGroup],
    pixels: AnyArray,
    samples: int,
    max_depth: int,
    seed: int,
    found: FromSun = NOTHING,
) -> dict[str, Radiance]:
    """Path-trace some pixels for all groups at once, as many samples in each.

    Parameters
    ----------
    scene, surfaces, camera, cam_from_target, groups, max_depth, found
        As ``Walk`` has them.
    pixels : (n,) uint32 array
        Indices ``row * width + column``.
    samples : int
        Per pixel; spread most evenly if a power of two.
    seed : int

    Returns
    -------
    dict of (n,) float32 arrays, W m-2 sr-1, by group name.
    """
    walk = Walk(scene, surfaces, camera, cam_from_target, groups, max_depth, found)
    on_cuda = dr.backend_v(mi.Float) == dr.JitBackend.CUDA
    shares = lanes_per_pixel(samples, CUDA_SAMPLES if on_cuda else 1)
    # The samples of a pixel lie side by side: lanes that are walked together see one place.
    lanes = dr.arange(mi.UInt32, len(pixels) * shares)
    pixel = dr.gather(
        mi.UInt32,
        mi.UInt32(np.asarray(pixels, dtype=np.uint32)),
        lanes // dr.opaque(mi.UInt32, shares),
    )
    each = dr.opaque(mi.UInt32, samples // shares)
    first = lanes % dr.opaque(mi.UInt32, shares) * each
    sums, *_ = walk(pixel, first, first + each, seed)
    means = pixel_means(sums, lanes, shares, samples)
    return {group.name: mean for group, mean in zip(groups, means, strict=True)}
