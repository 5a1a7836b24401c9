"""Raw Bayer images of white dots on a black board, drawn finely and averaged: no renderer.

Each pixel is divided into ``FINE`` by ``FINE``; the ray through each part meets the board's plane or
a dot's, which says what is there and whether it is lit. A Gaussian in the fine image is the lens.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import cv2
import numpy as np

from models.arrays import Floats, Image
from models.camera import Camera, camera_preset
from models.markers import MarkerPattern
from models.pose import RigidTransform
from models.sensors.bayer_mosaic import mosaicked
from models.sensors.camera_chip import Detector
from models.spacecraft.grasp_markers import BOARD_M, CENTRE_M, GRASP_MARKERS

FINE = 8
CAMERA = camera_preset("eye_in_hand")
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
    noisy: bool = True
    seed: int = 1
    hidden: tuple[int, ...] = field(default=())

    def but(self, **changes: object) -> DotScene:
        return replace(self, **changes)  # type: ignore[arg-type]


def facing(range_m: float, turn_deg: Floats | list[float], shift_m: tuple[float, float] = (0, 0)) -> RigidTransform:
    """Return a pose that looks at the board's middle, turned and shifted a little."""
    cam = RigidTransform(FACING, -FACING @ np.array([CENTRE_M[0], CENTRE_M[1], range_m]))
    return cam.perturbed(np.zeros(3), np.array([*shift_m, 0.0])) if not np.any(turn_deg) else (
        _turned_about_board(cam, np.deg2rad(turn_deg), shift_m)
    )


def _turned_about_board(
    cam: RigidTransform, turn: Floats, shift_m: tuple[float, float]
) -> RigidTransform:
    middle = np.array([*CENTRE_M, 0.0])
    there = cam @ middle
    turned = RigidTransform(cam.perturbed(turn, np.zeros(3)).rotation, np.zeros(3))
    return RigidTransform(turned.rotation, there - turned.rotation @ middle + np.array([*shift_m, 0.0]))


def raw_image(scene: DotScene) -> Image:
    """Draw a scene, (height, width) uint16, DN."""
    albedo = _albedo(scene)
    planes = [
        white * np.clip(albedo[..., colour], 0.0, None) for colour, white in enumerate(WHITE_DN)
    ]
    mean_dn = mosaicked(planes)
    level = mean_dn + scene.detector.bias_dn
    if scene.noisy:
        rng = np.random.default_rng(scene.seed)
        level = level + scene.detector.noise_dn(level) * rng.standard_normal(level.shape)
    return np.clip(np.rint(level), 0, scene.detector.saturation_dn).astype(np.uint16)


def _albedo(scene: DotScene) -> Floats:
    """Return what each pixel sees of three colours, lens and all, (height, width, 3)."""
    camera = scene.camera
    image = np.empty((camera.height, camera.width, 3))
    corners = _board_corners()
    pixels = camera.project(scene.pose @ corners)
    low = np.clip(np.floor(pixels.min(axis=0)) - 6, 0, [camera.width, camera.height]).astype(int)
    high = np.clip(np.ceil(pixels.max(axis=0)) + 7, 0, [camera.width, camera.height]).astype(int)
    image[:] = np.array(AROUND) * float(scene.lit(np.zeros((1, 3)) + [0.0, 0.4, -0.1])[0])
    windows = [(low, high)]
    step = 96
    for left in range(low[0], high[0], step):
        for top in range(low[1], high[1], step):
            box = (
                np.array([left, top]),
                np.minimum([left + step, top + step], [high[0], high[1]]),
            )
            image[box[0][1] : box[1][1], box[0][0] : box[1][0]] = _window(scene, *box)
    del windows
    return image


def _window(scene: DotScene, low: Floats, high: Floats) -> Floats:
    """Draw one window finely, with a rim for the blur."""
    rim = int(np.ceil(4.0 * scene.blur_px)) + 1
    u = np.arange((low[0] - rim) * FINE, (high[0] + rim) * FINE) / FINE + 0.5 / FINE - 0.5
    v = np.arange((low[1] - rim) * FINE, (high[1] + rim) * FINE) / FINE + 0.5 / FINE - 0.5
    grid = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    rays = scene.camera.rays(grid) @ scene.pose.rotation
    eye = scene.pose.inverse().translation
    seen = _seen(scene, eye, rays).reshape(len(v), len(u), 3)
    if scene.blur_px > 0.0:
        seen = cv2.GaussianBlur(seen, (0, 0), FINE * scene.blur_px, borderType=cv2.BORDER_REPLICATE)
    height, width = len(v) // FINE, len(u) // FINE
    mean = seen.reshape(height, FINE, width, FINE, 3).mean(axis=(1, 3))
    return mean[rim:-rim, rim:-rim]


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
