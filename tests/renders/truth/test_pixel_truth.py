"""Ground truth against geometry that can be worked out by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from models.arrays import Floats
from models.camera import Camera
from models.lights.led_beam import LAMPS_850, LedRing
from models.markers import MarkerPattern
from models.pose import RigidTransform
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from renders.truth.pixel_truth import DISC_POINTS, MarkerLight, PixelTruth
from tests.support.small_scenes import FACING, LAMBERT, activate_best, camera_at, discs, plate

CAMERA = Camera(96, 80, 110.0, 110.0, 47.2, 40.9)
BENT = replace(CAMERA, fy=104.0, k1=-0.2, k2=0.05, p1=1e-3, p2=-2e-3)
ONE_POINT = 1.0 / DISC_POINTS  # of those spread over a disc: what a share can be told to
SINGLE_PRECISION_M = 2e-5


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    activate_best()


def tilted(range_m: float = 4.0) -> RigidTransform:
    turn = RigidTransform(FACING, np.zeros(3)).perturbed([0.2, -0.3, 0.4], np.zeros(3)).rotation
    return RigidTransform(turn, np.array([0.05, -0.1, range_m]))


def block(at: tuple[float, float, float], size: tuple[float, float, float]) -> trimesh.Trimesh:
    return trimesh.creation.box(size).apply_translation(at)


def truth_of(craft: Spacecraft, camera: Camera, pose: RigidTransform) -> tuple[PixelTruth, list]:
    from renders.tracing.scene import build_geometry
    from renders.truth.pixel_truth import pixel_truth

    geometry = build_geometry(craft, None, RetroreflectorOptics())
    return pixel_truth(geometry.scene(), geometry, camera, pose), ["", *geometry.labels]


def rays_in_cam(camera: Camera) -> Floats:
    v, u = np.mgrid[0 : camera.height, 0 : camera.width]
    rays = camera.rays(np.stack([u, v], axis=-1).reshape(-1, 2).astype(float))
    return rays.reshape(camera.height, camera.width, 3)


# Pixels


@pytest.mark.parametrize("camera", [CAMERA, BENT], ids=["straight", "bent"])
def test_depth_is_along_the_boresight_and_not_along_the_ray(camera: Camera) -> None:
    pose = tilted()
    truth, _ = truth_of(plate(LAMBERT, size_m=50.0), camera, pose)
    rays = rays_in_cam(camera)
    normal = pose.rotation @ [0.0, 0.0, 1.0]
    expected = rays[..., 2] * (pose.translation @ normal) / (rays @ normal)
    np.testing.assert_allclose(truth.depth_m, expected, atol=SINGLE_PRECISION_M)
    along_ray = np.linalg.norm(rays / rays[..., 2:], axis=-1)
    assert along_ray.max() > 1.1  # in the corner the two differ by more than a tenth
    np.testing.assert_allclose(truth.normals_in_target[..., 2], 1.0, atol=1e-6)


@pytest.mark.parametrize("camera", [CAMERA, BENT], ids=["straight", "bent"])
def test_each_pixel_is_labelled_with_what_its_centre_sees(camera: Camera) -> None:
    """Two plates, one before the other, and space: all told from the rays alone."""
    near, far = block((0.2, 0.1, 1.0), (0.6, 0.8, 0.02)), block((0.0, 0.0, 0.0), (2.0, 1.6, 0.02))
    craft = Spacecraft(
        "plates", (Part("far", far, LAMBERT), Part("near", near, "mli_gold")), None, np.zeros(3)
    )
    pose = camera_at(np.array([0.1, 0.0, 4.0]))
    truth, names = truth_of(craft, camera, pose)
    rays = pose.inverse().rotate(rays_in_cam(camera).reshape(-1, 3))
    lens = pose.inverse().translation

    def crosses(top_m: float, x: tuple[float, float], y: tuple[float, float]) -> Floats:
        place = lens + rays * ((top_m - lens[2]) / rays[:, 2])[:, None]
        inside = (place[:, 0] > x[0]) & (place[:, 0] < x[1])
        return inside & (place[:, 1] > y[0]) & (place[:, 1] < y[1])

    on_near = crosses(1.01, (-0.1, 0.5), (-0.3, 0.5))
    on_far = crosses(0.01, (-1.0, 1.0), (-0.8, 0.8))
    expected = np.where(on_near, names.index("near"), np.where(on_far, names.index("far"), 0))
    wrong = truth.labels.ravel() != expected
    # A plate's side, 2 cm of it, may show beyond its face by a tenth of a pixel here and there.
    assert wrong.sum() <= 12
    assert set(np.unique(truth.labels)) == {0, names.index("near"), names.index("far")}
    top = (truth.labels.ravel() > 0) & ~wrong & (truth.normals_in_target.reshape(-1, 3)[:, 2] > 0.9)
    depth = truth.depth_m.ravel()[top]
    np.testing.assert_allclose(
        depth, np.where(on_near[top], 4.0 - 1.01, 4.0 - 0.01), atol=SINGLE_PRECISION_M
    )


def test_space_has_no_label_depth_or_normal() -> None:
    truth, _ = truth_of(plate(LAMBERT, 0.5), CAMERA, camera_at(np.array([0.0, 0.0, 4.0])))
    space = truth.labels == 0
    assert 0.5 < space.mean() < 1.0
    assert (truth.depth_m[space] == 0.0).all()
    assert (truth.normals_in_target[space] == 0.0).all()
    lengths = np.linalg.norm(truth.normals_in_target[~space], axis=-1)
    np.testing.assert_allclose(lengths, 1.0, atol=1e-5)


def test_a_spheres_mask_has_the_area_of_its_outline_and_radial_normals() -> None:
    """A ball seen from d has the angular radius asin(r / d): in the middle of the image, a disc."""
    radius, distance = 0.8, 4.0
    ball = Part("ball", trimesh.creation.icosphere(5, radius), LAMBERT, smooth=True)
    craft = Spacecraft("ball", (ball,), None, np.zeros(3))
    truth, _ = truth_of(craft, CAMERA, camera_at(np.array([0.0, 0.0, distance])))
    tangent = np.tan(np.arcsin(radius / distance))
    area = np.pi * (CAMERA.fx * tangent) ** 2
    rim_pixels = 2.0 * np.sqrt(2.0 * np.pi * CAMERA.fx * tangent / 12.0)  # in or out by chance
    assert (truth.labels == 1).sum() == pytest.approx(area, abs=rim_pixels + 0.002 * area)
    on_ball = truth.labels == 1
    pose = camera_at(np.array([0.0, 0.0, distance]))
    rays = rays_in_cam(CAMERA)[on_ball]
    places = pose.inverse() @ (rays / rays[:, 2:] * truth.depth_m[on_ball][:, None])
    np.testing.assert_allclose(np.linalg.norm(places, axis=1), radius, rtol=2e-3)  # facets
    cosines = (truth.normals_in_target[on_ball] * places).sum(axis=1) / radius
    two_degrees = np.cos(np.deg2rad(2.0))  # half a facet
    assert (cosines > two_degrees).all()


# Markers

MARKERS = discs(np.array([[-0.4, 0.0, 0.01], [0.4, 0.0, 0.01]]), 0.05)
SUN_ABOVE = {"above": (0.0, 0.0, 1.0), "aside": (0.8, 0.0, 0.6), "below": (0.0, 0.0, -1.0)}
ABOVE = camera_at(np.array([0.0, 0.0, 4.0]))


def light_on(
    markers: MarkerPattern = MARKERS,
    pose: RigidTransform = ABOVE,
    *blocks: trimesh.Trimesh,
    lamps: LedRing = LAMPS_850,
    camera: Camera = CAMERA,
) -> MarkerLight:
    from renders.tracing.scene import build_geometry
    from renders.truth.pixel_truth import marker_light

    floor = plate(LAMBERT, markers=markers)
    parts = (*floor.parts, *(Part("block", mesh, LAMBERT) for mesh in blocks))
    geometry = build_geometry(
        Spacecraft("floor", parts, markers, np.zeros(3)), None, RetroreflectorOptics()
    )
    return marker_light(geometry.scene(), markers, camera, pose, lamps, SUN_ABOVE)


def test_points_of_a_disc_are_spread_evenly_over_it() -> None:
    from renders.truth.pixel_truth import CLEARANCE_M, disc_points

    tilt = RigidTransform.identity().perturbed([0.7, 0.2, 0.0], np.zeros(3))
    markers = replace(MARKERS, normals_in_target=tilt.rotate(MARKERS.normals_in_target))
    for points, centre, normal in zip(
        disc_points(markers), markers.points_in_target, markers.normals_in_target, strict=True
    ):
        off = points - centre
        np.testing.assert_allclose(off @ normal, CLEARANCE_M)
        in_plane = off - np.outer(off @ normal, normal)
        np.testing.assert_allclose(in_plane.mean(axis=0), 0.0, atol=0.01 * markers.radius_m)
        radii = np.linalg.norm(in_plane, axis=1)
        assert radii.max() <= markers.radius_m
        # Over an even disc the mean of r^2 is half the radius squared.
        assert (radii**2).mean() == pytest.approx(0.5 * markers.radius_m**2, rel=1e-6)


def test_an_open_marker_is_wholly_visible_and_lit() -> None:
    light = light_on()
    np.testing.assert_array_equal(light.visible, 1.0)
    np.testing.assert_array_equal(light.lamp_lit, 1.0)
    np.testing.assert_array_equal(light.sun_lit["above"], 1.0)
    np.testing.assert_array_equal(light.sun_lit["aside"], 1.0)


def test_a_plate_between_camera_and_marker_hides_it() -> None:
    """Halfway to the lens, over #1 alone; the Sun comes from aside and still reaches it."""
    light = light_on(MARKERS, ABOVE, block((-0.2, 0.0, 2.0), (0.2, 0.2, 0.01)))
    np.testing.assert_array_equal(light.visible, [0.0, 1.0])
    np.testing.assert_array_equal(light.lamp_lit, [0.0, 1.0])
    np.testing.assert_array_equal(light.sun_lit["aside"], [1.0, 1.0])


@pytest.mark.parametrize("share", [0.0, 0.25, 0.5, 0.8, 1.0])
def test_a_marker_half_covered_is_half_visible(share: float) -> None:
    """A straight edge just above the face covers a circular segment, a known share of it."""
    radius = MARKERS.radius_m
    cut = np.linspace(-radius, radius, 20_001)
    below = (
        0.5 + (cut / radius * np.sqrt(1 - (cut / radius) ** 2) + np.arcsin(cut / radius)) / np.pi
    )
    edge = float(np.interp(share, below, cut)) if share < 1.0 else radius + 0.01
    edge -= 0.01 if share == 0.0 else 0.0
    cover = block((-0.4 + edge - 0.5, 0.0, 0.02), (1.0, 0.5, 0.01))
    straight_over = camera_at(np.array([-0.4, 0.0, 4.0]))
    light = light_on(MARKERS, straight_over, cover)
    # Seen from 4 m, an edge 2 cm up and at most 5 cm aside shifts by less than 0.3 mm.
    parallax = 0.01
    assert light.visible[0] == pytest.approx(1.0 - share, abs=2.0 * ONE_POINT + parallax)
    assert light.sun_lit["above"][0] == pytest.approx(1.0 - share, abs=2.0 * ONE_POINT)
    assert light.visible[1] == 1.0


def test_a_face_turned_away_gets_nothing() -> None:
    from_behind = light_on()
    np.testing.assert_array_equal(from_behind.sun_lit["below"], 0.0)
    away = replace(MARKERS, normals_in_target=-MARKERS.normals_in_target)
    light = light_on(away)
    for shares in (light.visible, light.lamp_lit, light.sun_lit["above"]):
        np.testing.assert_array_equal(shares, 0.0)


def test_a_block_shades_from_the_sun_and_not_from_the_lamps() -> None:
    """A wall 0.3 m beside #2, towards the Sun aside: its shadow reaches 0.4 m at 37 deg."""
    light = light_on(MARKERS, ABOVE, block((0.75, 0.0, 0.4), (0.02, 0.6, 0.8)))
    np.testing.assert_array_equal(light.sun_lit["aside"], [1.0, 0.0])
    np.testing.assert_array_equal(light.sun_lit["above"], 1.0)
    np.testing.assert_array_equal(light.lamp_lit, 1.0)
    np.testing.assert_array_equal(light.visible, 1.0)


def test_half_the_lamps_hidden_is_half_the_light() -> None:
    """A screen close to the lens, past its middle, hides the LEDs of one side and not the lens."""
    ring = LedRing(850.0, count=8, radius_m=0.04, phase_deg=22.5)
    markers = discs(np.array([[0.0, 0.0, 0.01]]), 0.005)
    screen = block((0.505, 0.0, 3.99), (1.0, 1.0, 0.001))
    light = light_on(markers, ABOVE, screen, lamps=ring)
    np.testing.assert_array_equal(light.visible, 1.0)
    np.testing.assert_allclose(light.lamp_lit, 0.5, atol=ONE_POINT)


def test_what_the_image_does_not_hold_is_not_visible() -> None:
    """A marker on the image's right edge is visible by what is inside; one beyond it not at all."""
    edge_m = 4.0 * (CAMERA.width - 0.5 - CAMERA.cx) / CAMERA.fx
    depth_share = (4.0 - 0.01 - 1e-3) / 4.0
    points = np.array([[edge_m * depth_share, 0.0, 0.01], [edge_m + 0.2, 0.0, 0.01]])
    light = light_on(discs(points, 0.05))
    assert light.visible[0] == pytest.approx(0.5, abs=2.0 * ONE_POINT + 0.01)
    assert light.visible[1] == 0.0
    np.testing.assert_array_equal(light.lamp_lit, 1.0)


def test_a_camera_behind_sees_no_marker() -> None:
    behind = RigidTransform(np.eye(3), np.array([0.0, 0.0, 4.0]))  # below, looking up
    light = light_on(MARKERS, behind)
    np.testing.assert_array_equal(light.visible, 0.0)
    np.testing.assert_array_equal(light.lamp_lit, 0.0)


def test_a_marker_behind_the_camera_has_no_outline() -> None:
    from renders.truth.pixel_truth import outline_centres_px

    behind = discs(np.array([[0.0, 0.0, 0.01], [0.0, 0.0, 6.0]]), 0.05)
    centres = outline_centres_px(behind, CAMERA, ABOVE)
    assert np.isfinite(centres[0]).all()
    assert np.isnan(centres[1]).all()
