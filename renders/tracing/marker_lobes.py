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
from renders.tracing.corner_cube import CubeView, aperture_share
from renders.tracing.detail_passes import LEAST_FACING
from renders.tracing.light_groups import LampGroup
from renders.tracing.retroreflector import active_aperture
from renders.tracing.scene import SceneGeometry, disc_place, marker_transform, place_chaser
from renders.tracing.windows import Window, render_windows

LIFT_M = 1e-4  # a shadow ray starts this far in front of its disc
PLACES = 8  # along each side of a pixel, for what it sees of a cube
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
        number, point = _met_disc(discs, lens, ray)
        normal = discs.normals_in_target[number]
        radiance = lobe_radiance(scene, point, normal, lens, axis, lamps, leds, geometry.optics)
        if radiance > 0.0:
            within = target_from_cam.rotate(camera.rays(_within_pixel(int(column), int(row))))
            radiance *= _seen_share(discs, number, lens, within, leds, geometry.optics, camera)
        image[row, column] += covered[row, column] * radiance


def _met_disc(discs: MarkerPattern, lens: Floats, ray: Floats) -> tuple[int, Floats]:
    """Return which disc is nearest to a ray, and where it is met, or the rim's nearest point."""
    to_centres = discs.points_in_target - lens
    unit = ray / np.linalg.norm(ray)
    passing = np.linalg.norm(np.cross(to_centres, unit), axis=1)
    number = int(np.argmin(passing))
    centre, normal = discs.points_in_target[number], discs.normals_in_target[number]
    met = lens + ray * ((to_centres[number] @ normal) / (ray @ normal))
    off_centre = met - centre
    stretch = max(1.0, float(np.linalg.norm(off_centre)) / discs.radius_m)
    return number, centre + off_centre / stretch


def _within_pixel(column: int, row: int) -> Floats:
    """Return places spread over a pixel, (n, 2) px."""
    offsets = (np.arange(PLACES) + 0.5) / PLACES - 0.5
    u, v = np.meshgrid(column + offsets, row + offsets)
    return np.stack([u.ravel(), v.ravel()], axis=1)


def _seen_share(
    discs: MarkerPattern,
    number: int,
    lens: Floats,
    rays: Floats,
    leds: Floats,
    optics: RetroreflectorOptics,
    camera: Camera,
) -> float:
    """Return what a pixel sees of a cube's aperture, over what an effective disc would show."""
    centre, normal = discs.points_in_target[number], discs.normals_in_target[number]
    place = disc_place(centre, normal, discs.radius_m)
    met = lens + rays * (((centre - lens) @ normal) / (rays @ normal))[:, None]
    off = (met - centre) / discs.radius_m
    x, y = off @ np.array(place.along), off @ np.array(place.across)
    on_disc = x * x + y * y < 1.0
    if not on_disc.any():
        return 1.0
    x, y = x[on_disc], y[on_disc]
    to_lens = lens - met[on_disc]
    distance = np.linalg.norm(to_lens, axis=1)
    viewer = to_lens / distance[:, None]
    width = distance / max(camera.fx, camera.fy)
    pixel = width / np.sqrt(np.maximum(viewer @ normal, LEAST_FACING)) / discs.radius_m
    shares = []
    for led in leds:
        half = viewer + (led - centre) / np.linalg.norm(led - centre)
        half /= np.linalg.norm(half, axis=1)[:, None]
        effective = np.array(
            [float(active_aperture(float(c), optics.refractive_index)) for c in half @ normal]
        )
        share = aperture_share(
            np,
            CubeView(x, y, pixel, discs.radius_m / distance),
            half @ np.array(place.along),
            half @ np.array(place.across),
            optics.refractive_index,
            effective,
        )
        shares.append(share.mean() / max(float(effective.mean()), 1e-9))
    return float(np.mean(shares))
