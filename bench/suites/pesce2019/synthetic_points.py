"""Corners as Pesce et al. 2019, section V.A.2, simulate them: projected, shaken, mixed with others.

All landmarks of the target are projected, those behind its back too: the paper has no occlusion.
Outliers fall uniformly into "the region of the image plane occupied by the target", which is taken
as the rectangle about the projected landmarks.

Each kind of draw has a generator of its own, keyed by seed, run and frame: another noise level or
another number of outliers leaves all other draws as they are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.camera import Camera
from models.frame import Frame
from models.motion.chaser_navigation import corrupted
from models.motion.tumble import CAM_FROM_LVLH, Tumble
from models.pose import RigidTransform
from models.wireframe.wireframe import Wireframe
from pipelines.uncooperative.knowledge import points_frame

NOISE_DRAW, OUTLIER_DRAW, ORDER_DRAW = 0x901E, 0x0071, 0x04DE


@dataclass(frozen=True)
class PointNoise:
    """What image processing is taken to add.

    Attributes
    ----------
    sigma_px : float, px
        1 sigma of a corner, per axis.
    outliers : int
    """

    sigma_px: float
    outliers: int


def points_of(
    target: Wireframe,
    camera: Camera,
    cam_from_target: RigidTransform,
    noise: PointNoise,
    key: tuple[int, int, int],
) -> Floats:
    """Return the corners of one image, in no order.

    Parameters
    ----------
    target : Wireframe
    camera : Camera
    cam_from_target : RigidTransform
        The true pose.
    noise : PointNoise
    key : (int, int, int)
        Seed, run and frame.

    Returns
    -------
    (n, 2) array, px
        Those within the image.
    """
    seed, run, frame = key
    true_px = camera.project(cam_from_target @ target.points_in_target)
    shaken = np.random.default_rng([seed, run, NOISE_DRAW, frame]).standard_normal(true_px.shape)
    lows, highs = true_px.min(axis=0), true_px.max(axis=0)
    outlier_draw = np.random.default_rng([seed, run, OUTLIER_DRAW, frame])
    outliers = outlier_draw.uniform(lows, highs, (noise.outliers, 2))
    points = np.concatenate([true_px + noise.sigma_px * shaken, outliers])
    order = np.random.default_rng([seed, run, ORDER_DRAW, frame]).permutation(len(points))
    mixed = points[order]
    return np.asarray(mixed[camera.contains(mixed)], dtype=np.float64)


def point_frame(
    tumble: Tumble,
    target: Wireframe,
    camera: Camera,
    noise: PointNoise,
    time_s: float,
    key: tuple[int, int, int],
) -> Frame:
    """Return what the pipeline gets of one moment: corners, and the chaser's orbit as navigated.

    Parameters
    ----------
    tumble : Tumble
    target : Wireframe
    camera : Camera
    noise : PointNoise
    time_s : float, s
    key : (int, int, int)
        (seed, run, frame).
    """
    seed, run, frame = key
    return points_frame(
        index=frame,
        time_s=time_s,
        points_px=points_of(
            target, camera, tumble.cam_from_target(time_s, CAM_FROM_LVLH), noise, key
        ),
        chaser=corrupted(tumble.chaser_state(time_s), seed=seed, run=run, frame=frame),
    )
