"""A small dataset of single images without any renderer: noise, and a truth that tumbles.

Both halves have the real formats. The pictures show a wireframe's faces in flat grey, painted from
behind to before, so that corners and edges are where they should be.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from models.arrays import Image
from models.atomic_file import write_bytes, write_text
from models.camera import Camera, camera_preset
from models.dataset.description import DatasetInfo, Stream, info_to_json
from models.dataset.frame_table import FrameEntry, frames_to_csv
from models.dataset.image_file import encode_image
from models.dataset.onboard_files import onboard_texts
from models.dataset.sensor_table import table_to_csv
from models.frame import CHASER_ORBIT, IMAGE
from models.motion.chaser_navigation import corrupted
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.relative_state import CHASER_ORBIT_COLUMNS
from models.motion.tumble import CAM_FROM_LVLH, Tumble
from models.onboard import FlightExpectations, OnboardKnowledge
from models.pose import RigidTransform
from models.sensors.camera_chip import Detector
from models.spacecraft.wireframes import wireframe_by_name
from models.wireframe.visibility import visible_landmarks
from models.wireframe.wireframe import Wireframe
from pipelines.uncooperative.knowledge import UncooperativeKnowledge
from renders.truth.image_truth import ImageTruth
from tests.support.tumble_scenario import TUMBLE

WIDTH_PX = 512
STREAMS = (
    Stream(IMAGE, "image", "frames/{index:06d}.png"),
    Stream(CHASER_ORBIT, "table", "navigation.csv", CHASER_ORBIT_COLUMNS),
)
SUN_IN_LVLH = np.array([0.3, -0.62, 0.72])


@dataclass(frozen=True, eq=False)
class SyntheticImages:
    """What was written, and the truth that it was made from."""

    folder: Path
    onboard: OnboardKnowledge
    entries: tuple[FrameEntry, ...]
    truths: tuple[ImageTruth, ...]
    tumble: Tumble

    @property
    def knowledge(self) -> UncooperativeKnowledge:
        """What the pipeline takes of what is on board."""
        return UncooperativeKnowledge.of(self.onboard)


def image_path(folder: Path, index: int) -> Path:
    """Return where an image lies."""
    return STREAMS[0].path(folder, index)


def small_tumble(duration_s: float) -> Tumble:
    """Return the motion of the small scenario."""
    return Tumble.from_case(
        KeplerOrbit.from_elements_deg(**TUMBLE["orbit"]),
        rho0_m=TUMBLE["rho0_m"],
        rho_dot0_m_s=TUMBLE["rho_dot0_m_s"],
        omega_t0_deg_s=TUMBLE["omega0_deg_s"],
        inertia_kg_m2=TUMBLE["inertia_kg_m2"],
        duration_s=duration_s,
    )


def painted(target: Wireframe, camera: Camera, cam_from_target: RigidTransform, seed: int) -> Image:
    """Return an image of a wireframe's faces, lit by how they face the Sun, and noise."""
    detector = Detector()
    signal = np.zeros((camera.height, camera.width), dtype=np.float32)
    corners = cam_from_target @ target.triangles_in_target.reshape(-1, 3)
    faces = corners.reshape(-1, 3, 3)
    normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    sun_in_cam = CAM_FROM_LVLH.rotate(SUN_IN_LVLH)
    for number in np.argsort(-faces[:, :, 2].mean(axis=1)):
        level = 400.0 + 1500.0 * abs(float(normals[number] @ sun_in_cam))
        pixels = np.rint(16.0 * camera.project(faces[number])).astype(np.int32)
        cv2.fillConvexPoly(signal, pixels, level, cv2.LINE_AA, 4)
    rng = np.random.default_rng([seed, 7])
    noisy = detector.bias_dn + signal + 2.0 * rng.standard_normal(signal.shape)
    return np.clip(np.rint(noisy), 0, detector.max_dn).astype(np.uint16)


def write_images(
    folder: Path,
    frames: int = 4,
    step_s: float = 3.0,
    start_s: float = 0.0,
    target_name: str = "xmm",
    width_px: int = WIDTH_PX,
) -> SyntheticImages:
    """Write both halves of a dataset."""
    camera = camera_preset("chaser_fixed").resized(width_px)
    target, tumble = wireframe_by_name(target_name), small_tumble(start_s + frames * step_s)
    onboard = OnboardKnowledge(
        camera=camera,
        detector=Detector(),
        wireframe=target,
        expectations=FlightExpectations(
            cam_from_lvlh=CAM_FROM_LVLH,
            sigma_px=0.7,
            chaser_sigma_m=10.0,
            chaser_sigma_m_s=0.1,
            range_m=(29.0, 31.0),
            inertia_kg_m2=tumble.inertia_kg_m2,
        ),
    )
    known = onboard_texts(onboard)
    entries = tuple(FrameEntry(k, start_s + step_s * k, 4.0) for k in range(frames))
    info = DatasetInfo(
        case="painted",
        sun="1,0,0",
        frames=frames,
        target=target_name,
        chain="tumble_images",
        streams=STREAMS,
        onboard=tuple(known),
    )
    orbit = [
        (e.index, corrupted(tumble.chaser_state(e.time_s), seed=1, run=0, frame=e.index).reading())
        for e in entries
    ]
    truths = tuple(true_image(target, camera, tumble, entry) for entry in entries)
    texts = {
        "dataset.json": info_to_json(info),
        "frames.csv": frames_to_csv(entries),
        "navigation.csv": table_to_csv(CHASER_ORBIT_COLUMNS, orbit),
        "truth/exposures.jsonl": "".join(json.dumps(t.to_json()) + "\n" for t in truths),
        **known,
    }
    for name, text in texts.items():
        write_text(folder / name, text)
    for truth in truths:
        image = painted(target, camera, truth.cam_from_target, truth.frame)
        write_bytes(image_path(folder, truth.frame), encode_image(image))
    return SyntheticImages(folder, onboard, entries, truths, tumble)


def true_image(target: Wireframe, camera: Camera, tumble: Tumble, entry: FrameEntry) -> ImageTruth:
    """Return the truth of one image."""
    state = tumble.state(entry.time_s)
    pose = state.cam_from_target(CAM_FROM_LVLH)
    target_from_lvlh = state.R_lvlh_from_target.T
    return ImageTruth(
        frame=entry.index,
        time_s=entry.time_s,
        cam_from_target=pose,
        state=state,
        chaser=tumble.chaser_state(entry.time_s),
        sun_dir_in_target=target_from_lvlh @ SUN_IN_LVLH / np.linalg.norm(SUN_IN_LVLH),
        earth_dir_in_target=target_from_lvlh @ np.array([-1.0, 0.0, 0.0]),
        landmarks_px=camera.project(pose @ target.points_in_target),
        landmarks_visible=visible_landmarks(target, pose),
    )
