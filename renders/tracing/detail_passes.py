"""The fine detail of surfaces where there is no JIT: direct light, place by place, is corrected.

Mitsuba's own BSDFs, which scalar variants have, know no detail. So a few passes of one sample a
pixel tell where rays land and what direct light they bring; that light, times how much the surface
there gives more than its mean, is added to the image. Light that bounced, or came from the Earth,
sees the mean, as its directions are many: creases average out over them.
"""

from __future__ import annotations

import numpy as np

from models.arrays import AnyArray, Floats, Radiance
from models.camera import Camera
from models.pose import RigidTransform
from renders.tracing.emitter_by_emitter import group_scene, sun_disc_directions, turn_sun
from renders.tracing.fine_detail import WIDEST_M, shade
from renders.tracing.foil_creases import crease_slopes, lobe_factor
from renders.tracing.light_groups import EarthGroup, LampGroup, LightGroup, SunGroup
from renders.tracing.scene import SceneGeometry
from renders.tracing.surfaces import Surface
from renders.tracing.windows import Window, render_windows

PASSES = 16
AOVS = "place:position,flat:geo_normal,smooth:sh_normal,shape:shape_index"
LEAST_FACING = 0.05  # as ``renders.tracing.surface_table`` has it


def mirror_share(
    surface: Surface, band: int, normal: Floats, viewer: Floats, light: Floats
) -> Floats:
    """Return how much of the light that a surface sends on its mirror lobe has, (n,).

    Parameters
    ----------
    surface : Surface
    band : int
    normal, viewer, light : (3, n) arrays
        Unit vectors; the lobe is that of ``renders.tracing.surface_table``.
    """
    width = surface.roughness**2
    seen, lit = ((normal * each).sum(axis=0) for each in (viewer, light))
    half_squared = ((viewer + light) ** 2).sum(axis=0)

    def slant(cosine: Floats) -> Floats:
        return np.asarray(np.sqrt(cosine**2 + width * (1.0 - cosine**2)))

    spread = 1.0 + (seen + lit) ** 2 / half_squared * (width - 1.0)
    lobe = surface.mirror[band] * width * lit
    lobe = lobe / (np.pi * (seen + slant(seen)) * spread**2 * (lit + slant(lit)))
    if surface.indices is not None:
        cosine, index = 0.5 * np.sqrt(half_squared), surface.indices[band]
        inside = np.sqrt(1.0 - (1.0 - cosine**2) / index**2)
        across = (cosine - index * inside) / (cosine + index * inside)
        along = (index * cosine - inside) / (index * cosine + inside)
        lobe = lobe * 0.5 * (across**2 + along**2)
    total = surface.matt[band] * lit / np.pi + lobe
    return np.asarray(np.where((lit > 0.0) & (total > 0.0), lobe / np.maximum(total, 1e-30), 0.0))


def crease_factor(
    surface: Surface, slopes: Floats, variance: Floats, normal: Floats, both: Floats
) -> Floats:
    """Return what creases make of the mirror lobe, (n,).

    Parameters
    ----------
    surface : Surface
    slopes : (3, n) array
        Of ``crease_slopes``.
    variance : (n,) array
        Of them.
    normal : (3, n) array
    both : (3, n) array
        Sum of the directions to the viewer and to the light.
    """
    rms = surface.detail.crease_slope
    along = rms * (slopes - normal * (normal * slopes).sum(axis=0))
    upward = np.maximum((normal * both).sum(axis=0), 1e-6)
    steep = np.maximum((both**2).sum(axis=0) / upward**2 - 1.0, 0.0)
    lean = (both * along).sum(axis=0) / upward
    creased, width = (along**2).sum(axis=0), surface.roughness**2
    return np.asarray(lobe_factor(np, lean, steep, creased, width, rms**2 * variance))


def _lights(
    group: LightGroup, direction: Floats | None, cam_from_target: RigidTransform, place: Floats
) -> list[tuple[Floats, Floats]]:
    """Return directions, (3, n), to the lights of a group, and their weights, (n,)."""
    if direction is not None:
        return [(np.repeat(direction[:, None], place.shape[1], axis=1), np.ones(place.shape[1]))]
    assert isinstance(group, LampGroup)
    axis = cam_from_target.inverse().rotation[:, 2]
    found = []
    for led in group.points_in_target(cam_from_target):
        towards = led[:, None] - place
        distance = np.linalg.norm(towards, axis=0)
        towards = towards / distance
        beam = group.ring.relative_intensity(np.maximum(-(axis @ towards), 0.0))
        found.append((towards, np.asarray(beam) / distance**2))
    return found


def _excess(
    surface: Surface,
    group: LightGroup,
    direction: Floats | None,
    cam_from_target: RigidTransform,
    place: Floats,
    flat: Floats,
    smooth: Floats,
    pixel_rad: float,
) -> Floats:
    """Return by how much of its mean a surface gives more at some places, (n,)."""
    to_lens = cam_from_target.inverse().translation[:, None] - place
    distance = np.linalg.norm(to_lens, axis=0)
    viewer = to_lens / distance
    facing = (flat * viewer).sum(axis=0)
    outward = flat * np.sign(facing)
    normal = smooth * np.sign((smooth * outward).sum(axis=0))
    normal = np.where((normal * viewer).sum(axis=0) > 0.0, normal, outward)
    footprint = distance * pixel_rad / np.sqrt(np.maximum(np.abs(facing), LEAST_FACING))
    detail = surface.detail
    x, y, z = place
    normals = flat[0], flat[1], flat[2]
    shaded = shade(np, (x, y, z), normals, footprint, detail.mottling, detail.tile_spread)
    if detail.crease_slope == 0.0:
        return np.asarray(shaded - 1.0)
    found, variance = crease_slopes(np, (x, y, z), footprint)
    slopes = np.stack(found)
    leant, total = np.zeros(len(x)), np.zeros(len(x))
    for light, weight in _lights(group, direction, cam_from_target, place):
        share = mirror_share(surface, group.channel, normal, viewer, light)
        factor = crease_factor(surface, slopes, variance, normal, viewer + light)
        leant += weight * share * (factor - 1.0)
        total += weight
    return np.asarray(shaded * (1.0 + leant / np.maximum(total, 1e-30)) - 1.0)


def add_detail(
    image: Radiance,
    geometry: SceneGeometry,
    camera: Camera,
    cam_from_target: RigidTransform,
    group: LightGroup,
    window: Window,
    samples: int,
    seed: int,
) -> None:
    """Add to ``image`` what detail makes of the direct light of one group.

    Parameters
    ----------
    image : (height, width) array, W m-2 sr-1
        Changed in place, within the window.
    geometry : SceneGeometry
    camera : Camera
    cam_from_target : RigidTransform
    group : LightGroup
    window : (left, top, width, height), px
    samples : int
        Per pixel; at most ``PASSES`` are used.
    seed : int
    """
    varied = any(each.detail.is_varied for each in geometry.surface_of_shape.values())
    if isinstance(group, EarthGroup) or not varied:
        return
    scene = group_scene(geometry, group, cam_from_target)
    surfaces = [geometry.surface_of_shape[shape.id()] for shape in scene.shapes()]
    passes = min(PASSES, samples)
    directions: list[Floats | None] = [None] * passes
    if isinstance(group, SunGroup):
        directions = list(sun_disc_directions(group, passes))
    pixel_rad = 1.0 / max(camera.fx, camera.fy)
    left, top, width, height = window
    total = np.zeros(width * height)
    for number, direction in enumerate(directions):
        if direction is not None:
            turn_sun(scene, direction)
        turn = (seed + 7919 * (number + 1)) % 2**32
        (found,) = render_windows(scene, camera, cam_from_target, [window], 1, 2, turn, AOVS)
        seen = found.reshape(width * height, -1).T
        light, which = seen[group.channel], np.round(seen[-1]).astype(int)
        if not _resolved(seen[-10:-7], which, cam_from_target, pixel_rad):
            return
        for shape in np.unique(which[(which > 0) & (light > 0.0)]):
            surface = surfaces[shape - 1]
            if not surface.detail.is_varied:
                continue
            here = np.flatnonzero((which == shape) & (light > 0.0))
            place, flat, smooth = seen[-10:-7, here], seen[-7:-4, here], seen[-4:-1, here]
            excess = _excess(
                surface, group, direction, cam_from_target, place, flat, smooth, pixel_rad
            )
            total[here] += light[here] * excess
    patch = image[top : top + height, left : left + width]
    patch += (total / passes).reshape(height, width).astype(np.float32)


def _resolved(
    place: Floats, which: AnyArray, cam_from_target: RigidTransform, pixel_rad: float
) -> bool:
    """Tell whether a pixel resolves anything at all."""
    depth = (cam_from_target @ place.T[which > 0])[:, 2]
    return bool(depth.min(initial=np.inf) * pixel_rad < WIDEST_M)
