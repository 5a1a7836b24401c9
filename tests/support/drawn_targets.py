"""A small target drawn exactly: flat faces under one Sun, area-sampled, with a detector's noise.

Independent of the code under test: every pixel is the mean of 16 rays, each met with every face.
"""

from __future__ import annotations

import numpy as np

from models.arrays import Floats, Image
from models.camera import Camera
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector
from models.wireframe.wireframe import Wireframe

CAMERA = Camera.from_fov(256, 256, 40.0)
DETECTOR = Detector(pixel_pitch_um=13.5)
FINE = 4  # rays to a side of a pixel
SUNLIT_DN, EARTHLIT_DN = 2400.0, 120.0


def _box(low: tuple[float, ...], high: tuple[float, ...]) -> tuple[Floats, list[list[int]]]:
    corners = np.array([[(low, high)[i >> k & 1][k] for k in range(3)] for i in range(8)])
    faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    return corners, faces


def target() -> Wireframe:
    """Return a box with a block on top and one long plate: no symmetry at all."""
    points, edges, faces = [], [], []
    for low, high in (
        ((-1.0, -0.7, -0.8), (1.0, 0.7, 0.8)),
        ((0.1, -0.3, 0.8), (0.9, 0.6, 1.6)),
        ((-0.4, 0.9, -0.03), (0.5, 3.4, 0.03)),
    ):
        corners, quads = _box(low, high)
        first = len(points)
        points.extend(corners)
        pairs = [(a, b) for a in range(8) for b in range(a) if (a ^ b).bit_count() == 1]
        edges.extend((first + a, first + b) for a, b in pairs)
        for a, b, c, d in quads:
            faces.extend(
                [[corners[a], corners[b], corners[c]], [corners[a], corners[c], corners[d]]]
            )
    return Wireframe(
        name="drawn",
        landmark_names=tuple(f"corner_{k}" for k in range(len(points))),
        points_in_target=np.array(points),
        appendage=np.arange(len(points)) >= 16,
        edges=np.array(edges),
        triangles_in_target=np.array(faces),
    )


def mean_dn(
    wireframe: Wireframe,
    pose: RigidTransform,
    camera: Camera,
    sun_in_cam: Floats,
    unlit: float,
    reflects: Floats | None = None,
) -> Floats:
    """Return the drawing without noise, (height, width) DN; ``unlit`` is what no Sun gives.

    Faces are alike, unless it is told what each ``reflects``, (f,).
    """
    v, u = (np.mgrid[0 : FINE * camera.height, 0 : FINE * camera.width] + 0.5) / FINE - 0.5
    rays = np.stack([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, np.ones_like(u)], -1)
    nearest = np.full(u.shape, np.inf)
    level = np.zeros(u.shape)
    shares = np.ones(len(wireframe.triangles_in_target)) if reflects is None else reflects
    for (a, b, c), share in zip(pose_faces(wireframe, pose), shares, strict=True):
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal) * -np.sign(normal @ a)
        shade = unlit + share * SUNLIT_DN * max(float(normal @ sun_in_cam), 0.0)
        corners = np.array([a, b, c])
        px = corners[:, :2] / corners[:, 2:] * [camera.fx, camera.fy] + [camera.cx, camera.cy]
        low = np.maximum(np.floor((px.min(axis=0) - 1) * FINE).astype(int), 0)
        high = np.maximum(np.ceil((px.max(axis=0) + 2) * FINE).astype(int), 0)
        part = np.s_[low[1] : high[1], low[0] : high[0]]
        ray = rays[part]
        sides = np.stack([ray @ np.cross(b, c), ray @ np.cross(c, a), ray @ np.cross(a, b)])
        inside = (sides >= 0.0).all(axis=0) | (sides <= 0.0).all(axis=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = np.where(inside, (a @ normal) / (ray @ normal), np.inf)
        nearer = inside & (depth < nearest[part])
        nearest[part] = np.where(nearer, depth, nearest[part])
        level[part] = np.where(nearer, shade, level[part])
    shape = (camera.height, FINE, camera.width, FINE)
    return level.reshape(shape).mean(axis=(1, 3))


def pose_faces(wireframe: Wireframe, pose: RigidTransform) -> Floats:
    """Return the faces in the camera's axes, (f, 3, 3) m."""
    corners = pose @ wireframe.triangles_in_target.reshape(-1, 3)
    return np.asarray(corners.reshape(-1, 3, 3))


def drawn(
    wireframe: Wireframe,
    pose: RigidTransform,
    camera: Camera = CAMERA,
    sun_in_cam: tuple[float, float, float] = (-0.55, -0.35, -0.76),
    seed: int = 0,
    unlit_dn: float = EARTHLIT_DN,
    reflects: Floats | None = None,
) -> Image:
    """Return a frame, (height, width) uint16 DN, with shot and read noise."""
    mean = mean_dn(wireframe, pose, camera, np.array(sun_in_cam), unlit_dn, reflects)
    rng = np.random.default_rng([46, seed])
    charge = rng.poisson(mean * DETECTOR.gain_e_dn) + rng.normal(
        0.0, DETECTOR.read_noise_e, mean.shape
    )
    level = np.rint(charge / DETECTOR.gain_e_dn + DETECTOR.bias_dn)
    return np.clip(level, 0, DETECTOR.max_dn).astype(np.uint16)
