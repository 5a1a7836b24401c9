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
from renders.tracing.light_groups import LightGroup
from renders.tracing.sample_sequence import points_2d
from renders.tracing.surface_table import SurfaceTable

PAIRS_PER_VERTEX = 3  # of random dimensions: place on a disc, choice of LED, lobe
START_PER_M = 2e-6  # a hit's place is exact to some 2e-7 of its largest coordinate
MOST_LANES = 16  # of a pixel, as many as a wide packet; more samples are walked in turns
ADDED_LANES = 8  # in the kernel: one packet's or two's, whose sum does not depend on their order
FAINT = 0.3  # of what a light's samples brought so far: what adds less is left to chance
CUDA_SAMPLES = 16  # a lane there walks at least as many: the sums of all lie in memory


def power_share(one: Any, other: Any) -> Any:
    """Return the power heuristic's weight of ``one`` density beside ``other``, exponent two."""
    ratio = other / one
    return 1.0 / (1.0 + ratio * ratio)


def leaving(place: Any, normal: Any, direction: Any) -> Any:
    """Return the ray that leaves a surface, from as near to it as 32 bits allow.

    Mitsuba's own ``spawn_ray`` starts 45 times farther off, 0.4 mm at 4 m from the origin, and so
    loses the shadows of what is thin: gaps between solar cells, tabs, blankets' edges. Cycles
    showed it: cells 2.5 % too bright under S2, 60 % under the grazing S3.

    Parameters
    ----------
    place : Point3f, m
        On the surface, target frame.
    normal : Vector3f
        Unit, on the side that the ray leaves to.
    direction : Vector3f
        Unit.
    """
    return mi.Ray3f(place + normal * (START_PER_M * (1.0 + dr.max(dr.abs(place)))), direction)


@dr.syntax(recursive=False)  # type: ignore[untyped-decorator]
def _trace(
    scene: Any,
    surfaces: Any,
    bands: Any,
    ray_of: Any,
    lights: Any,
    pixels: Any,
    first: Any,
    last: Any,
    width: Any,
    max_depth: Any,
    segments: Any,
    key: Any,
) -> Any:
    """Return a list of radiance sums, one array over the pixels for each light."""
    sums = [dr.zeros(mi.Float, dr.width(pixels)) for _ in lights]
    column = mi.Float(pixels % width)
    row = mi.Float(pixels // width)
    index = mi.UInt32(first)
    while index < last:
        place = points_2d(index, key, mi.UInt32(0))
        ray = ray_of(column + place.x - 0.5, row + place.y - 0.5)
        throughput = {band: mi.Float(1.0) for band in bands}
        depth = mi.UInt32(0)
        active = mi.Bool(True)
        ray_density = mi.Float(dr.inf)  # of its direction; the camera's rays are certain
        faint = FAINT / mi.Float(index - first + 1)
        while active:
            si = scene.ray_intersect(ray, mi.RayFlags.ShadingFrame, depth == 0, active)
            escaped = active & ~si.is_valid()
            active &= si.is_valid() & (depth < max_depth)
            surface = surfaces.seen(si, ray, bands, active)
            pair = 1 + depth * PAIRS_PER_VERTEX
            disc = mi.warp.square_to_uniform_disk_concentric(points_2d(index, key, pair))
            choice = points_2d(index, key, pair + 1)
            for number, light in enumerate(lights):
                if dr.hint(light.wide, mode="scalar"):
                    arrived = throughput[light.channel] * light.radiance(ray.d)
                    arrived *= power_share(ray_density, light.density)
                    sums[number] += dr.select(escaped, arrived, 0.0)
                towards, distance, irradiance = light.sample(si.p, disc, choice.x)
                share = surface.value(light.channel, towards)
                share *= throughput[light.channel] * irradiance
                if dr.hint(light.wide, mode="scalar"):
                    share *= power_share(light.density, surface.density(towards))
                least = faint * sums[number]
                facing = surface.faces(towards) & (share > choice.y * least)
                shadow = leaving(si.p, surface.normal, towards)
                shadow.maxt = distance * (1.0 - 1e-4)
                dark = scene.ray_test(shadow, depth == 0, facing)
                sums[number] += dr.select(facing & ~dark, dr.maximum(share, least), 0.0)
            depth += 1
            active &= (depth < segments) & surface.reflects
            direction, ray_density, weights = surface.sample(points_2d(index, key, pair + 2))
            carried = mi.Bool(False)
            for band in bands:
                throughput[band] *= weights[band]
                carried |= throughput[band] > 0.0
            active &= carried
            ray = leaving(si.p, surface.normal, direction)
        index += 1
    return sums


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
) -> dict[str, Radiance]:
    """Path-trace some pixels for all groups at once.

    Parameters
    ----------
    scene : mitsuba.Scene
        Geometry in the target frame; its emitters and BSDFs are not used.
    surfaces : SurfaceTable
        What its shapes return.
    camera : Camera
    cam_from_target : RigidTransform
    groups : sequence of LightGroup
    pixels : (n,) uint32 array
        Indices ``row * width + column``.
    samples : int
        Per pixel; spread most evenly if a power of two.
    max_depth : int
        Surface interactions a path may have; 1 is direct light only.
    seed : int

    Returns
    -------
    dict of (n,) float32 arrays, W m-2 sr-1, by group name.
    """
    target_from_cam = cam_from_target.inverse()
    rotation = [
        mi.Vector3f(*(dr.opaque(mi.Float, float(x)) for x in target_from_cam.rotation[:, axis]))
        for axis in range(3)
    ]
    lens = mi.Point3f(*(dr.opaque(mi.Float, float(x)) for x in target_from_cam.translation))

    def ray_of(u: Any, v: Any) -> Any:
        in_cam = ray_direction_in_cam(camera, u, v)
        direction = rotation[0] * in_cam.x + rotation[1] * in_cam.y + rotation[2] * in_cam.z
        return mi.Ray3f(lens, dr.normalize(direction))

    lights = [light_of(group, cam_from_target) for group in groups]
    # A wide light is also met by the ray that leaves a path's last surface.
    segments = max_depth + 1 if any(light.wide for light in lights) else max_depth
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
    sums = _trace(
        scene,
        surfaces,
        sorted({light.channel for light in lights}),
        ray_of,
        lights,
        pixel,
        first,
        first + each,
        mi.UInt32(camera.width),
        dr.opaque(mi.UInt32, max_depth),
        dr.opaque(mi.UInt32, segments),
        pixel_keys(seed, pixel),
    )
    means = pixel_means(sums, lanes, shares, samples)
    return {group.name: mean for group, mean in zip(groups, means, strict=True)}
