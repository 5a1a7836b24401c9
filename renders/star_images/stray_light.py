"""Light beside the stars': Sun, Moon and Earth, in the field or scattered into it, and the sky's.

What a lens scatters follows ``models.sensors.lens_scatter``: light that would leave ``E`` electrons
a second as a point leaves ``E B(angle) dOmega`` in each pixel. It changes slowly over the field, so
it is worked out on a grid of nodes and taken as bilinear between them. The Earth is a sphere that
returns a share of sunlight as Lambert has it, without air or clouds; its scattered light is that of
so many pieces of what is seen of it. Discs have sharp rims.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from models.arrays import Floats
from models.camera import Camera
from models.lights.earth import EARTH_RADIUS_KM
from models.sensors.star_camera import StarCamera
from renders.star_images.star_view import SUN_MAG, Disc, EarthView, StarView

NODES = 64  # of the grid along a side, less one
ALBEDO = 0.3
PIECES = 60
NO_BAFFLE_DEG = 90.0
LEAST = 1e-9


def add_stray_light(charge: Floats, view: StarView, sensor: StarCamera) -> None:
    """Add all light but the stars' to the chip's charge.

    Parameters
    ----------
    charge : (height, width) array, e
        Is changed.
    view : StarView
    sensor : StarCamera
    """
    camera = sensor.camera
    pixel_sr = 1.0 / (camera.fx * camera.fy)
    arcsec2 = pixel_sr * (180.0 * 3600.0 / np.pi) ** 2
    charge += float(sensor.electrons(np.array(sensor.sky_mag_arcsec2))) * arcsec2
    nodes = _node_rays(camera)
    scattered = np.zeros(len(nodes))
    for disc in view.discs:
        towards = view.cam_from_icrs @ disc.direction_in_icrs
        electrons = float(sensor.electrons(np.array(disc.magnitude)))
        baffled = disc.magnitude == SUN_MAG
        scattered += electrons * _scattered(nodes, towards[None], sensor, baffled)[:, 0]
        _add_disc(charge, towards, disc, electrons, camera)
    if view.earth is not None:
        pieces, light = _earth_pieces(view, view.earth, sensor)
        scattered += _scattered(nodes, pieces, sensor, True) @ light
        _add_earth(charge, view, view.earth, sensor, pixel_sr)
    if scattered.any():
        charge += _over_pixels(scattered * pixel_sr, camera)


def _scattered(nodes: Floats, towards: Floats, sensor: StarCamera, baffled: bool) -> Floats:
    """Return the scattering function, (nodes, sources), 1/sr, behind the baffle."""
    scatter = sensor.scatter if baffled else replace(sensor.scatter, hood_deg=NO_BAFFLE_DEG)
    off_deg = np.rad2deg(np.arccos(np.clip(towards[:, 2], -1.0, 1.0)))
    passed = np.array([scatter.hood(float(each)) for each in off_deg])
    cosine = np.maximum(nodes @ towards.T, LEAST)  # the hood ends at a right angle, not a pixel
    return scatter.scattered(cosine) * passed


def _add_disc(
    charge: Floats, towards: Floats, disc: Disc, electrons: float, camera: Camera
) -> None:
    radius = np.deg2rad(disc.radius_deg)
    if towards[2] < np.cos(np.pi / 3.0):
        return
    middle = camera.project(towards)
    reach = int(np.ceil(1.5 * radius * max(camera.fx, camera.fy))) + 2
    if not camera.contains(middle[None], -float(reach))[0]:
        return
    low = np.maximum(np.rint(middle).astype(np.int64) - reach, 0)
    high = np.minimum(np.rint(middle).astype(np.int64) + reach + 1, [camera.width, camera.height])
    rows, columns = np.mgrid[low[1] : high[1], low[0] : high[0]]
    rays = camera.rays(np.stack([columns, rows], axis=-1).reshape(-1, 2))
    inside = (np.linalg.norm(rays - towards, axis=1) < radius).reshape(rows.shape)
    pixel_sr = 1.0 / (camera.fx * camera.fy)
    level = electrons * pixel_sr / (np.pi * radius**2)
    charge[low[1] : high[1], low[0] : high[0]] += level * inside


def _earth_pieces(view: StarView, earth: EarthView, sensor: StarCamera) -> tuple[Floats, Floats]:
    """Return where pieces of the Earth stand, (n, 3) in cam, and the electrons of each, (n,)."""
    distance = float(np.linalg.norm(earth.centre_in_icrs))
    radius = 1e3 * EARTH_RADIUS_KM
    down = earth.centre_in_icrs / distance
    edge = np.sqrt(max(1.0 - (radius / distance) ** 2, 0.0))
    # A spiral of equal areas (Fibonacci) over the cap of the sky that the Earth covers.
    place = np.arange(PIECES) + 0.5
    cosine = 1.0 - (1.0 - edge) * place / PIECES
    azimuth = np.pi * (1.0 + np.sqrt(5.0)) * place
    aside = np.cross(down, np.eye(3)[int(np.argmin(np.abs(down)))])
    aside /= np.linalg.norm(aside)
    sine = np.sqrt(1.0 - cosine**2)
    rays = cosine[:, None] * down + sine[:, None] * (
        np.cos(azimuth)[:, None] * aside + np.sin(azimuth)[:, None] * np.cross(down, aside)
    )
    solid_sr = 2.0 * np.pi * (1.0 - edge) / PIECES
    light = float(sensor.electrons(np.array(SUN_MAG))) * _returned(rays, earth) * solid_sr
    return rays @ view.cam_from_icrs.T, light


def _returned(rays: Floats, earth: EarthView) -> Floats:
    """Return the radiance over the Sun's irradiance, 1/sr, where rays (n, 3) meet the Earth."""
    radius = 1e3 * EARTH_RADIUS_KM
    along = rays @ earth.centre_in_icrs
    short = along**2 - float(earth.centre_in_icrs @ earth.centre_in_icrs) + radius**2
    hit = (short > 0.0) & (along > 0.0)
    met = (along - np.sqrt(np.maximum(short, 0.0)))[:, None] * rays - earth.centre_in_icrs
    cosine = np.maximum(met @ earth.sun_in_icrs / radius, 0.0)
    return np.where(hit, ALBEDO / np.pi * cosine, 0.0)


def _add_earth(
    charge: Floats, view: StarView, earth: EarthView, sensor: StarCamera, pixel_sr: float
) -> None:
    """Add the Earth's own image, and take away the sky behind it."""
    camera = sensor.camera
    towards = view.cam_from_icrs @ earth.centre_in_icrs
    distance = float(np.linalg.norm(towards))
    edge = np.sqrt(max(1.0 - (1e3 * EARTH_RADIUS_KM / distance) ** 2, 0.0))
    corner = np.arccos(camera.rays(camera.spread_px(1))[:, 2].min())
    if np.arccos(np.clip(towards[2] / distance, -1.0, 1.0)) > np.arccos(edge) + corner:
        return
    rays = _pixel_rays(camera)
    covered = rays @ (towards / distance) > edge
    found = np.zeros(len(rays))
    found[covered] = _returned(rays[covered] @ view.cam_from_icrs, earth)
    light = float(sensor.electrons(np.array(SUN_MAG))) * found * pixel_sr
    charge *= ~covered.reshape(charge.shape)
    charge += light.reshape(charge.shape)


def _over_pixels(values: Floats, camera: Camera) -> Floats:
    columns = _between(values.reshape(NODES + 1, NODES + 1).T, camera.width).T
    return _between(columns, camera.height)


def _between(nodes: Floats, pixels: int) -> Floats:
    """Return rows at so many pixels' middles, (pixels, n), linear between rows of nodes."""
    place = (np.arange(pixels) + 0.5) / pixels * NODES
    low = place.astype(np.int64)
    part = (place - low)[:, None]
    return nodes[low] + part * (nodes[low + 1] - nodes[low])


@lru_cache(maxsize=4)
def _node_rays(camera: Camera) -> Floats:
    return camera.rays(camera.spread_px(NODES))


@lru_cache(maxsize=2)
def _pixel_rays(camera: Camera) -> Floats:
    rows, columns = np.mgrid[: camera.height, : camera.width]
    return camera.rays(np.stack([columns, rows], axis=-1).reshape(-1, 2))
