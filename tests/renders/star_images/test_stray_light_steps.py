"""Stray light, step by step: pieces of the Earth, discs, a grid that is linear between nodes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.camera import Camera
from models.lights.earth import EARTH_RADIUS_KM
from models.sensors.lens_scatter import LensScatter
from models.sensors.star_camera import StarCamera
from renders.star_images import stray_light
from renders.star_images.star_view import SUN_MAG, Disc, EarthView, StarView, moon_disc

CAMERA = Camera.from_fov(96, 64, 20.0)
SENSOR = replace(StarCamera(), camera=CAMERA)
PIXEL_SR = 1.0 / (CAMERA.fx * CAMERA.fy)
RADIUS_M = 1e3 * EARTH_RADIUS_KM
AHEAD = np.array([0.0, 0.0, 1.0])
DARK = replace(SENSOR, scatter=LensScatter(), sky_mag_arcsec2=99.0)


def electrons(magnitude: float) -> float:
    return float(SENSOR.electrons(np.array(magnitude)))


def test_a_linear_function_on_the_nodes_is_itself_on_the_pixels() -> None:
    """Nodes run from the image's edge to its edge; pixels' middles lie between."""
    u = np.linspace(-0.5, CAMERA.width - 0.5, stray_light.NODES + 1)
    v = np.linspace(-0.5, CAMERA.height - 0.5, stray_light.NODES + 1)
    nodes = 3.0 * u[None] - 2.0 * v[:, None] + 5.0
    rows, columns = np.mgrid[: CAMERA.height, : CAMERA.width]
    np.testing.assert_allclose(
        stray_light._over_pixels(nodes.ravel(), CAMERA), 3.0 * columns - 2.0 * rows + 5.0, atol=1e-9
    )
    spread = stray_light._node_rays(CAMERA).reshape(65, 65, 3)
    np.testing.assert_allclose(CAMERA.project(spread[3, 50]), [u[50], v[3]], atol=1e-9)


@pytest.mark.parametrize("centre", [[0.0, 0.0, 7.0e6], [3.0e7, -2.0e7, 1.0e7], [-8e6, 1e6, 2e6]])
def test_pieces_of_the_earth_cover_its_cap_evenly_and_return_what_the_ball_does(centre) -> None:
    """Solid angle of the cap; where the Sun stands behind the camera, a full ball's 2/3 albedo."""
    far = np.array(centre)
    distance = np.linalg.norm(far)
    earth = EarthView(far, -far / distance)
    view = StarView(np.eye(3), earth=earth)
    pieces, light = stray_light._earth_pieces(view, earth, SENSOR)
    np.testing.assert_allclose(np.linalg.norm(pieces, axis=1), 1.0)
    edge = np.sqrt(1.0 - (RADIUS_M / distance) ** 2)
    off = pieces @ far / distance
    assert off.min() > edge
    height = np.sort((1.0 - off) / (1.0 - edge))
    np.testing.assert_allclose(height, (np.arange(60) + 0.5) / 60, atol=1e-9)
    aside = pieces - off[:, None] * far / distance
    assert np.linalg.norm(aside.mean(axis=0)) < 0.06 * np.sqrt(1.0 - edge**2)
    returned = light / (electrons(SUN_MAG) * 2.0 * np.pi * (1.0 - edge) / 60)
    # Lambert's albedo over pi, times the cosine where each ray meets the ball.
    reach = off * distance - np.sqrt((off * distance) ** 2 - distance**2 + RADIUS_M**2)
    normals = (reach[:, None] * pieces - far) / RADIUS_M
    np.testing.assert_allclose(returned, 0.3 / np.pi * (normals @ earth.sun_in_icrs), atol=1e-9)


def test_a_half_lit_earth_is_dark_on_its_other_half() -> None:
    far = np.array([0.0, 0.0, 4.2e7])
    earth = EarthView(far, np.array([1.0, 0.0, 0.0]))
    rays = np.array([[0.05, 0, 1.0], [-0.05, 0, 1.0], [0.3, 0, 1.0], [0.0, 0, -1.0]])
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    found = stray_light._returned(rays, earth)
    assert found[0] > 0.0
    assert found[1:].tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("place", [(0.0, 0.0), (0.08, -0.05)])
def test_a_disc_in_the_field_has_its_light_and_its_size(place) -> None:
    towards = np.array([*place, 1.0])
    towards /= np.linalg.norm(towards)
    disc = Disc(towards, -5.0, 1.1)
    charge = np.zeros((CAMERA.height, CAMERA.width))
    stray_light._add_disc(charge, towards, disc, 8e5, CAMERA)
    lit = charge > 0.0
    assert charge.sum() == pytest.approx(8e5, rel=0.05)  # some 80 pixels, whole or not at all
    area = np.pi * np.deg2rad(1.1) ** 2 / PIXEL_SR
    assert charge[lit] == pytest.approx(8e5 / area)
    row, column = np.nonzero(lit)
    np.testing.assert_allclose([column.mean(), row.mean()], CAMERA.project(towards), atol=0.3)
    for away in ([0.5, 0.0, 1.0], [0.0, 0.0, -1.0], [2.0, 0.0, 1.0]):
        other = np.array(away) / np.linalg.norm(away)
        stray_light._add_disc(charge, other, disc, 8e5, CAMERA)
    assert charge.sum() == pytest.approx(8e5, rel=0.05)
    rim = CAMERA.rays(np.array([-1.0, 30.0]))
    stray_light._add_disc(charge, rim, disc, 8e5, CAMERA)
    assert charge[30, 0] > 0.0
    assert charge[30, 12] == 0.0


def test_the_sky_is_a_brightness_for_each_square_arc_second() -> None:
    sensor = replace(SENSOR, scatter=LensScatter(), sky_mag_arcsec2=21.5)
    charge = np.ones((CAMERA.height, CAMERA.width))
    stray_light.add_stray_light(charge, StarView(np.eye(3)), sensor)
    arcsec = np.rad2deg(1.0 / CAMERA.fx) * 3600.0
    np.testing.assert_allclose(charge, 1.0 + electrons(21.5) * arcsec**2, rtol=1e-6)


def test_the_earth_hides_the_sky_where_it_is_and_shines_by_its_day() -> None:
    """Filling a corner: its limb where geometry says, full light where its Sun is overhead."""
    limb_deg, distance = 6.0, 4.2e7
    half = np.arcsin(RADIUS_M / distance)
    lean = half + np.deg2rad(limb_deg)
    centre = distance * np.array([np.sin(lean), 0.0, np.cos(lean)])
    earth = EarthView(centre, -centre / distance)
    charge = np.full((CAMERA.height, CAMERA.width), 7.0)
    stray_light._add_earth(charge, StarView(np.eye(3), earth=earth), earth, DARK, PIXEL_SR)
    rays = stray_light._pixel_rays(CAMERA).reshape(CAMERA.height, CAMERA.width, 3)
    covered = rays @ centre / distance > np.cos(half)
    assert 0.1 < covered.mean() < 0.4
    np.testing.assert_array_equal(charge[~covered], 7.0)
    expected = electrons(SUN_MAG) * PIXEL_SR * stray_light._returned(rays[covered], earth)
    np.testing.assert_allclose(charge[covered], expected)
    away = EarthView(np.array([-distance, 0.0, 0.0]), AHEAD)
    before = charge.copy()
    stray_light._add_earth(charge, StarView(np.eye(3), earth=away), away, DARK, PIXEL_SR)
    np.testing.assert_array_equal(charge, before)


@pytest.mark.parametrize(("off_deg", "magnitude", "passed"), [
    (25.0, SUN_MAG, 1.0), (45.0, SUN_MAG, 0.01), (45.0, -12.7, 1.0), (95.0, SUN_MAG, 0.0),
])  # fmt: skip
def test_what_the_lens_scatters_is_its_function_times_a_pixel(off_deg, magnitude, passed) -> None:
    """Behind the hood a hundredth of the Sun; the Moon knows none; nothing comes from behind."""
    scatter = LensScatter(3.0, 0.6, 2.0, hood_deg=40.0, hood_leak=0.01)
    sensor = replace(SENSOR, scatter=scatter, sky_mag_arcsec2=99.0)
    off = np.deg2rad(off_deg)
    towards = np.array([np.sin(off), 0.0, np.cos(off)])
    view = StarView(np.eye(3), discs=(Disc(towards, magnitude, 0.26),))
    charge = np.zeros((CAMERA.height, CAMERA.width))
    stray_light.add_stray_light(charge, view, sensor)
    rays = stray_light._pixel_rays(CAMERA).reshape(CAMERA.height, CAMERA.width, 3)
    own = scatter.scattered(rays @ towards) * passed * electrons(magnitude) * PIXEL_SR
    sky = electrons(99.0) * (np.rad2deg(1.0 / CAMERA.fx) * 3600.0) ** 2
    np.testing.assert_allclose(charge, own + sky, rtol=2e-3, atol=1e-9)


def test_the_moon_is_brightest_full_and_as_large_as_it_is() -> None:
    """Allen 1976: half a moon is 2.34 + 0.26 magnitudes fainter than a full one."""
    place = np.array([0.0, 0.0, 3.844e8])
    full, half = moon_disc(place, -AHEAD), moon_disc(place, np.array([1.0, 0.0, 0.0]))
    assert full.magnitude == -12.73
    assert half.magnitude == pytest.approx(-12.73 + 0.026 * 90.0 + 4e-9 * 90.0**4)
    assert 2.0 * full.radius_deg == pytest.approx(0.518, abs=2e-3)
    np.testing.assert_allclose(full.direction_in_icrs, AHEAD)
