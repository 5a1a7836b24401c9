"""The same light groups where there is no JIT: one render per group with Mitsuba's own emitters.

In ``scalar_rgb`` a Python integrator would be a thousand times too slow, so each group becomes
emitters that Mitsuba has: the Sun is a directional light that walks over its disc from pass to
pass, an LED is a spot light whose beam is a projected bitmap of ``cos^n``, and the Earth is an
environment map.
"""

from __future__ import annotations

from typing import Any

import mitsuba as mi
import numpy as np

from models.arrays import Floats, Radiance
from models.camera import Camera
from models.pose import RigidTransform
from renders.tracing.light_groups import EarthGroup, LampGroup, LightGroup, SunGroup
from renders.tracing.scene import SceneGeometry, place_chaser
from renders.tracing.windows import Window, render_windows

BEAM_CUTOFF_DEG = 60.0  # cos^7 has fallen to 1 % there, far outside the field of view
BEAM_BITMAP = 512
EARTH_ROWS = 1024  # of the map; the disc at GEO is a hundred columns wide
TEXEL_SAMPLES = 8  # along each side of a texel of that map
SUN_PASSES = 16  # places on the Sun's disc; with 4 the mean is 0.4 % off, with 16 none is seen


def sun_disc_directions(group: SunGroup, count: int) -> Floats:
    """Return ``count`` unit directions spread evenly over the Sun's disc (Vogel's spiral).

    Returns
    -------
    (count, 3) array
        Target frame.
    """
    towards = np.asarray(group.direction_in_target)
    helper = np.eye(3)[int(np.argmin(np.abs(towards)))]
    first = np.cross(towards, helper)
    first /= np.linalg.norm(first)
    second = np.cross(towards, first)
    number = np.arange(count)
    radius = group.sine_of_radius * np.sqrt((number + 0.5) / count)
    angle = number * np.pi * (3.0 - np.sqrt(5.0))
    directions = (
        towards
        + (radius * np.cos(angle))[:, None] * first
        + (radius * np.sin(angle))[:, None] * second
    )
    return np.asarray(directions / np.linalg.norm(directions, axis=1, keepdims=True))


def _band(channel: int, value: float) -> dict[str, Any]:
    bands = [0.0, 0.0, 0.0]
    bands[channel] = value
    return {"type": "rgb", "value": bands}


def _sun_transform(direction: Floats) -> Any:
    """Return ``to_world`` of a directional emitter that shines from ``direction``."""
    up = np.eye(3)[int(np.argmin(np.abs(direction)))]
    return mi.ScalarTransform4f().look_at(
        origin=[0.0, 0.0, 0.0], target=(-direction).tolist(), up=up.tolist()
    )


def _sun_emitter(group: SunGroup) -> dict[str, Any]:
    return {
        "type": "directional",
        "to_world": _sun_transform(np.asarray(group.direction_in_target)),
        "irradiance": _band(group.channel, group.irradiance_w_m2),
    }


def _beam_bitmap(exponent: float) -> Any:
    """Bitmap of ``cos^n`` as the spot light projects it: over the tangent plane, out to cutoff."""
    half = np.tan(np.deg2rad(BEAM_CUTOFF_DEG))
    steps = (np.arange(BEAM_BITMAP) + 0.5) / BEAM_BITMAP * 2.0 - 1.0
    x, y = np.meshgrid(steps * half, steps * half)
    cosine = 1.0 / np.sqrt(1.0 + x**2 + y**2)
    return mi.Bitmap((cosine**exponent)[..., None].astype(np.float32))


def _lamp_emitters(group: LampGroup, cam_from_target: RigidTransform) -> dict[str, Any]:
    target_from_cam = cam_from_target.inverse()
    axis, up = target_from_cam.rotation[:, 2], -target_from_cam.rotation[:, 1]
    texture = {
        "type": "bitmap",
        "bitmap": _beam_bitmap(group.ring.exponent),
        "raw": True,
        "wrap_mode": "clamp",
    }
    intensity = _band(group.channel, group.ring.intensity_w_sr / group.ring.count)
    return {
        f"{group.name}_{number}": {
            "type": "spot",
            "to_world": mi.ScalarTransform4f().look_at(
                origin=place.tolist(), target=(place + axis).tolist(), up=up.tolist()
            ),
            "intensity": intensity,
            "texture": texture,
            "cutoff_angle": BEAM_CUTOFF_DEG,
            "beam_width": BEAM_CUTOFF_DEG - 1e-3,
        }
        for number, place in enumerate(group.points_in_target(cam_from_target))
    }


def _earth_emitter(group: EarthGroup) -> dict[str, Any]:
    """Environment map with the Earth on its horizon, at its middle column.

    Each texel is the mean of what it covers, so that the limb keeps its place.
    """
    towards = np.asarray(group.earth.direction_in_target)
    up = np.eye(3)[int(np.argmin(np.abs(towards)))]
    to_world = np.eye(4)
    to_world[:3, 0] = np.cross(up, towards) / np.linalg.norm(np.cross(up, towards))
    to_world[:3, 1] = np.cross(towards, to_world[:3, 0])
    to_world[:3, 2] = towards
    row, column = np.mgrid[0:EARTH_ROWS, 0 : 2 * EARTH_ROWS].astype(np.float64)
    texel = np.pi / EARTH_ROWS
    edge = np.arcsin(group.earth.sine_of_radius) + 2.0 * texel
    near = _map_directions(row, column)[..., 2] > np.cos(edge)
    pixels = np.zeros((EARTH_ROWS, 2 * EARTH_ROWS, 3), dtype=np.float32)
    offsets = (np.arange(TEXEL_SAMPLES) + 0.5) / TEXEL_SAMPLES - 0.5
    for down in offsets:
        for right in offsets:
            local = _map_directions(row[near] + down, column[near] + right)
            light = group.earth.radiance(local @ to_world[:3, :3].T)
            pixels[near, group.channel] += light / TEXEL_SAMPLES**2
    return {
        "type": "envmap",
        "bitmap": mi.Bitmap(pixels),
        "to_world": mi.ScalarTransform4f(to_world),
    }


def _map_directions(row: Floats, column: Floats) -> Floats:
    """Return the unit directions of places on an environment map, in the map's own axes.

    Mitsuba's map has row j at polar angle pi j / (rows - 1) from +y, and column i at azimuth
    2 pi (i + 1/2) / columns, from -z towards +x (measured: 3.9 shifts columns and not rows).
    """
    polar = np.pi * row / (EARTH_ROWS - 1)
    azimuth = np.pi * (column + 0.5) / EARTH_ROWS
    sine = np.sin(polar)
    return np.stack([np.sin(azimuth) * sine, np.cos(polar), -np.cos(azimuth) * sine], axis=-1)


def group_scene(geometry: SceneGeometry, group: LightGroup, cam_from_target: RigidTransform) -> Any:
    """Load the scene with the emitters of one group, the chaser in its place.

    Parameters
    ----------
    geometry : SceneGeometry
    group : LightGroup
    cam_from_target : RigidTransform
    """
    if isinstance(group, SunGroup):
        scene = geometry.scene(sun=_sun_emitter(group))
    elif isinstance(group, EarthGroup):
        scene = geometry.scene(earth=_earth_emitter(group))
    else:
        scene = geometry.scene(**_lamp_emitters(group, cam_from_target))
    place_chaser(scene, geometry, cam_from_target)
    return scene


def turn_sun(scene: Any, direction: Floats) -> None:
    """Let a scene's Sun shine from another place of its disc.

    Parameters
    ----------
    scene : mitsuba.Scene
        Of ``group_scene``.
    direction : (3,) array
        Unit vector to that place.
    """
    params = mi.traverse(scene)
    params["sun.to_world"] = _sun_transform(direction)
    params.update()


def render_group(
    geometry: SceneGeometry,
    camera: Camera,
    cam_from_target: RigidTransform,
    group: LightGroup,
    windows: list[Window],
    samples: int,
    max_depth: int,
    seed: int,
) -> list[Radiance]:
    """Render one group in some windows of the image.

    Parameters
    ----------
    geometry : SceneGeometry
    camera : Camera
    cam_from_target : RigidTransform
    group : LightGroup
    windows : list of (left, top, width, height), px
    samples : int
        Per pixel, shared out between the places on the Sun's disc.
    max_depth : int
        Surfaces that a path may meet; 1 is direct light.
    seed : int

    Returns
    -------
    list of (height, width) float32 arrays, W m-2 sr-1, one for each window.
    """
    if not windows:
        return []
    directions: list[Floats | None] = [None]
    if isinstance(group, SunGroup):
        directions = list(sun_disc_directions(group, min(SUN_PASSES, samples)))
    scene = group_scene(geometry, group, cam_from_target)
    images = [np.zeros((window[3], window[2])) for window in windows]
    each = max(1, round(samples / len(directions)))
    for number, direction in enumerate(directions):
        if direction is not None:
            turn_sun(scene, direction)
        turn = (seed + number) % 2**32
        rendered = render_windows(
            scene, camera, cam_from_target, windows, each, max_depth + 1, turn
        )
        for image, window in zip(images, rendered, strict=True):
            image += window[..., group.channel] / len(directions)
    return [image.astype(np.float32) for image in images]
