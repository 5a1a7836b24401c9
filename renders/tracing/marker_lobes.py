"""What the retroreflectors return, where there is no JIT: a coverage times a closed form.

In ``scalar_rgb`` a BSDF in Python would be called a thousand times a pixel, so there the discs
carry their front face alone and the return lobe is added here. It sends light back within a few
degrees of where it came from, so it shows only light that goes from lamp to disc to lens: a closed
form, smooth over the disc. What needs samples is how much of a pixel a disc covers, and Mitsuba
counts that with the discs as emitters of unit radiance.
"""

from __future__ import annotations

from typing import Any

import mitsuba as mi
import numpy as np

from models.arrays import Floats, Radiance
from models.camera import Camera
from models.markers import MarkerPattern
from models.pose import RigidTransform
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from renders.tracing.light_groups import LampGroup
from renders.tracing.retroreflector import active_aperture
from renders.tracing.scene import SceneGeometry, marker_transform, place_chaser
from renders.tracing.windows import Window, render_windows

LIFT_M = 1e-4  # a shadow ray starts this far in front of its disc
SHORT = 1.0 - 1e-4  # and ends this share of its way before the lamp


def coverage_scene(geometry: SceneGeometry, cam_from_target: RigidTransform) -> Any:
    """Return the scene with discs that shine with unit radiance and nothing else that shines."""
    white = {"type": "area", "radiance": {"type": "rgb", "value": 1.0}}
    glowing = {}
    if geometry.discs is not None:
        for key, point, normal in zip(
            geometry.disc_keys,
            geometry.discs.points_in_target,
            geometry.discs.normals_in_target,
            strict=True,
        ):
            matrix = marker_transform(point, normal, geometry.discs.radius_m)
            to_world = mi.ScalarTransform4f(matrix)
            glowing[key] = {"type": "disk", "to_world": to_world, "emitter": white}
    scene = mi.load_dict({"type": "scene", **geometry.shapes, **glowing}, optimize=False)
    place_chaser(scene, geometry, cam_from_target)
    return scene


def lobe_radiance(
    scene: Any,
    point: Floats,
    normal: Floats,
    lens: Floats,
    axis: Floats,
    lamps: LampGroup,
    leds: Floats,
    optics: RetroreflectorOptics,
) -> float:
    """Return the radiance that the lobe at ``point`` sends to the lens, W m-2 sr-1.

    Parameters
    ----------
    scene : mitsuba.Scene
        What may shadow the point (scalar variants).
    point, normal, lens, axis : (3,) arrays, target frame
        Axis is the lamps' direction.
    lamps : LampGroup
    leds : (count, 3) array, m, target frame
    optics : RetroreflectorOptics
    """
    to_lens = (lens - point) / np.linalg.norm(lens - point)
    if to_lens @ normal <= 0.0:
        return 0.0
    psi = np.deg2rad(optics.half_angle_deg)
    start = mi.ScalarPoint3f(*(point + LIFT_M * normal))
    total = 0.0
    for led in leds:
        distance = float(np.linalg.norm(led - point))
        to_led = (led - point) / distance
        facing = float(to_led @ normal)
        if facing <= 0.0 or to_led @ to_lens < np.cos(psi):
            continue
        ray = mi.Ray3f(start, mi.ScalarVector3f(*to_led))
        ray.maxt = distance * SHORT
        if scene.ray_test(ray):
            continue
        half = (to_led + to_lens) / np.linalg.norm(to_led + to_lens)
        aperture = active_aperture(float(half @ normal), optics.refractive_index)
        beam = float(lamps.ring.relative_intensity(-to_led @ axis))
        total += aperture * facing * beam / distance**2
    rho = optics.returned.bands[lamps.channel]
    strength = rho * lamps.ring.intensity_w_sr / lamps.ring.count / (np.pi * np.sin(psi) ** 2)
    return float(total * strength)


def add_lobes(
    image: Radiance,
    geometry: SceneGeometry,
    camera: Camera,
    cam_from_target: RigidTransform,
    lamps: LampGroup,
    windows: list[Window],
    samples: int,
    seed: int,
) -> None:
    """Add to ``image`` what the discs in ``windows`` return of one group of lamps.

    Parameters
    ----------
    image : (height, width) array, W m-2 sr-1
        Changed in place.
    geometry : SceneGeometry
    camera : Camera
    cam_from_target : RigidTransform
    lamps : LampGroup
    windows : list of Window
        One for each disc that may be seen.
    samples : int
        Per pixel, for the share of it that a disc covers.
    seed : int
    """
    discs = geometry.discs
    if discs is None or not windows or geometry.optics.returned.bands[lamps.channel] == 0.0:
        return
    scene = coverage_scene(geometry, cam_from_target)
    covered = np.zeros(image.shape)
    patches = render_windows(scene, camera, cam_from_target, windows, samples, 1, seed)
    for (left, top, width, height), patch in zip(windows, patches, strict=True):
        covered[top : top + height, left : left + width] = patch[..., lamps.channel]
    target_from_cam = cam_from_target.inverse()
    lens, axis = target_from_cam.translation, target_from_cam.rotation[:, 2]
    leds = lamps.points_in_target(cam_from_target)
    rows, columns = np.nonzero(covered)
    pixels = np.stack([columns, rows], axis=1).astype(np.float64)
    rays = target_from_cam.rotate(camera.rays(pixels))
    for row, column, ray in zip(rows, columns, rays, strict=True):
        point, normal = _met_disc(discs, lens, ray)
        radiance = lobe_radiance(scene, point, normal, lens, axis, lamps, leds, geometry.optics)
        image[row, column] += covered[row, column] * radiance


def _met_disc(discs: MarkerPattern, lens: Floats, ray: Floats) -> tuple[Floats, Floats]:
    """Return where a ray meets the nearest disc, or the rim's nearest point if it passes by."""
    to_centres = discs.points_in_target - lens
    unit = ray / np.linalg.norm(ray)
    passing = np.linalg.norm(np.cross(to_centres, unit), axis=1)
    number = int(np.argmin(passing))
    centre, normal = discs.points_in_target[number], discs.normals_in_target[number]
    met = lens + ray * ((to_centres[number] @ normal) / (ray @ normal))
    off_centre = met - centre
    stretch = max(1.0, float(np.linalg.norm(off_centre)) / discs.radius_m)
    return centre + off_centre / stretch, normal
