"""Raw Bayer images of white dots on a black board, drawn finely and averaged: no renderer.

Each pixel near a dot is divided into ``FINE`` by ``FINE``, elsewhere into ``coarse``; the ray
through each part meets the board's plane or a dot's, which says what is there and whether it is
lit. A Gaussian in the fine image is the lens.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import cv2
import numpy as np

from models.arrays import Floats, Image, Indices
from models.camera import Camera, camera_preset
from models.markers import MarkerPattern
from models.pose import RigidTransform
from models.sensors.bayer_mosaic import mosaicked
from models.sensors.camera_chip import Detector
from models.spacecraft.grasp_markers import BOARD_M, CENTRE_M, GRASP_MARKERS

FINE = 6
CAMERA = camera_preset("eye_in_hand").resized(1024)
DETECTOR = Detector(mosaic="rggb")
FACING = np.diag([1.0, -1.0, -1.0])
WHITE_DN = (2900.0, 2200.0, 1700.0)  # red, green, blue of a dot in full light, above the bias
BOARD, AROUND = 0.05, (0.35, 0.25, 0.08)  # over white; what lies round the board is amber

Lit = Callable[[Floats], Floats]


def in_full_light(points: Floats) -> Floats:
    """Light every point, (n, 3) m in the target frame, alike."""
    return np.ones(len(points))


@dataclass(frozen=True, eq=False)
class DotScene:
    """What is drawn."""

    pose: RigidTransform
    camera: Camera = CAMERA
    detector: Detector = DETECTOR
    markers: MarkerPattern = GRASP_MARKERS
    blur_px: float = 0.5
    lit: Lit = in_full_light
    hidden: tuple[int, ...] = ()
    coarse: int = 1

    def but(self, **changes: object) -> DotScene:
        return replace(self, **changes)  # type: ignore[arg-type]


def facing(
    range_m: float, turn_deg: list[float], shift_m: tuple[float, float] = (0.0, 0.0)
) -> RigidTransform:
    """Return a pose that looks at the board's middle, turned about it and shifted across."""
    middle = np.array([*CENTRE_M, 0.0])
    there = np.array([*shift_m, range_m])
    turn = RigidTransform(FACING, np.zeros(3)).perturbed(np.deg2rad(turn_deg), np.zeros(3))
    return RigidTransform(turn.rotation, there - turn.rotation @ middle)


def mean_image(scene: DotScene) -> Floats:
    """Draw a scene without noise, (height, width), DN."""
    albedo = _albedo(scene)
    planes = [white * albedo[..., colour] for colour, white in enumerate(WHITE_DN)]
    return mosaicked(planes) + scene.detector.bias_dn


def with_noise(mean_dn: Floats, detector: Detector, seed: int) -> Image:
    """Expose a drawn scene once, (height, width) uint16, DN."""
    rng = np.random.default_rng(seed)
    level = mean_dn + detector.noise_dn(mean_dn) * rng.standard_normal(mean_dn.shape)
    return np.clip(np.rint(level), 0, detector.saturation_dn).astype(np.uint16)


def raw_image(scene: DotScene, seed: int = 1) -> Image:
    """Draw a scene and expose it, (height, width) uint16, DN."""
    return with_noise(mean_image(scene), scene.detector, seed)


def shadow_from(direction: tuple[float, float], through: tuple[float, float]) -> Lit:
    """Return a light that a straight shadow cuts: dark on the side that ``direction`` points to."""

    def lit(points: Floats) -> Floats:
        along = (points[:, :2] - through) @ np.array(direction)
        return np.where(along > 0.0, 0.03, 1.0)

    return lit


def _albedo(scene: DotScene) -> Floats:
    """Return what each pixel sees of three colours, lens and all, (height, width, 3)."""
    camera, size = scene.camera, np.array([scene.camera.width, scene.camera.height])
    around = np.array(AROUND) * float(scene.lit(np.array([[0.0, 0.4, -0.1]]))[0])
    image = np.tile(around, (camera.height, camera.width, 1))
    board = camera.project(scene.pose @ _board_corners())
    boxes = [(board.min(axis=0) - 6.0, board.max(axis=0) + 7.0, scene.coarse)]
    in_cam = scene.pose @ scene.markers.points_in_target
    reach = scene.markers.radius_m * camera.fx / in_cam[:, 2] + 5.0 + 3.0 * scene.blur_px
    for centre, half in zip(camera.project(in_cam), reach, strict=True):
        boxes.append((centre - half, centre + half, FINE))
    for corner, far, fine in boxes:
        low = np.clip(np.floor(corner), 0, size).astype(int)
        high = np.clip(np.ceil(far), 0, size).astype(int)
        if (high > low).all():
            image[low[1] : high[1], low[0] : high[0]] = _window(scene, low, high, fine)
    return image


def _window(scene: DotScene, low: Indices, high: Indices, fine: int) -> Floats:
    """Draw one window finely, with a rim for the blur."""
    rim = int(np.ceil(4.0 * scene.blur_px)) + 1
    u, v = (
        np.arange((low[axis] - rim) * fine, (high[axis] + rim) * fine) / fine + 0.5 / fine - 0.5
        for axis in (0, 1)
    )
    rays = scene.camera.rays(np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2))
    seen = _seen(scene, scene.pose.inverse().translation, rays @ scene.pose.rotation)
    seen = seen.reshape(len(v), len(u), 3)
    if scene.blur_px > 0.0:
        seen = cv2.GaussianBlur(seen, (0, 0), fine * scene.blur_px, borderType=cv2.BORDER_REPLICATE)
    mean = seen.reshape(len(v) // fine, fine, len(u) // fine, fine, 3).mean(axis=(1, 3))
    return np.asarray(mean[rim:-rim, rim:-rim])


def _seen(scene: DotScene, eye: Floats, rays: Floats) -> Floats:
    colours = np.tile(np.array(AROUND), (len(rays), 1))
    place = eye + rays * ((-0.0005 - eye[2]) / rays[:, 2])[:, None]
    half = 0.5 * np.array(BOARD_M[:2])
    on_board = (np.abs(place[:, :2] - CENTRE_M) <= half).all(axis=1)
    colours[on_board] = BOARD
    light = scene.lit(place)
    for index, (point, normal) in enumerate(
        zip(scene.markers.points_in_target, scene.markers.normals_in_target, strict=True)
    ):
        if index in scene.hidden:
            continue
        reach = ((point - eye) @ normal) / (rays @ normal)
        met = eye + rays * reach[:, None]
        inside = np.linalg.norm(met - point, axis=1) <= scene.markers.radius_m
        colours[inside] = 1.0
        light = np.where(inside, scene.lit(met), light)
    return colours * light[:, None]


def _board_corners() -> Floats:
    half = 0.5 * np.array(BOARD_M[:2])
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    flat = np.array(CENTRE_M) + signs * half
    return np.column_stack([flat, np.zeros(4)])
