"""Radiance of light groups over a whole image, with more samples where markers are.

The whole image is traced with a few samples per pixel, then the windows around the markers anew
with many, and the lamps' light on their outlines with more yet, because there Monte-Carlo noise
must stay well below the detector's own. One seed serves both exposures of a pair, so that their
noise cancels in the difference instead of making blobs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from models.arrays import AnyArray, Mask, Radiance
from models.camera import Camera
from models.markers import MarkerPattern
from models.pose import RigidTransform
from renders.tracing.adaptive import trace_to_noise
from renders.tracing.cube_rims import near_rims
from renders.tracing.detail_passes import add_detail
from renders.tracing.emitter_by_emitter import render_group
from renders.tracing.group_integrator import Walk, trace_groups
from renders.tracing.light_groups import LampGroup, LightGroup
from renders.tracing.light_paths.from_sun import NOTHING, FromSun
from renders.tracing.marker_lobes import add_lobes
from renders.tracing.noise_limit import NoiseLimit
from renders.tracing.scene import SceneGeometry
from renders.tracing.surface_table import SurfaceTable
from renders.tracing.windows import Window, window_around

TILE_PX = 4
WINDOW_MARGIN_PX = 3.0  # beyond the disc: the point-spread function at five sigma
EDGE_PX = 1.5  # a pixel this near to a disc's outline may be cut by it
FAR_M = 1e9  # where a ray that sees a disc's back meets its plane: nowhere near
NEAR_SAMPLES = 256  # inside a window but off the outline, where light varies smoothly


@dataclass(frozen=True)
class Sampling:
    """How many paths, how long, and from which seed.

    Attributes
    ----------
    samples, marker_samples : int
        Per pixel; powers of two are spread most evenly.
    max_depth : int
        Surface interactions of a path; 1 is direct light.
    seed : int
    noise : mapping of NoiseLimit, optional
        By the name of a group, what each pixel is traced to instead of ``samples`` (JIT variants).
    found : FromSun
        What is found from the Sun, and not from the lens (JIT variants).
    """

    samples: int
    marker_samples: int
    max_depth: int
    seed: int
    noise: Mapping[str, NoiseLimit] | None = None
    found: FromSun = NOTHING


@lru_cache(maxsize=2)
def tiled_pixels(width: int, height: int) -> AnyArray:
    """Return all pixels in 4 x 4 tiles: the lanes that Embree walks together then see one place.

    Returns
    -------
    (width * height,) uint32 array, indices ``row * width + column``.
    """
    down, across = -(-height // TILE_PX), -(-width // TILE_PX)
    beyond = width * height
    padded = np.full((down * TILE_PX, across * TILE_PX), beyond, dtype=np.uint32)
    padded[:height, :width] = np.arange(beyond, dtype=np.uint32).reshape(height, width)
    tiles = padded.reshape(down, TILE_PX, across, TILE_PX).swapaxes(1, 2).ravel()
    return tiles[tiles < beyond]


def marker_windows(
    markers: MarkerPattern, camera: Camera, cam_from_target: RigidTransform
) -> list[Window]:
    """Return the windows (left, top, width, height), px, that hold each marker's disc.

    Parameters
    ----------
    markers : MarkerPattern
    camera : Camera
    cam_from_target : RigidTransform
    """
    windows = []
    in_cam = cam_from_target @ markers.points_in_target
    for (u, v), point in zip(camera.project(in_cam), in_cam, strict=True):
        if point[2] <= markers.radius_m or not np.isfinite(u):
            continue
        reach = markers.radius_m * max(camera.fx, camera.fy) / point[2] + WINDOW_MARGIN_PX
        left, top = max(0, int(np.floor(u - reach))), max(0, int(np.floor(v - reach)))
        right = min(camera.width, int(np.ceil(u + reach)) + 1)
        bottom = min(camera.height, int(np.ceil(v + reach)) + 1)
        if right > left and bottom > top:
            windows.append((left, top, right - left, bottom - top))
    return windows


def marker_pixels(
    markers: MarkerPattern, camera: Camera, cam_from_target: RigidTransform, windows: list[Window]
) -> tuple[AnyArray, AnyArray]:
    """Return the pixels of the windows, and those of them that an outline may cut.

    Only the latter need many samples: what a sample there meets is all or nothing. A pixel's ray
    is met with each disc's plane, and its distance from the disc's outline counted in pixels; from
    those on a corner cube's face, ``renders.tracing.cube_rims``, too.

    Parameters
    ----------
    markers : MarkerPattern
    camera : Camera
    cam_from_target : RigidTransform
    windows : list of (left, top, width, height), px
        At least one.

    Returns
    -------
    two (n,) uint32 arrays, indices ``row * width + column``.
    """
    grid = np.arange(camera.width * camera.height, dtype=np.uint32).reshape(camera.height, -1)
    near = np.unique(np.concatenate([grid[t : t + h, a : a + w].ravel() for a, t, w, h in windows]))
    pixels = np.stack([near % camera.width, near // camera.width], axis=1).astype(np.float64)
    rays = camera.rays(pixels)
    cut = np.zeros(len(near), dtype=bool)
    normals_in_cam = cam_from_target.rotate(markers.normals_in_target)
    for centre, normal, normal_in_target in zip(
        cam_from_target @ markers.points_in_target,
        normals_in_cam,
        markers.normals_in_target,
        strict=True,
    ):
        if centre[2] <= markers.radius_m:
            continue
        facing = rays @ normal
        reach = np.where(facing < -1e-3, (centre @ normal) / np.minimum(facing, -1e-3), FAR_M)
        off_centre = rays * reach[:, None] - centre
        pixel_m = centre[2] / camera.fx / max(-normal @ centre / np.linalg.norm(centre), 0.1)
        aside_m = np.linalg.norm(off_centre, axis=1)
        cut |= np.abs(aside_m - markers.radius_m) < EDGE_PX * pixel_m
        if not markers.paint:
            here = np.flatnonzero(aside_m < markers.radius_m)
            cut[here] |= near_rims(
                off_centre[here] @ cam_from_target.rotation / markers.radius_m,
                -(centre / np.linalg.norm(centre)) @ cam_from_target.rotation,
                normal_in_target,
                pixel_m / markers.radius_m,
                EDGE_PX,
            )
    return near, near[cut]


def render_radiance(
    scene: Any,
    geometry: SceneGeometry,
    camera: Camera,
    cam_from_target: RigidTransform,
    groups: Sequence[LightGroup],
    markers: MarkerPattern | None,
    sampling: Sampling,
    in_view: Mask | None = None,
) -> dict[str, Radiance]:
    """Render all groups of one exposure.

    Parameters
    ----------
    scene : mitsuba.Scene
        ``geometry`` loaded, with the chaser in its place.
    geometry : SceneGeometry
    camera : Camera
    cam_from_target : RigidTransform
    groups : sequence of LightGroup
    markers : MarkerPattern or None
        Where to spend ``marker_samples``.
    sampling : Sampling
    in_view : (height, width) array of bool, optional
        Pixels that can show anything; the others are dark. See ``renders.tracing.silhouette``.

    Returns
    -------
    dict of (height, width) float32 arrays, W m-2 sr-1, by group name.
    """
    windows = marker_windows(markers, camera, cam_from_target) if markers is not None else []
    if not dr.is_jit_v(mi.Float):
        return _one_by_one(geometry, camera, cam_from_target, groups, windows, sampling, in_view)
    tiled = tiled_pixels(camera.width, camera.height)
    if in_view is not None:
        tiled = tiled[in_view.ravel()[tiled]]
    surfaces, samples = geometry.surfaces, sampling.samples
    traced: dict[str, Radiance] = {}
    if len(tiled) and sampling.noise is not None:
        depth, found = sampling.max_depth, sampling.found
        walk = Walk(scene, surfaces, camera, cam_from_target, groups, depth, found)
        shape = (camera.height, camera.width)
        traced = trace_to_noise(walk, tiled, shape, sampling.noise, sampling.seed)
    elif len(tiled):  # Dr.Jit traces no empty work
        traced = _traced(scene, surfaces, camera, cam_from_target, groups, tiled, samples, sampling)
    images = {}
    for name in [group.name for group in groups]:
        images[name] = np.zeros(camera.width * camera.height, dtype=np.float32)
        if name in traced:
            images[name][tiled] = traced.pop(name)  # one at a time: a hundred Suns fill a memory
    if markers is not None and windows:
        near, edge = marker_pixels(markers, camera, cam_from_target, windows)
        shown_by = [group for group in groups if markers.paint or isinstance(group, LampGroup)]
        near_samples = min(NEAR_SAMPLES, sampling.marker_samples)
        # A Sun's light changes little across a retroreflector's outline; lamps' is returned on one
        # side alone. Of paint on black any light shows the outline.
        for pixels, samples, lit in (
            (near, near_samples, groups if sampling.noise is None else shown_by),
            (edge, sampling.marker_samples, shown_by),
        ):
            if len(pixels) == 0 or not lit:  # no disc shows its face, or no lamp shines
                continue
            fine = _traced(scene, surfaces, camera, cam_from_target, lit, pixels, samples, sampling)
            for name, light in fine.items():
                images[name][pixels] = light
    for name, light in sampling.found.images.items():
        images[name] += light
    return {name: image.reshape(camera.height, camera.width) for name, image in images.items()}


def _traced(
    scene: Any,
    surfaces: SurfaceTable,
    camera: Camera,
    cam_from_target: RigidTransform,
    groups: Sequence[LightGroup],
    pixels: Any,
    samples: int,
    sampling: Sampling,
) -> dict[str, Radiance]:
    return trace_groups(
        scene,
        surfaces,
        camera,
        cam_from_target,
        groups,
        pixels,
        samples=samples,
        max_depth=sampling.max_depth,
        seed=sampling.seed,
        found=sampling.found,
    )


def _one_by_one(
    geometry: SceneGeometry,
    camera: Camera,
    cam_from_target: RigidTransform,
    groups: Sequence[LightGroup],
    windows: list[Window],
    sampling: Sampling,
    in_view: Mask | None,
) -> dict[str, Radiance]:
    left, top, width, height = window_around(in_view, camera)
    near_samples = min(NEAR_SAMPLES, sampling.marker_samples)
    images = {}
    for group in groups:
        common = (geometry, camera, cam_from_target, group)
        depth, seed = sampling.max_depth, sampling.seed
        image = np.zeros((camera.height, camera.width), dtype=np.float32)
        image[top : top + height, left : left + width] = render_group(
            *common, [(left, top, width, height)], sampling.samples, depth, seed
        )[0]
        # Sixteen passes of every Sun over every window would take longer than the image itself.
        shining = windows if isinstance(group, LampGroup) else []
        fine = render_group(*common, shining, near_samples, depth, seed)
        for window, patch in zip(shining, fine, strict=True):
            column, row, across, down = window
            image[row : row + down, column : column + across] = patch
        add_detail(image, *common, (left, top, width, height), sampling.samples, seed)
        if isinstance(group, LampGroup) and geometry.discs is not None:
            discs = marker_windows(geometry.discs, camera, cam_from_target)
            samples = max(NEAR_SAMPLES, sampling.marker_samples)
            add_lobes(image, geometry, camera, cam_from_target, group, discs, samples, seed)
        images[group.name] = image
    return images
