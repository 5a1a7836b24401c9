"""A tube without a point on it: its outlines tell where a beam meets it, and how far off it is."""

from dataclasses import dataclass

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.camera import Camera
from pipelines.detection.target_region import find_target
from pipelines.unknown_target.silhouettes import Silhouettes, silhouette

CAMERA = Camera(width=300, height=300, fx=400.0, fy=400.0, cx=149.5, cy=149.5)
RADIUS_M, HALF_M, AWAY_M = 1.0, 2.0, 20.0
PIXEL_M = AWAY_M / CAMERA.fx
VIEWS = 40
EDGE_PX = 0.6  # 0.2 and 0.5 were measured; a narrower rule cuts what is dim beside what is bright
FINER = 8  # times, at which outlines are drawn


@dataclass(frozen=True)
class Views:
    """As much of ``Placed`` as silhouettes look at."""

    R_cam_from_target: np.ndarray
    t_cam_from_target: np.ndarray


def views(turn_deg: float = 360.0, count: int = VIEWS) -> Views:
    """Return a body that turns about an axis beside its own, the camera a little off its middle."""
    angles = np.deg2rad(turn_deg) * np.arange(count) / count
    axis = np.array([0.9, 0.3, 0.3]) / np.linalg.norm([0.9, 0.3, 0.3])
    turns = Rotation.from_rotvec(angles[:, None] * axis).as_matrix()
    return Views(turns, np.tile([0.1, -0.2, AWAY_M], (count, 1)))


def outlined(seen: Views) -> Silhouettes:
    """Return the outlines of a cylinder about its body's z axis: of a convex body, a hull."""
    around = np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False)
    rim = np.column_stack([RADIUS_M * np.cos(around), RADIUS_M * np.sin(around), 0.0 * around])
    ends = np.concatenate(
        [rim + end for end in HALF_M * np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])]
    )
    found = Silhouettes(CAMERA)
    size = FINER * CAMERA.height, FINER * CAMERA.width
    for place, (turn, origin) in enumerate(
        zip(seen.R_cam_from_target, seen.t_cam_from_target, strict=True)
    ):
        pixels = FINER * (CAMERA.project(ends @ turn.T + origin) + 0.5) - 0.5
        corners = cv2.convexHull(np.round(pixels).astype(np.int32))
        drawn = cv2.fillConvexPoly(np.zeros(size, np.uint8), corners, 1)
        found.add(place, drawn[FINER // 2 :: FINER, FINER // 2 :: FINER] > 0)
    return found


def met_m(seen: Views) -> np.ndarray:
    """Return where boresights meet that cylinder, m: closed form; NaN where they miss."""
    met = []
    for turn, origin in zip(seen.R_cam_from_target, seen.t_cam_from_target, strict=True):
        eye, beam = -turn.T @ origin, turn[2]
        a, b = beam[:2] @ beam[:2], eye[:2] @ beam[:2]
        inside = b**2 - a * (eye[:2] @ eye[:2] - RADIUS_M**2)
        sides = (-b - np.sqrt(inside)) / a if inside > 0.0 else np.nan
        caps = [(end * HALF_M - eye[2]) / beam[2] for end in (-1.0, 1.0)]
        found = [sides] if abs(eye[2] + sides * beam[2]) < HALF_M else []
        found += [cap for cap in caps if np.linalg.norm(eye[:2] + cap * beam[:2]) < RADIUS_M]
        met.append(min(found, default=np.nan))
    return np.array(met)


@pytest.fixture(scope="module")
def round_it():
    seen = views()
    return seen, outlined(seen)


def test_beams_meet_the_tube_where_it_is(round_it):
    """Within half a pixel in most, and never behind the surface by more than one."""
    seen, outlines = round_it
    error = outlines.entries(seen, seen, 3.0) - met_m(seen)
    assert np.isfinite(error).all()
    assert np.median(np.abs(error)) < 0.5 * PIXEL_M
    assert error.max() < PIXEL_M
    assert error.min() > -5.0 * PIXEL_M  # a hull of few views has corners


def test_the_hull_grows_with_the_distance_that_is_thought_of(round_it):
    """So a range is a share of the distance, and tells it whatever was thought before."""
    seen, outlines = round_it
    farther = Views(seen.R_cam_from_target, 1.05 * seen.t_cam_from_target)
    near, far = outlines.entries(seen, seen, 3.0), outlines.entries(farther, farther, 3.15)
    np.testing.assert_allclose(far / near, 1.05, atol=1e-3)


def test_nothing_is_told_before_the_views_go_round():
    seen = views(80.0)
    assert np.isnan(outlined(seen).entries(seen, seen, 3.0)).all()


def test_few_outlines_tell_nothing():
    seen = views(360.0, 12)
    assert np.isnan(outlined(seen).entries(seen, seen, 3.0)).all()


def test_an_outline_in_a_hundred_that_lacks_a_part_carves_nothing():
    seen = views(360.0, 100)
    outlines = outlined(seen)
    torn = Silhouettes(CAMERA, list(outlines.frames), list(outlines.packed))
    torn.packed[7] = np.zeros_like(torn.packed[7])
    whole, mended = (each.entries(seen, seen, 3.0) for each in (outlines, torn))
    assert np.median(np.abs(whole - mended)) < 2.0 * PIXEL_M


@pytest.mark.parametrize("level_dn", [600.0, 3000.0])
def test_a_bright_edge_is_no_wider_than_a_dim_one(level_dn):
    """A disc blurred by 0.6 px: its outline has its area to the edge's tolerance."""
    rows, columns = np.mgrid[:200, :200]
    disc = np.clip(60.5 - np.hypot(rows - 100.0, columns - 99.0), 0.0, 1.0)
    noise = np.random.default_rng(3).normal(0.0, 4.0, disc.shape)
    image = 200.0 + level_dn * cv2.GaussianBlur(disc, (0, 0), 0.6) + noise
    region = find_target(np.clip(image, 0, 65535).astype(np.uint16))
    radius = np.sqrt(silhouette(region).sum() / np.pi)
    assert abs(radius - 60.0) < EDGE_PX
