"""What is not traced is dark: the pixels in view hold all that a whole image shows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from models.arrays import Floats
from models.camera import Camera
from models.lights.earth import Earth
from models.pose import RigidTransform
from models.spacecraft.part import Part, Spacecraft
from models.spacecraft.stance import Stance
from renders.scenario.scenario import Scenario
from renders.tracing.silhouette import MARGIN_PX, in_sight, pieces_of, pixels_in_view, sees
from renders.tracing.windows import window_around
from renders.world.build import world_of
from renders.world.world import World
from tests.support.small_scenes import discs, needs_jit
from tests.support.tumble_scenario import tumble_table

ROUNDING_M = 1e-4  # 32 bits: a cropped film counts its pixels from elsewhere; more where aslant
UNIT_ROUNDING = 1e-6
CAMERA = Camera.from_fov(64, 48, 50.0)


def ball_at(*place: float) -> Spacecraft:
    mesh = trimesh.creation.icosphere(subdivisions=2, radius=1.0).apply_translation(place)
    return Spacecraft("ball", (Part("ball", mesh, "white_paint"),), None, np.zeros(3))


def corners(craft: Spacecraft) -> Iterator[Floats]:
    return pieces_of(craft, None, ahead(0.0))


def ahead(range_m: float) -> RigidTransform:
    return RigidTransform(np.eye(3), np.array([0.0, 0.0, range_m]))


def test_a_ball_fills_its_disc_and_a_margin() -> None:
    """A ball of radius 1 at d fills a disc of f tan(asin(1/d)); its mesh is a little smaller."""
    seen = pixels_in_view(corners(ball_at(0.0, 0.0, 0.0)), CAMERA, ahead(10.0))
    assert seen is not None
    v, u = np.mgrid[0:48, 0:64]
    off_px = np.hypot(u - CAMERA.cx, v - CAMERA.cy)
    radius_px = CAMERA.fx * np.tan(np.arcsin(0.1))
    assert seen[off_px <= radius_px].all()
    diagonal_px = np.sqrt(2.0) * (MARGIN_PX + 1.0)
    assert not seen[off_px > radius_px + diagonal_px].any()


def test_where_it_cannot_be_told_all_pixels_are_in_view() -> None:
    ball = ball_at(0.0, 0.0, 0.0)
    assert pixels_in_view(corners(ball), CAMERA, ahead(0.5)) is None  # among the parts
    bent = replace(CAMERA, k1=-0.1)
    assert pixels_in_view(corners(ball), bent, ahead(10.0)) is None


@pytest.mark.parametrize("place", [(0, 0, -3), (9, 0, 0), (-9, 0, 5), (0, 9, 0), (0, -9, 0)])
def test_a_piece_beyond_a_side_of_the_image_or_behind_the_camera_is_left_out(
    place: tuple[float, float, float],
) -> None:
    """However near it is: the camera stands among the parts of its own chaser."""
    seen = pixels_in_view(corners(ball_at(*place)), CAMERA, ahead(0.5))
    assert seen is not None
    assert not seen.any()


@pytest.mark.parametrize("camera", [CAMERA, replace(CAMERA, k1=-0.1, p1=1e-3)])
def test_a_ball_is_in_sight_until_it_is_beyond_a_side_or_behind(camera: Camera) -> None:
    """At 10 m half the image is 10 tan 25 deg wide, a little more through a barrel lens."""
    half_m = 10.0 * np.tan(np.deg2rad(25.0))
    for aside_m, seen in ((0.0, True), (half_m + 0.9, True), (1.2 * half_m + 1.1, False)):
        for sign in (-1.0, 1.0):
            ball = ball_at(sign * aside_m, 0.0, 0.0)
            assert in_sight(corners(ball), camera, ahead(10.0)) is seen
    assert not in_sight(corners(ball_at(0.0, 0.0, 0.0)), camera, ahead(-5.0))
    assert in_sight(corners(ball_at(0.0, 0.0, 0.0)), camera, ahead(0.5))


def test_the_chasers_own_parts_and_the_markers_are_pieces_too() -> None:
    craft = ball_at(0.0, 0.0, 0.0)
    marker = discs(np.array([[3.0, 0.0, 0.0]]), 0.1)
    pieces = pieces_of(replace(craft, markers=marker), ball_at(0.0, 3.0, 10.0), ahead(10.0))
    seen = pixels_in_view(pieces, CAMERA, ahead(10.0))
    assert seen is not None
    for x, y in ((0.0, 0.0), (3.0, 0.0), (0.0, 3.0), (3.0, 3.0)):
        u, v = np.rint(CAMERA.project(np.array([x, y, 10.0]))).astype(int)
        assert seen[v, u] == ((x, y) != (3.0, 3.0))


def test_the_least_window_holds_them_and_no_row_or_column_more() -> None:
    seen = np.zeros((48, 64), dtype=bool)
    assert window_around(seen, CAMERA) == window_around(None, CAMERA) == (0, 0, 64, 48)
    seen[10:20, 30] = seen[15, 25:40] = True
    assert window_around(seen, CAMERA) == (25, 10, 15, 10)


@pytest.mark.parametrize(
    ("towards", "radius_km", "seen"),
    [
        ((0.0, 0.0, 1.0), 42164.0, True),  # whole within the image
        ((0.0, 0.0, 1.0), 6400.0, True),  # behind all of it
        ((0.0, 0.0, -1.0), 42164.0, False),
        ((0.0, 1.0, 0.0), 7143.1, False),  # limb 26.8 deg off the boresight, image to 19.3 deg
        ((0.0, 1.0, 0.0), 6700.0, True),  # limb 17.8 deg off
    ],
)
def test_the_earth_is_seen_where_its_limb_is_in_the_image(
    towards: tuple[float, float, float], radius_km: float, seen: bool
) -> None:
    earth = Earth(towards, (0.0, 0.0, -1.0), radius_km, 0.3, 75.0)
    assert sees(CAMERA, ahead(10.0), earth) == seen


def test_a_frame_is_the_same_to_the_bit_with_all_pixels_traced(tmp_path: Path) -> None:
    """A random number depends on its pixel alone, and what is left out is black."""
    needs_jit()  # without it a tree is built for every group, and windows draw their own samples
    from renders.batches.studio import Studio
    from renders.store.light_keys import LightKeys
    from renders.store.radiance_store import RadianceStore

    class Everything(World):
        """The same world, of which nothing is left out."""

        def silhouette(self, cam_from_target: RigidTransform, stance: Stance) -> None:
            return

    scenario = Scenario.model_validate(tumble_table())
    images, truths = [], []
    plain = world_of(scenario)
    parts = {each.name: getattr(plain, each.name) for each in fields(plain)}
    for world in (plain, Everything(**parts)):
        store = RadianceStore(tmp_path / "none")
        studio = Studio(world, store, LightKeys(world, "jit"), None)
        exposure = world.exposures[1]
        pose = world.trajectory.cam_from_target(exposure.time_s)
        images.append(studio.trace(exposure, pose, world.groups(exposure)))
        truths.append(studio.pixel_truth(exposure, pose))
    few, every = images
    assert few.keys() == every.keys()
    for name, image in few.items():
        np.testing.assert_array_equal(image, every[name])
    assert max(float(image.max()) for image in few.values()) > 0.0
    np.testing.assert_array_equal(truths[0].labels, truths[1].labels)
    np.testing.assert_allclose(truths[0].depth_m, truths[1].depth_m, atol=ROUNDING_M)
    np.testing.assert_allclose(
        truths[0].normals_in_target, truths[1].normals_in_target, atol=UNIT_ROUNDING
    )
    assert 0.005 < (truths[0].labels > 0).mean() < 0.3
