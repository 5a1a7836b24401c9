"""What is seen of a spacecraft from one side: which part, how turned, how much it reflects."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mitsuba as mi
import numpy as np

from models.arrays import Labels, Radiance
from models.camera import Camera
from models.pose import RigidTransform
from models.spacecraft.part import Spacecraft
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from renders.tracing.camera_plugin import sensor_dict
from renders.tracing.scene import SceneGeometry, build_geometry, jit_number
from renders.tracing.surfaces import Surface
from renders.variant.choice import active_variant


@dataclass(frozen=True, eq=False)
class SideView:
    """One view.

    Attributes
    ----------
    labels : (height, width) uint8 array
        0 is space; label k + 1 is ``SpacecraftViews.labels[k]``.
    shade : (height, width) float32 array
        Cosine between the surface and the view, 0 in space.
    reflectance : (height, width) float32 array
        In sunlight, of both parts of the material together; 0 in space.
    """

    labels: Labels
    shade: Radiance
    reflectance: Radiance


class SpacecraftViews:
    """A spacecraft ready to be looked at; the process's variant must be set.

    Parameters
    ----------
    craft : Spacecraft
    """

    def __init__(self, craft: Spacecraft) -> None:
        self.geometry: SceneGeometry = build_geometry(craft, None, RetroreflectorOptics())
        self.scene: Any = self.geometry.scene()

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of the labels, from 1."""
        return self.geometry.labels

    def seen(self, camera: Camera, cam_from_target: RigidTransform) -> SideView:
        """Look at it, one ray a pixel.

        Parameters
        ----------
        camera : Camera
        cam_from_target : RigidTransform
        """
        film = {
            "type": "hdrfilm",
            "width": camera.width,
            "height": camera.height,
            "rfilter": {"type": "box"},
            "pixel_format": "luminance",
            "component_format": "float32",
        }
        sampler = {"type": "stratified", "sample_count": 1, "jitter": False}
        sensor = mi.load_dict(sensor_dict(camera, cam_from_target, film) | {"sampler": sampler})
        aov = mi.load_dict({"type": "aov", "aovs": "part:shape_index,facing:geo_normal"})
        channels = np.array(mi.render(self.scene, sensor=sensor, integrator=aov, spp=1))
        shape = np.rint(channels[..., -4]).astype(np.int64)
        normal = channels[..., -3:]
        label_of, reflectance_of = self._tables()
        towards = -cam_from_target.rotation[2].astype(np.float32)
        shade = np.where(shape > 0, np.abs(normal @ towards), 0.0).astype(np.float32)
        return SideView(label_of[shape], shade, reflectance_of[shape])

    def _tables(self) -> tuple[Labels, Radiance]:
        """Return label and reflectance by the number of a shape."""
        numbers = self._numbers()
        label_of = np.zeros(max(numbers) + 1, dtype=np.uint8)
        reflectance_of = np.zeros(max(numbers) + 1, dtype=np.float32)
        for number, key in numbers.items():
            surface = self.geometry.surface_of_shape[key]
            label_of[number] = self.geometry.label_of_shape[key]
            reflectance_of[number] = _in_sunlight(surface)
        return label_of, reflectance_of

    def _numbers(self) -> dict[int, str]:
        shapes = self.scene.shapes()
        if (active_variant() or "").startswith("scalar"):
            return {order: shape.id() for order, shape in enumerate(shapes, start=1)}
        return {jit_number(shape): shape.id() for shape in shapes}


def _in_sunlight(surface: Surface) -> float:
    """Return what a surface reflects at normal incidence, all in all."""
    mirror = surface.mirror[0]
    if surface.indices is not None:
        mirror *= ((surface.indices[0] - 1.0) / (surface.indices[0] + 1.0)) ** 2
    return surface.matt[0] + mirror
