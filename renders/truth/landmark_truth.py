"""Where the landmarks of a wireframe truly are in an image, and which of them the lens sees."""

from __future__ import annotations

from typing import Any

import numpy as np

from models.arrays import Floats, Mask
from models.camera import Camera
from models.pose import RigidTransform
from models.wireframe.wireframe import Wireframe
from renders.truth.image_truth import ImageTruth
from renders.truth.pixel_truth import unoccluded
from renders.truth.posed_truth import PosedTruth
from renders.world.exposure import Exposure
from renders.world.trajectory import FreeMotion
from renders.world.world import World

CLEARANCE_M = 0.03  # towards the lens: what a wireframe leaves out, such as a blanket's thickness


def image_truth(
    scene: Any,
    world: World,
    exposure: Exposure,
    cam_from_target: RigidTransform,
    *,
    motion: FreeMotion,
    wireframe: Wireframe | None,
) -> ImageTruth:
    """Return the sealed record of an image.

    Parameters
    ----------
    scene : mitsuba.Scene
        As it was for the exposure.
    world : World
    exposure : Exposure
    cam_from_target : RigidTransform
    motion : FreeMotion
        Of the target and the chaser.
    wireframe : Wireframe or None
        Whose landmarks are looked for.
    """
    towards_earth, _ = world.earth_at(exposure.time_s)
    towards_sun = world.sun_at(world.sun, exposure.time_s).direction_in_target
    landmarks_px, visible = _landmarks(scene, wireframe, world.camera, cam_from_target)
    return ImageTruth(
        frame=exposure.frame,
        time_s=exposure.time_s,
        cam_from_target=cam_from_target,
        state=motion.state(exposure.time_s),
        chaser=motion.chaser_state(exposure.time_s),
        sun_dir_in_target=np.array(towards_sun),
        earth_dir_in_target=towards_earth,
        landmarks_px=landmarks_px,
        landmarks_visible=visible,
        sunlit_share=world.sunlit_share(exposure.time_s),
    )


def posed_truth(
    scene: Any,
    world: World,
    exposure: Exposure,
    cam_from_target: RigidTransform,
    wireframe: Wireframe | None,
) -> PosedTruth:
    """Return the sealed record of an image at a given pose.

    Parameters
    ----------
    scene : mitsuba.Scene
        As it was for the exposure.
    world : World
    exposure : Exposure
    cam_from_target : RigidTransform
    wireframe : Wireframe or None
        None where the target has none: the record then has no landmarks.
    """
    towards_sun = world.sun_at(world.sun, exposure.time_s).direction_in_target
    landmarks_px, visible = _landmarks(scene, wireframe, world.camera, cam_from_target)
    return PosedTruth(
        frame=exposure.frame,
        time_s=exposure.time_s,
        cam_from_target=cam_from_target,
        sun_dir_in_target=np.array(towards_sun),
        landmarks_px=landmarks_px,
        landmarks_visible=visible,
    )


def _landmarks(
    scene: Any, wireframe: Wireframe | None, camera: Camera, cam_from_target: RigidTransform
) -> tuple[Floats, Mask]:
    if wireframe is None:
        return np.empty((0, 2)), np.empty(0, dtype=np.bool_)
    landmarks_px = camera.project(cam_from_target @ wireframe.points_in_target)
    return landmarks_px, seen_landmarks(scene, wireframe, camera, cam_from_target)


def seen_landmarks(
    scene: Any, wireframe: Wireframe, camera: Camera, cam_from_target: RigidTransform
) -> Mask:
    """Tell which landmarks the image holds with nothing of the whole mesh before them.

    Parameters
    ----------
    scene : mitsuba.Scene
    wireframe : Wireframe
        Of m landmarks.
    camera : Camera
    cam_from_target : RigidTransform

    Returns
    -------
    (m,) array of bool
    """
    in_cam = cam_from_target @ wireframe.points_in_target
    ahead = in_cam[:, 2] > CLEARANCE_M
    seen = ahead & camera.contains(np.nan_to_num(camera.project(in_cam), nan=-1e9))
    lens = cam_from_target.inverse().translation
    ways = lens - wireframe.points_in_target[seen]
    starts = wireframe.points_in_target[seen] + CLEARANCE_M * ways / np.linalg.norm(
        ways, axis=1, keepdims=True
    )
    seen[seen] = unoccluded(scene, starts, np.broadcast_to(lens, starts.shape)) if len(ways) else []
    return np.asarray(seen)
