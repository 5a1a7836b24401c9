"""A cube with a texture on every face, drawn by homographies: every pixel's place is known."""

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from models.camera import Camera
from models.pose import RigidTransform

CAMERA = Camera(320, 320, 500.0, 500.0, 159.5, 159.5)
HALF_M, TEXTURE_PX = 1.0, 160
SKY_DN, NOISE_DN = 200.0, 15.0
# Of each face: outward normal, then the directions of its texture's columns and rows.
FACES = [
    (np.eye(3)[k] * sign, np.eye(3)[(k + 1) % 3], np.eye(3)[(k + 2) % 3] * sign)
    for k in range(3)
    for sign in (1.0, -1.0)
]


def textures(seed=0):
    rng = np.random.default_rng(seed)
    found = []
    for _ in FACES:
        rough = cv2.GaussianBlur(rng.standard_normal((TEXTURE_PX, TEXTURE_PX)), (0, 0), 2.5)
        found.append((9000.0 + 5000.0 * rough / rough.std()).clip(1500.0, 30000.0))
    return found


def pose_at(frame, deg_per_frame=2.0, distance_m=8.0):
    axis = np.array([0.3, 1.0, 0.2]) / np.linalg.norm([0.3, 1.0, 0.2])
    turn = Rotation.from_rotvec(np.deg2rad(deg_per_frame * frame) * axis)
    tilt = Rotation.from_rotvec([0.5, 0.4, 0.1])
    return RigidTransform((turn * tilt).as_matrix(), np.array([0.0, 0.0, distance_m]))


def drawn(cam_from_target, faces, seed):
    """Return the image, uint16."""
    image = np.full((CAMERA.height, CAMERA.width), SKY_DN, dtype=np.float32)
    for (normal, right, down), texture in zip(FACES, faces, strict=True):
        if not faces_camera(cam_from_target, normal):
            continue
        corners = [
            HALF_M * (normal + a * right + b * down)
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))
        ]
        seen = CAMERA.project(cam_from_target @ np.array(corners)).astype(np.float32)
        last = TEXTURE_PX - 1.0
        square = np.array([[0, 0], [last, 0], [last, last], [0, last]], dtype=np.float32)
        warp = cv2.getPerspectiveTransform(square, seen)
        size = (CAMERA.width, CAMERA.height)
        face = cv2.warpPerspective(texture.astype(np.float32), warp, size, flags=cv2.INTER_CUBIC)
        there = cv2.warpPerspective(np.ones_like(texture, dtype=np.float32), warp, size)
        image = np.where(there > 0.5, face, image)
    noise = NOISE_DN * np.random.default_rng(seed).standard_normal(image.shape)
    return (image + noise).clip(0.0, 65535.0).astype(np.uint16)


def faces_camera(cam_from_target, normal):
    middle = cam_from_target @ (HALF_M * normal)
    return float((cam_from_target.rotation @ normal) @ middle) < 0.0


def place_of(cam_from_target, point_px):
    """Return where on the cube a pixel looks, (3,) m; NaN beside it."""
    ray = cam_from_target.rotation.T @ CAMERA.rays(np.array([point_px]))[0]
    eye = -cam_from_target.rotation.T @ cam_from_target.translation
    with np.errstate(divide="ignore"):
        one, other = (-HALF_M - eye) / ray, (HALF_M - eye) / ray
    enters, leaves = np.minimum(one, other).max(), np.maximum(one, other).min()
    return eye + enters * ray if enters < leaves else np.full(3, np.nan)


def is_seen(cam_from_target, place):
    """Tell whether a place on the cube faces the camera."""
    normal = np.round(place / HALF_M * 0.5001) * (np.abs(place) > 0.999 * HALF_M)
    return faces_camera(cam_from_target, normal / np.linalg.norm(normal))
