"""More samples where markers are, and nowhere else; no pixel of an outline is forgotten."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from models.arrays import Floats, Mask, Radiance
from models.camera import Camera
from models.lights.led_beam import LAMPS_850
from models.markers import MarkerPattern
from models.pose import RigidTransform
from models.spacecraft.retroreflector_optics import RetroreflectorOptics
from renders.tracing.light_groups import NIR850, LampGroup, LightGroup, SunGroup
from tests.support.small_scenes import (
    FACING,
    LAMBERT,
    activate_best,
    camera_at,
    discs,
    needs_jit,
    plate,
)

CAMERA = Camera(96, 80, 400.0, 400.0, 47.5, 39.5)
MARKERS = discs(np.array([[-0.2, 0.1, 0.01], [0.15, -0.1, 0.03], [0.2, 0.2, 0.01]]), 0.0127)
POSE = camera_at(np.array([0.0, 0.0, 2.0]))
LAMPS = LampGroup("lamps", LAMPS_850, NIR850)
SUN = SunGroup("sun", (0.0, -0.6, 0.8))


@pytest.fixture(scope="module", autouse=True)
def _variant() -> None:
    activate_best()


def turned(pose: RigidTransform = POSE) -> RigidTransform:
    turn = RigidTransform(FACING, np.zeros(3)).perturbed([0.3, 0.5, -0.2], np.zeros(3)).rotation
    return RigidTransform(turn, pose.translation)


def cut_by_outline(markers: MarkerPattern, camera: Camera, pose: RigidTransform) -> Mask:
    """Return the pixels that some but not all of 12 x 12 rays see within a disc."""
    steps = (np.arange(12) + 0.5) / 12 - 0.5
    v, u = np.mgrid[0 : camera.height, 0 : camera.width]
    inside = np.zeros((len(markers), 144, u.size), dtype=bool)
    for number, (du, dv) in enumerate(np.stack(np.meshgrid(steps, steps), -1).reshape(-1, 2)):
        rays = camera.rays(np.stack([u + du, v + dv], axis=-1).reshape(-1, 2))
        for marker in range(len(markers)):
            centre = pose @ markers.points_in_target[marker]
            normal = pose.rotate(markers.normals_in_target[marker])
            place = rays * ((centre @ normal) / (rays @ normal))[:, None]
            inside[marker, number] = np.linalg.norm(place - centre, axis=1) < markers.radius_m
    share = inside.mean(axis=1)
    return np.asarray(((share > 0.0) & (share < 1.0)).any(axis=0))


@pytest.mark.parametrize(
    ("camera", "pose"),
    [
        (CAMERA, POSE),
        (CAMERA, turned()),
        (replace(CAMERA, k1=-0.5, fy=380.0), turned()),
        (replace(CAMERA, fx=150.0, fy=150.0), POSE),
    ],
    ids=["facing", "tilted", "bent", "far"],
)
def test_every_pixel_that_an_outline_cuts_gets_the_many_samples(
    camera: Camera, pose: RigidTransform
) -> None:
    from renders.tracing.radiance import marker_pixels, marker_windows

    windows = marker_windows(MARKERS, camera, pose)
    near, edge = marker_pixels(MARKERS, camera, pose, windows)
    cut = np.flatnonzero(cut_by_outline(MARKERS, camera, pose))
    assert len(cut) >= 4 * len(MARKERS)
    assert set(cut) <= set(edge) <= set(near)
    assert len(edge) < 8 * len(cut)  # and not the whole window where discs are large


def test_windows_hold_the_discs_with_room_for_the_point_spread() -> None:
    from renders.tracing.radiance import WINDOW_MARGIN_PX, marker_windows

    roomy = replace(CAMERA, width=300, height=300, cx=149.5, cy=149.5)
    for pose in (POSE, turned()):
        windows = marker_windows(MARKERS, roomy, pose)
        angle = np.linspace(0.0, 2.0 * np.pi, 60)
        rim = MARKERS.radius_m * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
        for (left, top, width, height), point in zip(
            windows, MARKERS.points_in_target, strict=True
        ):
            u, v = roomy.project(pose @ (point + rim)).T
            # Perspective makes a near side larger; a tenth of a pixel is left for it.
            room = WINDOW_MARGIN_PX - 0.1
            assert left <= u.min() - room
            assert u.max() + room <= left + width - 1
            assert top <= v.min() - room
            assert v.max() + room <= top + height - 1


def test_windows_end_at_the_image_and_skip_what_is_outside_or_behind() -> None:
    from renders.tracing.radiance import marker_windows

    edge_m = 2.0 * 47.5 / 400.0
    points = np.array(
        [[edge_m, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 0.0, 5.0], [0.0, 0.0, 2.0], [0.0, 0.0, 0.0]]
    )
    windows = marker_windows(discs(points, 0.0127), CAMERA, POSE)
    assert len(windows) == 2
    for left, top, width, height in windows:
        assert 0 <= left < left + width <= CAMERA.width
        assert 0 <= top < top + height <= CAMERA.height
    assert windows[0][0] + windows[0][2] == CAMERA.width


@cache
def loaded() -> tuple[Any, Any]:
    from renders.tracing.scene import build_geometry

    geometry = build_geometry(plate(LAMBERT, markers=MARKERS), None, RetroreflectorOptics())
    return geometry, geometry.scene()


def images(
    markers: MarkerPattern | None,
    samples: int,
    marker_samples: int,
    seed: int,
    pose: RigidTransform = POSE,
    depth: int = 1,
) -> dict[str, Radiance]:
    from renders.tracing.radiance import Sampling, render_radiance

    geometry, scene = loaded()
    groups: list[LightGroup] = [LAMPS, SUN]
    sampling = Sampling(samples, marker_samples, depth, seed)
    return render_radiance(scene, geometry, CAMERA, pose, groups, markers, sampling)


def in_windows(pose: RigidTransform = POSE) -> Mask:
    from renders.tracing.radiance import marker_windows

    inside = np.zeros((CAMERA.height, CAMERA.width), dtype=bool)
    for left, top, width, height in marker_windows(MARKERS, CAMERA, pose):
        inside[top : top + height, left : left + width] = True
    return inside


def test_outside_the_windows_markers_change_nothing() -> None:
    plain, fine = images(None, 4, 4, seed=3), images(MARKERS, 4, 1024, seed=3)
    for name in plain:
        np.testing.assert_array_equal(plain[name][~in_windows()], fine[name][~in_windows()])
        assert plain[name].shape == (CAMERA.height, CAMERA.width)
        assert plain[name].dtype == np.float32
    assert (plain["lamps"] != fine["lamps"])[in_windows()].any()


def test_an_outline_is_as_quiet_as_its_samples_promise() -> None:
    """Of g x g stratified samples a cut pixel's share scatters by at most ``0.5 / g^1.5``."""
    cut = cut_by_outline(MARKERS, CAMERA, POSE).reshape(CAMERA.height, CAMERA.width)
    quiet: list[Floats] = []
    for marker_samples in (16, 1024):
        first, second = (images(MARKERS, 4, marker_samples, seed)["lamps"] for seed in (3, 4))
        disc = np.percentile(first[in_windows()], 99)
        quiet.append(np.sqrt(0.5 * ((first - second)[cut] ** 2).mean()) / disc)
        # Without a JIT the samples are Mitsuba's own, spread likewise.
        curved_outline = 1.5
        assert 0.0 < quiet[-1] < curved_outline * 0.5 / marker_samples**0.75
    assert quiet[1] < 0.1 * quiet[0]


def test_the_sun_keeps_its_few_samples_only_without_a_jit() -> None:
    """With a JIT every group shares the windows' paths; no second pass, no second noise."""
    needs_jit()
    plain, fine = images(None, 4, 4, seed=3), images(MARKERS, 4, 1024, seed=3)
    assert (plain["sun"] != fine["sun"])[in_windows()].any()


def test_suns_do_not_pay_for_the_samples_of_outlines() -> None:
    needs_jit()
    few, many = (images(MARKERS, 4, samples, seed=3) for samples in (256, 1024))
    np.testing.assert_array_equal(few["sun"], many["sun"])
    assert (few["lamps"] != many["lamps"]).any()


def test_the_same_seed_gives_both_exposures_of_a_pair_the_same_noise() -> None:
    """Sunlight 33 ms later is nearly the same light: with one seed its noise nearly cancels.

    A few pixels that an edge crosses in between do not: over eight seeds they leave 0.06 to 0.08
    of the variance that two seeds leave, over one seed anything from 0 to 0.15.
    """
    needs_jit()
    later = RigidTransform(POSE.rotation, POSE.translation + np.array([0.0, 0.0, -0.0005]))

    def sunlit(seed: int, pose: RigidTransform) -> Radiance:
        return images(None, 4, 4, seed=seed, pose=pose, depth=3)["sun"]

    seeds = range(3, 11)
    common = [np.var(sunlit(seed, POSE) - sunlit(seed, later)) for seed in seeds]
    own = [np.var(sunlit(seed, POSE) - sunlit(seed + 100, POSE)) for seed in seeds]
    a_tenth = 0.1
    assert np.mean(common) < a_tenth * np.mean(own)


def test_markers_that_face_away_need_no_outline() -> None:
    """From behind, windows there may be, but no disc; the frame is rendered all the same."""
    behind = RigidTransform(np.eye(3), np.array([0.0, 0.0, 2.0]))
    assert in_windows(behind).any()
    frame = images(MARKERS, 4, 64, seed=3, pose=behind)
    assert np.isfinite(frame["lamps"]).all()
    assert frame["lamps"].max() < 5.0  # the plate's back, no marker's return


def test_markers_out_of_sight_need_no_windows() -> None:
    away = camera_at(np.array([20.0, 0.0, 2.0]))
    frame = images(MARKERS, 4, 64, seed=3, pose=away)
    assert (frame["lamps"] == 0.0).all()


@pytest.mark.parametrize("markers", [MARKERS, None])
def test_what_shows_nothing_is_dark_and_traced_for_nothing(markers: MarkerPattern | None) -> None:
    """No pixel in view, and no marker in the image: an image all the same."""
    from renders.tracing.radiance import Sampling, render_radiance

    geometry, scene = loaded()
    away = RigidTransform(POSE.rotation, np.array([0.0, 0.0, -5.0]))
    nothing = np.zeros((CAMERA.height, CAMERA.width), dtype=bool)
    sampling = Sampling(samples=4, marker_samples=16, max_depth=2, seed=1)
    images = render_radiance(
        scene, geometry, CAMERA, away, [SUN, LAMPS], markers, sampling, nothing
    )
    assert set(images) == {"sun", "lamps"}
    for image in images.values():
        assert image.shape == (CAMERA.height, CAMERA.width)
        assert image.dtype == np.float32
        assert not image.any()
