"""What detail makes of a place's light where there is no JIT, term by term."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.arrays import Floats
from models.lights.led_beam import LAMPS_850
from models.pose import RigidTransform
from renders.tracing import detail_passes
from renders.tracing.fine_detail import WIDEST_M, shade
from renders.tracing.foil_creases import crease_slopes, lobe_factor
from renders.tracing.light_groups import LampGroup
from renders.tracing.surfaces import Surface, SurfaceDetail

METAL = Surface((0.2, 0.3, 0.1), (0.5, 0.6, 0.7), 0.3)
GLASS = replace(METAL, indices=(1.5, 1.6, 1.7))
POSE = RigidTransform(Rotation.from_rotvec([0.4, 2.6, 0.2]).as_matrix(), np.array([0.1, -0.2, 3.0]))
LAMPS = LampGroup("lamps_850", LAMPS_850, 2)
PIXEL_RAD = 1e-3


def ways(seed: int, count: int = 40) -> tuple[Floats, Floats, Floats]:
    """Draw normals, and directions to viewer and light on their side, (3, n)."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(3):
        way = rng.standard_normal((3, count))
        found.append(way / np.linalg.norm(way, axis=0))
    normal, viewer, light = found
    return normal, *(way * np.sign((way * normal).sum(axis=0)) for way in (viewer, light))


@pytest.mark.parametrize("surface", [METAL, GLASS], ids=["metal", "glass"])
def test_the_mirror_lobes_share_is_that_of_cook_torrance(surface: Surface) -> None:
    """GGX with Smith's masking of each direction by itself, and Fresnel's exact reflectance."""
    normal, viewer, light = ways(1)
    found = detail_passes.mirror_share(surface, 1, normal, viewer, light)
    alpha = surface.roughness
    for k, (n, v, sun) in enumerate(zip(normal.T, viewer.T, light.T, strict=True)):
        half = (v + sun) / np.linalg.norm(v + sun)
        nv, nl, nh, vh = n @ v, n @ sun, n @ half, v @ half
        density = alpha**2 / (np.pi * ((nh**2) * (alpha**2 - 1.0) + 1.0) ** 2)
        masks = [2.0 * c / (c + np.sqrt(alpha**2 + (1 - alpha**2) * c**2)) for c in (nv, nl)]
        mirror = surface.mirror[1]
        if surface.indices is not None:
            index = surface.indices[1]
            inside = np.sqrt(1.0 - (1.0 - vh**2) / index**2)
            s_wave = ((vh - index * inside) / (vh + index * inside)) ** 2
            p_wave = ((inside - index * vh) / (inside + index * vh)) ** 2
            mirror *= 0.5 * (s_wave + p_wave)
        lobe = mirror * density * masks[0] * masks[1] / (4.0 * nv * nl) * nl
        matt = surface.matt[1] / np.pi * nl
        assert found[k] == pytest.approx(lobe / (lobe + matt), rel=1e-9)
    behind = detail_passes.mirror_share(surface, 1, normal, viewer, -light)
    np.testing.assert_array_equal(behind, 0.0)


def test_creases_change_the_lobe_by_their_slopes_on_the_half_vectors() -> None:
    """In the plane of the surface: the half vector's slopes, and the creases', as vectors."""
    creased = replace(METAL, detail=SurfaceDetail(crease_slope=0.2))
    normal, viewer, light = ways(2)
    rng = np.random.default_rng(3)
    slopes, variance = rng.standard_normal((3, 40)), rng.uniform(0.2, 1.0, 40)
    found = detail_passes.crease_factor(creased, slopes, variance, normal, viewer + light)
    for k, (n, both) in enumerate(zip(normal.T, (viewer + light).T, strict=True)):
        half = both / (both @ n) - n  # slopes: what lies in the plane, over the height
        own = 0.2 * (slopes[:, k] - n * (n @ slopes[:, k]))
        expected = lobe_factor(np, half @ own, half @ half, own @ own, 0.3**2, 0.04 * variance[k])
        assert found[k] == pytest.approx(float(expected), rel=1e-6)


def test_lamps_shine_from_where_they_stand_by_their_beam_and_distance() -> None:
    place = np.array([[0.3, -0.5], [0.2, 0.1], [0.0, 0.4]])
    found = detail_passes._lights(LAMPS, None, POSE, place)
    assert len(found) == LAMPS_850.count
    eye, axis = POSE.inverse().translation, POSE.rotation[2]
    for (towards, weight), led in zip(found, LAMPS_850.points_in_cam, strict=True):
        at = POSE.inverse() @ led
        for k in range(2):
            gap = at - place[:, k]
            np.testing.assert_allclose(towards[:, k], gap / np.linalg.norm(gap))
            off = -(gap @ axis) / np.linalg.norm(gap)
            beam = float(LAMPS_850.relative_intensity(off))
            assert weight[k] == pytest.approx(beam / (gap @ gap))
        assert np.linalg.norm(at - eye) == pytest.approx(LAMPS_850.radius_m)
    sun = np.array([0.0, 0.6, 0.8])
    ((towards, weight),) = detail_passes._lights(LAMPS, sun, POSE, place)
    np.testing.assert_array_equal(towards, np.stack([sun, sun], axis=1))
    np.testing.assert_array_equal(weight, 1.0)


def places(seed: int, count: int = 12) -> tuple[Floats, Floats]:
    rng = np.random.default_rng(seed)
    place = rng.uniform(-0.5, 0.5, (3, count))
    normal = POSE.inverse().translation[:, None] - place + rng.uniform(-1.0, 1.0, (3, count))
    return place, normal / np.linalg.norm(normal, axis=0)


@pytest.mark.parametrize("flipped", [1.0, -1.0])
def test_a_plain_surfaces_excess_is_its_shade_at_the_pixels_footprint(flipped: float) -> None:
    """A pixel covers distance times its angle, drawn out by the root of the slant."""
    detail = SurfaceDetail(mottling=0.05, tile_spread=0.1)
    surface = replace(METAL, detail=detail)
    place, normal = places(4)
    flat = flipped * normal
    found = detail_passes._excess(surface, LAMPS, None, POSE, place, flat, flat, PIXEL_RAD)
    gap = POSE.inverse().translation[:, None] - place
    distance = np.linalg.norm(gap, axis=0)
    slant = np.abs((gap / distance * flat).sum(axis=0))
    footprint = distance * PIXEL_RAD / np.sqrt(np.maximum(slant, 0.05))
    expected = shade(np, tuple(place), tuple(flat), footprint, 0.05, 0.1) - 1.0
    np.testing.assert_allclose(found, expected)
    assert np.abs(found).max() > 0.01


def test_a_creased_surfaces_excess_is_the_mean_over_its_lamps() -> None:
    """Each lamp's mirror share times what creases make of it, weighed by its light there."""
    surface = replace(METAL, detail=SurfaceDetail(crease_slope=0.15))
    place, normal = places(5)
    found = detail_passes._excess(surface, LAMPS, None, POSE, place, normal, normal, PIXEL_RAD)
    gap = POSE.inverse().translation[:, None] - place
    distance = np.linalg.norm(gap, axis=0)
    viewer = gap / distance
    slant = np.abs((viewer * normal).sum(axis=0))
    slopes, variance = crease_slopes(np, tuple(place), distance * PIXEL_RAD / np.sqrt(slant))
    above, below = np.zeros(12), np.zeros(12)
    for light, weight in detail_passes._lights(LAMPS, None, POSE, place):
        share = detail_passes.mirror_share(surface, 2, normal, viewer, light)
        factor = detail_passes.crease_factor(
            surface, np.stack(slopes), variance, normal, viewer + light
        )
        above += weight * share * (factor - 1.0)
        below += weight
    np.testing.assert_allclose(found, above / below, atol=1e-12)
    assert np.abs(found).max() > 0.01


@pytest.mark.parametrize(("share", "resolved"), [(0.99, True), (1.01, False)])
def test_a_pixel_resolves_detail_if_the_nearest_place_is_near_enough(share, resolved) -> None:
    depth = share * WIDEST_M / PIXEL_RAD
    far = RigidTransform(np.eye(3), np.array([0.0, 0.0, depth]))
    place = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 5.0, -0.5 * depth]])
    which = np.array([1, 2, 0])
    assert detail_passes._resolved(place, which, far, PIXEL_RAD) == resolved
    assert not detail_passes._resolved(place, 0 * which, far, PIXEL_RAD)
