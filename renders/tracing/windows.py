"""Render some windows of an image with Mitsuba's own path tracer, where there is no JIT."""

from __future__ import annotations

from typing import Any

import mitsuba as mi
import numpy as np

from models.arrays import Floats, Mask
from models.camera import Camera
from models.pose import RigidTransform
from renders.tracing.camera_plugin import sensor_dict

Window = tuple[int, int, int, int]  # left, top, width, height, px
QUARTERS = 4


def window_around(in_view: Mask | None, camera: Camera) -> Window:
    """Return the least window that holds some pixels; the whole image for None, or for none.

    Parameters
    ----------
    in_view : (height, width) array of bool, or None
    camera : Camera
    """
    if in_view is None or not in_view.any():
        return 0, 0, camera.width, camera.height
    rows, columns = np.flatnonzero(in_view.any(axis=1)), np.flatnonzero(in_view.any(axis=0))
    left, top = int(columns[0]), int(rows[0])
    return left, top, int(columns[-1]) + 1 - left, int(rows[-1]) + 1 - top


def coarse_window_around(in_view: Mask | None, camera: Camera) -> Window:
    """Return the least window of whole quarters of the image's sides that holds some pixels.

    Mitsuba's own integrators have a kernel for each size and place of a window. Compiling one
    takes longer than the rays that a closer window saves, and none is ever forgotten.

    Parameters
    ----------
    in_view : (height, width) array of bool, or None
    camera : Camera
    """
    left, top, width, height = window_around(in_view, camera)
    left, right = _quarters_around(left, left + width, camera.width)
    top, bottom = _quarters_around(top, top + height, camera.height)
    return left, top, right - left, bottom - top


def _quarters_around(low: int, high: int, size: int) -> tuple[int, int]:
    edges = [size * quarter // QUARTERS for quarter in range(QUARTERS + 1)]
    return max(e for e in edges if e <= low), min(e for e in edges if e >= high)


def render_windows(
    scene: Any,
    camera: Camera,
    cam_from_target: RigidTransform,
    windows: list[Window],
    samples: int,
    segments: int,
    seed: int,
    aovs: str = "",
) -> list[Floats]:
    """Render windows of the camera's image.

    Parameters
    ----------
    scene : Mitsuba scene
    camera : Camera
    cam_from_target : RigidTransform
    windows : list of (left, top, width, height), px
    samples : int
        Per pixel, stratified if a square number.
    segments : int
        Mitsuba's ``max_depth``: 1 shows emitters alone, 2 direct light.
    seed : int
    aovs : str
        What else a sample tells, as Mitsuba's ``aov`` integrator has it.

    Returns
    -------
    list of (height, width, 3 and more) arrays, W m-2 sr-1, one for each window.
    """
    path = {"type": "path", "max_depth": segments, "rr_depth": 10_000}
    integrator = mi.load_dict({"type": "aov", "aovs": aovs, "light": path} if aovs else path)
    images = []
    for left, top, width, height in windows:
        film = {
            "type": "hdrfilm",
            "width": camera.width,
            "height": camera.height,
            "crop_offset_x": left,
            "crop_offset_y": top,
            "crop_width": width,
            "crop_height": height,
            "rfilter": {"type": "box"},
            "pixel_format": "rgb",
            "component_format": "float32",
        }
        square = round(samples**0.5) ** 2 == samples
        kind = "stratified" if square else "independent"
        sampler = {"type": kind, "sample_count": samples}
        sensor = mi.load_dict(sensor_dict(camera, cam_from_target, film) | {"sampler": sampler})
        image = mi.render(scene, sensor=sensor, integrator=integrator, spp=samples, seed=seed)
        images.append(np.array(image, dtype=np.float64))
    return images
