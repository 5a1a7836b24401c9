"""One path-traced pass that keeps every light in its own channel (JIT variants).

Primary hits and bounces are shared: at each vertex every light is sampled on its own, its
contribution goes to its own sum, and one BSDF sample carries the path on for all of them. Lanes
are pixels and samples are a loop inside the kernel, so nothing is added atomically: equal seeds
give equal bits. The random numbers of a pixel depend on the seed and the pixel alone, not on the
lights or on the window that is rendered.

No path is ended by chance (Russian roulette): sixteen lanes walk the scene together, so that a dead
lane saves little, and what it loses shows as noise. Measured, not assumed; see docs/decisions.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from models.arrays import AnyArray, Floats, Radiance
from models.camera import Camera
from models.pose import RigidTransform
from renders.camera_plugin import ray_direction_in_cam
from renders.light_groups import EarthGroup, LampGroup, LightGroup, SunGroup
from renders.sample_sequence import points_2d

PAIRS_PER_VERTEX = 3  # of random dimensions: place on a disc, choice of LED and lobe, lobe
LANE_SAMPLES = 16  # a pixel with more samples is shared by several lanes: no core idles


class SunLight:
    """A Sun group as the kernel samples it.

    Its disc is a twentieth as wide as the narrowest lobe (GGX 0.05), so that sampling the disc
    alone leaves next to no noise: no multiple importance sampling.
    """

    wide = False

    def __init__(self, group: SunGroup) -> None:
        self.channel = group.channel
        self.radius = group.sine_of_radius
        self.irradiance = dr.opaque(mi.Float, group.irradiance_w_m2)
        self.direction = _opaque_vector(group.direction_in_target)

    def sample(self, point: Any, disc: Any, choice: Any) -> tuple[Any, Any, Any]:
        """Return (unit direction to the light, distance or inf, irradiance facing it)."""
        frame = mi.Frame3f(self.direction)
        offset = self.radius * disc
        towards = dr.normalize(self.direction + frame.s * offset.x + frame.t * offset.y)
        return towards, mi.Float(dr.inf), self.irradiance


class EarthLight:
    """An Earth group as the kernel samples it: uniformly within its disc.

    Glossy surfaces see it as a picture, so light and lobe are both sampled, and weighed by the
    power heuristic (Veach 1997, equation 9.13).
    """

    wide = True

    def __init__(self, group: EarthGroup) -> None:
        earth = group.earth
        self.channel = group.channel
        self.reach = dr.opaque(mi.Float, 1.0 / earth.sine_of_radius)
        self.cosine = dr.opaque(mi.Float, float(np.sqrt(1.0 - earth.sine_of_radius**2)))
        self.density = dr.opaque(mi.Float, 1.0 / earth.solid_angle_sr)
        self.level = dr.opaque(mi.Float, earth.albedo * earth.sun_irradiance_w_m2 / np.pi)
        self.centre = _opaque_vector(earth.direction_in_target)
        self.sun = _opaque_vector(earth.sun_dir_in_target)

    def radiance(self, direction: Any) -> Any:
        """Return what comes from a direction; ``models.lights.earth`` has the same for arrays."""
        along = dr.dot(direction, self.centre)
        inside = 1.0 - self.reach * self.reach * (1.0 - along * along)
        distance = self.reach * along - dr.sqrt(dr.maximum(inside, 0.0))
        normal = distance * direction - self.reach * self.centre
        lit = self.level * dr.maximum(dr.dot(normal, self.sun), 0.0)
        return dr.select((inside > 0.0) & (along > 0.0), lit, 0.0)

    def sample(self, point: Any, disc: Any, choice: Any) -> tuple[Any, Any, Any]:
        """Return (unit direction to a place on the Earth, inf, irradiance facing it)."""
        squared = dr.squared_norm(disc)
        cosine = 1.0 - squared * (1.0 - self.cosine)
        sine_over_radius = dr.sqrt((1.0 - self.cosine) * (1.0 + cosine))
        local = mi.Vector3f(disc.x * sine_over_radius, disc.y * sine_over_radius, cosine)
        towards = mi.Frame3f(self.centre).to_world(local)
        return towards, mi.Float(dr.inf), self.radiance(towards) / self.density


class LampLight:
    """A lamp group as the kernel samples it: one LED of the ring, chosen uniformly."""

    wide = False

    def __init__(self, group: LampGroup, cam_from_target: RigidTransform) -> None:
        target_from_cam = cam_from_target.inverse()
        self.channel = group.channel
        self.count = float(group.ring.count)
        self.exponent = float(group.ring.exponent)
        self.intensity = dr.opaque(mi.Float, group.ring.intensity_w_sr)
        points = np.asarray(group.points_in_target(cam_from_target), dtype=np.float32)
        self.points = mi.Float(points.ravel())
        dr.make_opaque(self.points)
        self.axis = _opaque_vector(target_from_cam.rotation[:, 2])

    def sample(self, point: Any, disc: Any, choice: Any) -> tuple[Any, Any, Any]:
        """Return (unit direction to the LED, distance, irradiance facing it)."""
        led = mi.UInt32(dr.minimum(choice * self.count, self.count - 1.0))
        place = dr.gather(mi.Point3f, self.points, led)
        towards = place - point
        squared = dr.squared_norm(towards)
        distance = dr.sqrt(squared)
        towards = towards / distance
        cosine = dr.maximum(-dr.dot(towards, self.axis), 0.0)
        beam = dr.power(cosine, self.exponent)
        return towards, distance, self.intensity * beam / squared


def _opaque_vector(components: Sequence[float] | Floats) -> Any:
    return mi.Vector3f(*(dr.opaque(mi.Float, float(x)) for x in components))


def light_of(
    group: LightGroup, cam_from_target: RigidTransform
) -> SunLight | EarthLight | LampLight:
    """Return the kernel's view of a group."""
    if isinstance(group, SunGroup):
        return SunLight(group)
    if isinstance(group, EarthGroup):
        return EarthLight(group)
    return LampLight(group, cam_from_target)


def power_share(one: Any, other: Any) -> Any:
    """Return the power heuristic's weight of ``one`` density beside ``other``, exponent two."""
    ratio = other / one
    return 1.0 / (1.0 + ratio * ratio)


@dr.syntax(recursive=False)  # type: ignore[untyped-decorator]
def _trace(
    scene: Any,
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
    context = mi.BSDFContext()
    sums = [dr.zeros(mi.Float, dr.width(pixels)) for _ in lights]
    column = mi.Float(pixels % width)
    row = mi.Float(pixels // width)
    index = mi.UInt32(first)
    while index < last:
        place = points_2d(index, key, mi.UInt32(0))
        ray = ray_of(column + place.x - 0.5, row + place.y - 0.5)
        throughput = mi.Color3f(1.0)
        depth = mi.UInt32(0)
        active = mi.Bool(True)
        lobe_density = mi.Float(dr.inf)  # of the ray's direction; the camera's rays are certain
        while active:
            si = scene.ray_intersect(ray, mi.RayFlags.All, depth == 0, active)
            escaped = active & ~si.is_valid()
            active &= si.is_valid() & (depth < max_depth)
            bsdf = si.bsdf(ray)
            pair = 1 + depth * PAIRS_PER_VERTEX
            disc = mi.warp.square_to_uniform_disk_concentric(points_2d(index, key, pair))
            choice = points_2d(index, key, pair + 1)
            for number, light in enumerate(lights):
                if dr.hint(light.wide, mode="scalar"):
                    arrived = throughput[light.channel] * light.radiance(ray.d)
                    arrived *= power_share(lobe_density, light.density)
                    sums[number] += dr.select(escaped, arrived, 0.0)
                towards, distance, irradiance = light.sample(si.p, disc, choice.x)
                wo = si.to_local(towards)
                facing = active & (dr.dot(towards, si.n) * si.wi.z > 0.0) & (irradiance > 0.0)
                value = bsdf.eval(context, si, wo, facing)
                share = value[light.channel] * throughput[light.channel] * irradiance
                if dr.hint(light.wide, mode="scalar"):
                    density = bsdf.pdf(context, si, wo, facing)
                    share *= power_share(light.density, density)
                facing &= share > 0.0
                shadow = si.spawn_ray(towards)
                shadow.maxt = distance * (1.0 - 1e-4)
                dark = scene.ray_test(shadow, depth == 0, facing)
                sums[number] += dr.select(facing & ~dark, share, 0.0)
            depth += 1
            active &= depth < segments
            lobe = points_2d(index, key, pair + 2)
            bsdf_sample, weight = bsdf.sample(context, si, choice.y, lobe, active)
            throughput *= weight
            lobe_density = bsdf_sample.pdf
            active &= dr.any(throughput > 0.0)
            ray = si.spawn_ray(si.to_world(bsdf_sample.wo))
        index += 1
    return [total / mi.Float(last - first) for total in sums]


def pixel_keys(seed: int, pixels: Any) -> Any:
    """Return a random key for each pixel; the seed is opaque: a literal would compile anew."""
    return mi.sample_tea_32(pixels, dr.opaque(mi.UInt32, seed))[0]


def lanes_per_pixel(samples: int) -> int:
    """Return into how many lanes, a power of two, the samples of a pixel are shared evenly."""
    shares = 1
    while samples % (2 * shares) == 0 and samples // (2 * shares) >= LANE_SAMPLES:
        shares *= 2
    return shares


def trace_groups(
    scene: Any,
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
        Geometry in the target frame; its emitters are not used.
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
    shares = lanes_per_pixel(samples)
    each = samples // shares
    pixel_of_lane = np.repeat(np.asarray(pixels, dtype=np.uint32), shares)
    share_of_lane = np.tile(np.arange(shares, dtype=np.uint32), len(pixels))
    lanes = mi.UInt32(pixel_of_lane)
    first = mi.UInt32(share_of_lane * each)
    sums = _trace(
        scene,
        ray_of,
        lights,
        lanes,
        first,
        first + dr.opaque(mi.UInt32, each),
        mi.UInt32(camera.width),
        dr.opaque(mi.UInt32, max_depth),
        dr.opaque(mi.UInt32, segments),
        pixel_keys(seed, lanes),
    )
    dr.eval(sums)
    return {
        group.name: np.array(total).reshape(len(pixels), shares).mean(axis=1, dtype=np.float32)
        for group, total in zip(groups, sums, strict=True)
    }
