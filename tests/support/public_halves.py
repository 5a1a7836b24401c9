"""Small public halves of datasets, of noise: no renderer, no truth, nothing but the files."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from models.arrays import Image
from models.atomic_file import write_bytes, write_text
from models.camera import camera_preset
from models.dataset.description import DatasetInfo, Stream, info_to_json
from models.dataset.frame_table import FrameEntry, frames_to_csv
from models.dataset.image_file import encode_image
from models.dataset.onboard_files import onboard_texts
from models.dataset.sensor_table import table_to_csv
from models.frame import CHASER_ORBIT, IMAGE, IMAGE_800, IMAGE_850, TableReading
from models.motion.relative_state import CHASER_ORBIT_COLUMNS
from models.onboard import FlightExpectations, OnboardKnowledge, PosePrior
from models.pose import RigidTransform, rotation_from_euler_321
from models.sensors.camera_chip import Detector
from models.spacecraft.retroreflector_layout import RETROREFLECTORS
from tests.support.point_targets import telescope_target

WIDTH_PX = 32
ENTRIES = (FrameEntry(0, 0.0, 41.5), FrameEntry(3, 1 / 3, 1e-3 / 7))
CAMERA = replace(camera_preset("chaser_fixed").resized(WIDTH_PX), k1=-0.1)

PAIRS_ON_BOARD = OnboardKnowledge(
    camera=CAMERA,
    detector=replace(Detector(), read_noise_e=1 / 3),
    markers=RETROREFLECTORS,
    prior=PosePrior(
        RigidTransform(rotation_from_euler_321([-179.3, 1.2, 0.4]), np.array([0.1, 0.8, 6.6])),
        sigma_m=np.array([0.017, 0.017, 0.05]),
        sigma_deg=np.array([1.0, 1.0, 1.0]),
    ),
)
PAIRS = DatasetInfo(
    case="maxar-demo",
    sun="S2",
    frames=2,
    target="maxar1300",
    chain="retroreflector_pairs",
    streams=(
        Stream(IMAGE_800, "image", "frames/{index:06d}_800.png", offset_s=-0.033),
        Stream(IMAGE_850, "image", "frames/{index:06d}_850.png"),
    ),
    onboard=tuple(onboard_texts(PAIRS_ON_BOARD)),
    provenance={"rvbench": "0.1.0"},
)

IMAGES_ON_BOARD = OnboardKnowledge(
    camera=CAMERA,
    detector=Detector(),
    wireframe=telescope_target(),
    expectations=FlightExpectations(
        cam_from_lvlh=RigidTransform(
            np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]), np.zeros(3)
        ),
        sigma_px=0.7,
        chaser_sigma_m=10.0,
        chaser_sigma_m_s=0.1,
        range_m=(29.0, 31.0),
        inertia_kg_m2=np.diag([7e3, 1.3e5, 1.2e5]) + np.full((3, 3), 1 / 3),
    ),
)
IMAGES = DatasetInfo(
    case="noise",
    sun="1,0,0",
    frames=2,
    target="telescope",
    chain="tumble_images",
    streams=(
        Stream(IMAGE, "image", "frames/{index:06d}.png"),
        Stream(CHASER_ORBIT, "table", "navigation.csv", CHASER_ORBIT_COLUMNS),
    ),
    onboard=tuple(onboard_texts(IMAGES_ON_BOARD)),
)
ORBIT = {
    entry.index: TableReading(
        CHASER_ORBIT_COLUMNS,
        np.array([entry.time_s]),
        np.array([[7.1e6 / 3 + entry.index, -1 / 3, 0.1, 7500.0 / 7, 1e-17, entry.time_s]]),
    )
    for entry in ENTRIES
}


def noise_image(seed: int) -> Image:
    """Return an image of the camera's size."""
    shape = (CAMERA.height, CAMERA.width)
    return np.random.default_rng(seed).integers(0, 4096, shape).astype(np.uint16)


def write_public_half(folder: Path, info: DatasetInfo, onboard: OnboardKnowledge) -> None:
    """Write the files of a dataset of ``ENTRIES``; each image of each stream is another."""
    texts = {
        "dataset.json": info_to_json(info),
        "frames.csv": frames_to_csv(ENTRIES),
        **onboard_texts(onboard),
    }
    for name, text in texts.items():
        write_text(folder / name, text)
    for number, stream in enumerate(info.image_streams):
        for entry in ENTRIES:
            image = encode_image(noise_image(10 * entry.index + number))
            write_bytes(stream.path(folder, entry.index), image)
    for stream in info.streams:
        if stream.kind == "table":
            write_text(stream.path(folder), table_to_csv(stream.columns, ORBIT.items()))


def write_pairs(folder: Path) -> Path:
    """Write image pairs."""
    write_public_half(folder, PAIRS, PAIRS_ON_BOARD)
    return folder


def write_single_images(folder: Path) -> Path:
    """Write single images with the chaser's orbit."""
    write_public_half(folder, IMAGES, IMAGES_ON_BOARD)
    return folder


def as_version_1(folder: Path, name: str) -> None:
    """Say in ``dataset.json`` what version 1 said: all other files are as they were.

    Parameters
    ----------
    name : str
        ``rvbench-pairs`` or ``rvbench-images``.
    """
    info = {"rvbench-pairs": PAIRS, "rvbench-images": IMAGES}[name]
    table = {
        "format": name,
        "version": 1,
        "case": info.case,
        "sun": info.sun,
        "frames": info.frames,
        "target": info.target,
        "provenance": info.provenance,
    }
    (folder / "dataset.json").write_text(json.dumps(table, indent=2) + "\n")
