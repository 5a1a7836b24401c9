"""Ground truth from the same rays: part labels, depth, normals, and what each marker gets of light.

Labels, depth and normals are taken at pixel centres, one ray each, through the same camera as the
frames. Depth is Z along the boresight, not the length of the ray.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from models.arrays import Floats, Labels, Mask, Radiance
from models.camera import Camera
from models.lights.led_beam import LedRing
from models.markers import MarkerPattern
from models.pose import RigidTransform
from renders.tracing.camera_plugin import sensor_dict
from renders.tracing.scene import SceneGeometry
from renders.tracing.windows import coarse_window_around

DISC_POINTS = 127  # spread over a marker's face; one of them is under 1 % of it
CLEARANCE_M = 1e-3  # rays start this far above the face


@dataclass(frozen=True, eq=False)
class PixelTruth:
    """What each pixel's central ray meets.

    Attributes
    ----------
    labels : (height, width) uint8 array
        0 is space; label k + 1 is ``SceneGeometry.labels[k]``.
    depth_m : (height, width) float32 array, m
        Z in the camera's axes; 0 in space.
    normals_in_target : (height, width, 3) float32 array
        Unit geometric normals; 0 in space.
    """

    labels: Labels
    depth_m: Radiance
    normals_in_target: Radiance


def pixel_truth(
    scene: Any,
    geometry: SceneGeometry,
    camera: Camera,
    cam_from_target: RigidTransform,
    in_view: Mask | None = None,
) -> PixelTruth:
    """Trace one ray through the centre of each pixel, or of each that can show anything.

    Parameters
    ----------
    scene : mitsuba.Scene
        ``geometry`` loaded, with the chaser in its place.
    geometry : SceneGeometry
    camera : Camera
    cam_from_target : RigidTransform
    in_view : (height, width) array of bool, optional
        Pixels that can show anything; rays beyond the window around them are saved.
    """
    left, top, width, height = coarse_window_around(in_view, camera)
    film = {
        "type": "hdrfilm",
        "width": camera.width,
        "height": camera.height,
        "crop_offset_x": left,
        "crop_offset_y": top,
        "crop_width": width,
        "crop_height": height,
        "rfilter": {"type": "box"},
        "pixel_format": "luminance",
        "component_format": "float32",
    }
    sampler = {"type": "stratified", "sample_count": 1, "jitter": False}
    sensor = mi.load_dict(sensor_dict(camera, cam_from_target, film) | {"sampler": sampler})
    aov = mi.load_dict({"type": "aov", "aovs": "part:shape_index,at:position,facing:geo_normal"})
    channels = np.array(mi.render(scene, sensor=sensor, integrator=aov, spp=1))
    shape, position, normal = channels[..., -7], channels[..., -6:-3], channels[..., -3:]
    numbers = geometry.shape_labels(scene)
    lookup = np.zeros(max(numbers) + 1, dtype=np.uint8)
    lookup[list(numbers)] = list(numbers.values())
    labels = lookup[np.rint(shape).astype(np.int64)]
    boresight = cam_from_target.rotation[2].astype(np.float32)
    along = position @ boresight + np.float32(cam_from_target.translation[2])
    depth = np.where(labels > 0, along, 0.0)
    normals = np.where(labels[..., None] > 0, normal, 0.0).astype(np.float32)
    beside = ((top, camera.height - top - height), (left, camera.width - left - width))
    return PixelTruth(
        labels=np.pad(labels, beside),
        depth_m=np.pad(depth.astype(np.float32), beside),
        normals_in_target=np.pad(normals, (*beside, (0, 0))),
    )


def disc_points(markers: MarkerPattern) -> Floats:
    """Return points spread evenly over each marker's face, (n, DISC_POINTS, 3), m."""
    number = np.arange(DISC_POINTS)
    radius = markers.radius_m * np.sqrt((number + 0.5) / DISC_POINTS)
    angle = number * np.pi * (3.0 - np.sqrt(5.0))
    faces = []
    for point, normal in zip(markers.points_in_target, markers.normals_in_target, strict=True):
        helper = np.eye(3)[int(np.argmin(np.abs(normal)))]
        first = np.cross(normal, helper)
        first /= np.linalg.norm(first)
        second = np.cross(normal, first)
        faces.append(
            point
            + CLEARANCE_M * normal
            + (radius * np.cos(angle))[:, None] * first
            + (radius * np.sin(angle))[:, None] * second
        )
    return np.array(faces)


def unoccluded(scene: Any, origins: Floats, towards: Floats) -> Mask:
    """Tell which segments meet nothing.

    Parameters
    ----------
    scene : mitsuba.Scene
    origins, towards : (n, 3) arrays, m
        Where they begin and end, target frame.

    Returns
    -------
    (n,) array of bool
    """
    ways = towards - origins
    lengths = np.linalg.norm(ways, axis=1)
    ways = ways / lengths[:, None]
    if dr.is_jit_v(mi.Float):
        ray = mi.Ray3f(mi.Point3f(origins.T), mi.Vector3f(ways.T))
        ray.maxt = mi.Float(lengths * (1.0 - 1e-5))
        return ~np.array(scene.ray_test(ray), dtype=bool)
    clear = np.empty(len(origins), dtype=bool)
    for row, (origin, way, length) in enumerate(zip(origins, ways, lengths, strict=True)):
        ray = mi.Ray3f(mi.Point3f(*origin.tolist()), mi.Vector3f(*way.tolist()))
        ray.maxt = float(length * (1.0 - 1e-5))
        clear[row] = not scene.ray_test(ray)
    return clear


@dataclass(frozen=True, eq=False)
class MarkerLight:
    """Shares of each marker's face, (n,) arrays from 0 to 1; see ``ExposureTruth``."""

    visible: Floats
    lamp_lit: Floats
    sun_lit: dict[str, Floats]


def marker_light(
    scene: Any,
    markers: MarkerPattern,
    camera: Camera,
    cam_from_target: RigidTransform,
    lamps: LedRing | None,
    suns: dict[str, tuple[float, float, float]],
) -> MarkerLight:
    """Find how much of each marker the lens sees, the lamps reach and each Sun lights.

    Parameters
    ----------
    scene : mitsuba.Scene
    markers : MarkerPattern
    camera : Camera
    cam_from_target : RigidTransform
    lamps : LedRing or None
        None where there are none: nothing is lit by them.
    suns : dict of str to tuple of 3 floats
        Unit vectors towards them, target frame, by name.
    """
    points = disc_points(markers)
    count = len(markers)
    flat = points.reshape(-1, 3)
    normals = np.repeat(markers.normals_in_target, DISC_POINTS, axis=0)
    target_from_cam = cam_from_target.inverse()

    def share(ends: Floats) -> Floats:
        facing = ((ends - flat) * normals).sum(axis=1) > 0.0
        clear = facing & unoccluded(scene, flat, ends)
        return np.asarray(clear.reshape(count, DISC_POINTS).mean(axis=1))

    def seen() -> Floats:
        lens = np.broadcast_to(target_from_cam.translation, flat.shape)
        in_image = camera.contains(camera.project(cam_from_target @ flat))
        facing = ((lens - flat) * normals).sum(axis=1) > 0.0
        clear = in_image & facing & unoccluded(scene, flat, lens)
        return np.asarray(clear.reshape(count, DISC_POINTS).mean(axis=1))

    lamp_lit = np.zeros(count)
    if lamps is not None:
        leds = target_from_cam @ lamps.points_in_cam
        lamp_lit = np.mean([share(np.broadcast_to(led, flat.shape)) for led in leds], axis=0)
    far = 1e3  # m; beyond anything in the scene
    sun_lit = {name: share(flat + far * np.asarray(towards)) for name, towards in suns.items()}
    return MarkerLight(visible=seen(), lamp_lit=lamp_lit, sun_lit=sun_lit)


def outline_centres_px(
    markers: MarkerPattern, camera: Camera, cam_from_target: RigidTransform
) -> Floats:
    """Return the centre of area of each marker's projected outline.

    The outline is projected as a polygon of 256 corners, through distortion and all; its centroid
    is that of the shoelace formula.

    Parameters
    ----------
    markers : MarkerPattern
        Of n markers.
    camera : Camera
    cam_from_target : RigidTransform

    Returns
    -------
    (n, 2) array, px
        NaN where any of it is not in front of the camera or lies beyond the lens's fold.
    """
    angle = 2.0 * np.pi * np.arange(256) / 256
    centres = []
    for point, normal in zip(markers.points_in_target, markers.normals_in_target, strict=True):
        helper = np.eye(3)[int(np.argmin(np.abs(normal)))]
        first = np.cross(normal, helper)
        first /= np.linalg.norm(first)
        second = np.cross(normal, first)
        ring = point + markers.radius_m * (
            np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second
        )
        u, v = camera.project(cam_from_target @ ring).T
        u0, v0 = u.mean(), v.mean()
        u, v = u - u0, v - v0
        cross = u * np.roll(v, -1) - np.roll(u, -1) * v
        area = cross.sum() / 2.0
        centres.append(
            [
                u0 + ((u + np.roll(u, -1)) * cross).sum() / (6.0 * area),
                v0 + ((v + np.roll(v, -1)) * cross).sum() / (6.0 * area),
            ]
        )
    return np.array(centres)
