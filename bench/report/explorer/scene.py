"""What a page's scene holds: the target, and where camera and Sun were, by frame."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

import numpy as np

from bench.pictures.frame_record import FrameRecord, FrameRecords
from bench.report.explorer.glb import Surface, glb_bytes
from bench.report.scene_addition import OrbitScene, SceneAddition
from models.arrays import Floats
from models.onboard import OnboardKnowledge
from models.pose import RigidTransform

MESHES = Path(__file__).parent / "meshes"
WIREFRAME_SHADE = (0.5, 0.5, 0.5)
CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def scene_data(
    records: FrameRecords, true: list[FrameRecord], addition: SceneAddition
) -> dict[str, Any] | None:
    """Return what does not change with the pipeline; None where no pose is known at all.

    Parameters
    ----------
    records : FrameRecords
    true : list of FrameRecord
        Every frame, for its truth.
    addition : SceneAddition
        What the chain adds.
    """
    onboard = records.onboard
    if onboard.camera is None:
        return None
    markers, wireframe = onboard.markers, onboard.wireframe
    corners = CORNERS * [onboard.camera.width, onboard.camera.height] - 0.5
    suns = [getattr(record.truth, "sun_dir_in_target", None) for record in true]
    return {
        "glb": _mesh(records.dataset.info.target, onboard),
        "edges": [] if wireframe is None else _plain(wireframe.points_in_target[wireframe.edges]),
        "markers": [] if markers is None else _plain(markers.points_in_target),
        "marker_names": [] if markers is None else list(markers.names),
        "corner_rays_in_cam": _plain(onboard.camera.rays(corners)),
        "true": [pose_numbers(record.true_pose) for record in true],
        "sun_in_target": [None if sun is None else _plain(sun) for sun in suns],
        "clouds": {label: _plain(points, 4) for label, points in addition.clouds.items()},
    }


def orbit_data(orbit: OrbitScene) -> dict[str, Any]:
    """Return an orbit as plain numbers, m to the millimetre; senders to the kilometre.

    Parameters
    ----------
    orbit : OrbitScene
    """
    return {
        "true_m": [_maybe(place, 3) for place in orbit.true_m],
        "said_m": {
            label: [_maybe(place, 3) for place in own] for label, own in orbit.said_m.items()
        },
        "senders_m": [_maybe(places, -3) for places in orbit.senders_m],
    }


def turned(pose: RigidTransform | None, true_from_own: Floats | None) -> RigidTransform | None:
    """Return a pose of the target's true axes, of one of a pipeline's own.

    Parameters
    ----------
    pose : RigidTransform or None
        ``cam_from_target``.
    true_from_own : (3, 3) array or None
        Both axes are one unless given.
    """
    if pose is None or true_from_own is None:
        return pose
    return RigidTransform(pose.rotation @ true_from_own.T, pose.translation)


def pose_numbers(cam_from_target: RigidTransform | None) -> list[float] | None:
    """Return a pose as nine numbers of its rotation, row by row, and three of its translation, m.

    Parameters
    ----------
    cam_from_target : RigidTransform or None
    """
    if cam_from_target is None:
        return None
    return [
        *cam_from_target.rotation.round(9).ravel().tolist(),
        *cam_from_target.translation.round(7).tolist(),
    ]


def _mesh(target: str, onboard: OnboardKnowledge) -> str:
    """Return the target as GLB in base64: our own by name, or the wireframe's; else empty."""
    own = {path.stem: path for path in MESHES.glob("*.glb")}
    if target in own:
        return base64.b64encode(own[target].read_bytes()).decode()
    wireframe = onboard.wireframe
    if wireframe is None or not len(wireframe.triangles_in_target):
        return ""
    vertices = wireframe.triangles_in_target.reshape(-1, 3)
    faces = np.arange(len(vertices)).reshape(-1, 3)
    surface = Surface(wireframe.name, vertices, faces, WIREFRAME_SHADE)
    return base64.b64encode(glb_bytes([surface])).decode()


def _plain(numbers: Any, places: int = 7) -> Any:
    return np.asarray(numbers, dtype=np.float64).round(places).tolist()


def _maybe(numbers: Floats | None, places: int) -> Any:
    return None if numbers is None else _plain(numbers, places)
