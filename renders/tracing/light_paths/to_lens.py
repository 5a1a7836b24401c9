"""The image that landed light makes: each landing is connected to the lens, if nothing hides it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from models.arrays import Radiance
from models.camera import Camera
from models.pose import RigidTransform
from renders.tracing.light_paths.landed import Landed
from renders.tracing.light_paths.packed_direction import unpacked
from renders.tracing.light_paths.pixel_solid_angle import projected_place, solid_angle
from renders.tracing.light_paths.weights import lens_end, projected, share_from_sun
from renders.tracing.surface_table import SurfaceTable

SAME_PLACE_M = 1e-5  # a landing's place is known to some 1e-6 of its distance from the origin
NOWHERE = 0xFFFFFFFF


@dataclass(frozen=True, eq=False)
class Landings:
    """Landed light on the device.

    Attributes
    ----------
    place : Point3f, m
    direction : UInt32
    power, ratio : Float
    """

    place: Any
    direction: Any
    power: Any
    ratio: Any

    @classmethod
    def load(cls, landed: Landed) -> Landings:
        """Put landings on the device."""
        made = cls(
            mi.Point3f(np.ascontiguousarray(landed.places.T)),
            mi.UInt32(landed.direction),
            mi.Float(landed.power_w),
            mi.Float(landed.ratio),
        )
        dr.make_opaque(made.place, made.direction, made.power, made.ratio)
        return made


def image_of(
    landings: Landings,
    scene: Any,
    surfaces: SurfaceTable,
    camera: Camera,
    cam_from_target: RigidTransform,
    band: int,
) -> Radiance:
    """Return what a lens sees of landed light.

    Parameters
    ----------
    landings : Landings
    scene : mitsuba.Scene
    surfaces : SurfaceTable
    camera : Camera
    cam_from_target : RigidTransform
    band : int

    Returns
    -------
    (height * width,) float32 array, W m-2 sr-1
    """
    size = camera.width * camera.height
    if dr.width(landings.power) == 0:
        return np.zeros(size, dtype=np.float32)
    rows = [
        mi.Vector3f(*(dr.opaque(mi.Float, float(x)) for x in row))
        for row in cam_from_target.rotation
    ]
    shift = [dr.opaque(mi.Float, float(x)) for x in cam_from_target.translation]
    lens = mi.Point3f(
        *(dr.opaque(mi.Float, float(x)) for x in cam_from_target.inverse().translation)
    )
    x, y, z = (dr.dot(row, landings.place) + t for row, t in zip(rows, shift, strict=True))
    in_front = z > 1e-6
    a, b = x / z, y / z
    if camera.distorted and np.isfinite(camera.fold_radius):
        in_front &= a * a + b * b < float(camera.fold_radius) ** 2
    u, v = projected_place(camera, a, b)
    column, row_of = dr.round(u), dr.round(v)
    seen = in_front & (column >= 0.0) & (column < float(camera.width))
    seen &= (row_of >= 0.0) & (row_of < float(camera.height))
    offset = landings.place - lens
    distance = dr.norm(offset)
    ray = mi.Ray3f(lens, offset / distance)
    si = scene.ray_intersect(ray, mi.RayFlags.ShadingFrame, False, seen)
    seen &= si.is_valid()
    seen &= dr.abs(si.t - distance) < SAME_PLACE_M * (
        1.0 + distance + dr.max(dr.abs(landings.place))
    )
    pixel_rad = dr.opaque(mi.Float, 1.0 / max(camera.fx, camera.fy))
    surface = surfaces.seen(si, ray, [band], seen, pixel_rad)
    towards = unpacked(landings.direction)
    seen &= surface.faces(towards)
    back = dr.dot(surface.normal, -ray.d)
    pixel_sr = solid_angle(camera, a, b)
    ratio = landings.ratio / projected(surface.density(towards), surface.normal, towards)
    ratio *= lens_end(surface.normal, -ray.d, distance, pixel_sr)
    sent = landings.power * surface.value(band, towards) / dr.dot(surface.normal, towards)
    sent *= back / (distance * distance * pixel_sr) * share_from_sun(ratio)
    pixel = mi.UInt32(row_of) * camera.width + mi.UInt32(column)
    pixel = dr.select(seen, pixel, NOWHERE)
    dr.eval(pixel, sent)
    number, light = np.array(pixel), np.array(sent, dtype=np.float64)
    there = number != NOWHERE
    return np.bincount(number[there], light[there], size).astype(np.float32)
