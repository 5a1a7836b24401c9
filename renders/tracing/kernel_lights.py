"""Light groups as the one-pass kernel samples them: a direction, a distance, an irradiance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from models.arrays import Floats
from models.pose import RigidTransform
from renders.tracing.light_groups import EarthGroup, LampGroup, LightGroup, SunGroup


class SunLight:
    """A Sun group as the kernel samples it.

    Its disc is a twentieth as wide as the narrowest lobe (GGX 0.05), so that sampling the disc
    alone leaves next to no noise: no multiple importance sampling.
    """

    wide = False

    def __init__(self, group: SunGroup) -> None:
        self.name, self.channel = group.name, group.channel
        self.irradiance = dr.opaque(mi.Float, group.irradiance_w_m2)
        centre = np.array(group.direction_in_target)
        helper = np.eye(3)[int(np.argmin(np.abs(centre)))]
        across = np.cross(centre, helper)
        across *= group.sine_of_radius / np.linalg.norm(across)
        self.direction = _opaque_vector(centre)
        self.across = _opaque_vector(across)  # as long as the disc's radius
        self.along = _opaque_vector(np.cross(centre, across))

    def sample(self, point: Any, disc: Any, choice: Any) -> tuple[Any, Any, Any]:
        """Return (unit direction to the light, distance or inf, irradiance facing it).

        Parameters
        ----------
        point : Point3f, m
            What is lit, target frame; the Sun is too far off for it to matter.
        disc : Point2f
            Uniform within the unit circle: a place on the Sun's disc.
        choice : Float
            Not needed: there is one Sun.
        """
        towards = dr.normalize(self.direction + self.across * disc.x + self.along * disc.y)
        return towards, mi.Float(dr.inf), self.irradiance


class EarthLight:
    """An Earth group as the kernel samples it: uniformly within its disc.

    Glossy surfaces see it as a picture, so light and lobe are both sampled, and weighed by the
    power heuristic (Veach 1997, equation 9.13).
    """

    wide = True

    def __init__(self, group: EarthGroup) -> None:
        earth = group.earth
        self.name, self.channel = group.name, group.channel
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
        """Return (unit direction to a place on the Earth, inf, irradiance facing it).

        Parameters
        ----------
        point : Point3f, m
            What is lit, target frame; the Earth is too far off for it to matter.
        disc : Point2f
            Uniform within the unit circle: a place on the Earth's disc.
        choice : Float
            Not needed: there is one Earth.
        """
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
        self.name, self.channel = group.name, group.channel
        self.count = float(group.ring.count)
        self.exponent = float(group.ring.exponent)
        self.intensity = dr.opaque(mi.Float, group.ring.intensity_w_sr)
        points = np.asarray(group.points_in_target(cam_from_target), dtype=np.float32)
        self.points = mi.Float(points.ravel())
        dr.make_opaque(self.points)
        self.axis = _opaque_vector(target_from_cam.rotation[:, 2])

    def sample(self, point: Any, disc: Any, choice: Any) -> tuple[Any, Any, Any]:
        """Return (unit direction to the LED, distance, irradiance facing it).

        Parameters
        ----------
        point : Point3f, m
            What is lit, target frame.
        disc : Point2f
            Not needed: an LED is a point.
        choice : Float
            Uniform in [0, 1): which LED.
        """
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
