"""A dataset of a textured cube that nobody has a model of: images, ranges, and both halves."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from models.atomic_file import write_bytes, write_text
from models.camera import Camera
from models.dataset.description import DatasetInfo, Stream, info_to_json
from models.dataset.frame_table import FrameEntry, frames_to_csv
from models.dataset.image_file import encode_image
from models.dataset.onboard_files import onboard_texts
from models.dataset.sensor_table import table_to_csv
from models.frame import CHASER_ORBIT, IMAGE, RANGE, Frame, ImageReading, TableReading
from models.motion.kepler_orbit import KeplerOrbit
from models.motion.relative_state import CHASER_ORBIT_COLUMNS
from models.motion.tumble import CAM_FROM_LVLH, Tumble
from models.onboard import FlightExpectations, OnboardKnowledge
from models.sensors.camera_chip import Detector
from models.sensors.range_finder import RANGE_COLUMNS
from renders.truth.image_truth import ImageTruth
from renders.truth.range_truth import RANGE_TRUTH, RangeTruth, range_truth_text
from tests.support.textured_cube import CAMERA, HALF_M, drawn, place_of, textures

ORBIT = KeplerOrbit.from_elements_deg(
    a_km=7000.0, e=0.0, i_deg=98.0, raan_deg=0.0, argument_of_perigee_deg=0.0, true_anomaly_deg=0.0
)
RATE_DEG_S = 0.8, 1.5, 0.6
DISTANCE_M, RANGE_SIGMA_M = 8.0, 0.01
SKY_DN = 200
DETECTOR = Detector(bits=16, full_well_e=2e6, gain_e_dn=26.0)


def camera() -> Camera:
    """Return the camera that draws the cube."""
    return CAMERA


def motion(duration_s: float, rate_deg_s: tuple[float, float, float] = RATE_DEG_S) -> Tumble:
    """Return the cube's tumble: 1.8 deg/s about an axis askew, unless told another."""
    return Tumble(
        ORBIT,
        np.array([0.1, DISTANCE_M, -0.1]),
        np.zeros(3),
        np.deg2rad(rate_deg_s),
        np.diag([1.0, 1.1, 1.3]),
        duration_s,
    )


def knowledge() -> OnboardKnowledge:
    """Return what is on board: nothing of the cube."""
    expected = FlightExpectations(cam_from_lvlh=CAM_FROM_LVLH, sigma_px=0.5)
    return OnboardKnowledge(camera=CAMERA, detector=DETECTOR, expectations=expected)


def true_image(tumble: Tumble, frame: int, time_s: float) -> ImageTruth:
    """Return the truth of one frame."""
    state = tumble.state(time_s)
    return ImageTruth(
        frame, time_s, state.cam_from_target(CAM_FROM_LVLH), state, tumble.chaser_state(time_s),
        np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), np.zeros((0, 2)),
        np.zeros(0, dtype=bool),
    )  # fmt: skip


def range_truth(truth: ImageTruth) -> RangeTruth:
    """Return what the boresight meets of the cube."""
    pose = truth.cam_from_target
    met = float(np.linalg.norm(pose @ place_of(pose, np.array([CAMERA.cx, CAMERA.cy]))))
    return RangeTruth(met, float(np.linalg.norm(pose.translation)), 1.0)


def frames(
    count: int,
    dark: tuple[int, int] = (0, 0),
    rate_deg_s: tuple[float, float, float] = RATE_DEG_S,
) -> list[tuple[Frame, ImageTruth]]:
    """Return frames at 1 Hz with their truth; those from ``dark[0]`` to before ``dark[1]`` black.

    Parameters
    ----------
    count : int
    dark : (int, int)
    rate_deg_s : (float, float, float), deg/s
    """
    tumble, faces, rng = motion(float(count), rate_deg_s), textures(), np.random.default_rng(5)
    found = []
    for index in range(count):
        truth = true_image(tumble, index, float(index))
        image = drawn(truth.cam_from_target, faces, index)
        if dark[0] <= index < dark[1]:
            image = np.full_like(image, SKY_DN)
        read = range_truth(truth).surface_m + RANGE_SIGMA_M * rng.standard_normal()
        row = TableReading(
            RANGE_COLUMNS, np.array([truth.time_s]), np.array([[read, RANGE_SIGMA_M]])
        )
        readings = {
            IMAGE: ImageReading(image, truth.time_s, 4.0),
            CHASER_ORBIT: truth.chaser.reading(),
            RANGE: row,
        }
        found.append((Frame(index, truth.time_s, readings), truth))
    return found


def write_cube(
    folder: Path, count: int, rate_deg_s: tuple[float, float, float] = RATE_DEG_S
) -> list[ImageTruth]:
    """Write a dataset of the cube, both halves; return its truth."""
    made, known = frames(count, rate_deg_s=rate_deg_s), onboard_texts(knowledge())
    entries = [FrameEntry(frame.index, frame.time_s, 4.0) for frame, _ in made]
    streams = (
        Stream(IMAGE, "image", "frames/{index:06d}.png"),
        Stream(CHASER_ORBIT, "table", "navigation.csv", CHASER_ORBIT_COLUMNS),
        Stream(RANGE, "table", "range.csv", RANGE_COLUMNS),
    )
    info = DatasetInfo("cube", "1,0,0", count, "cube", "unknown_images", streams, tuple(known))
    rows = {
        name: [(frame.index, frame.table(name)) for frame, _ in made]
        for name in (CHASER_ORBIT, RANGE)
    }
    truths = [truth for _, truth in made]
    texts = {
        "dataset.json": info_to_json(info),
        "frames.csv": frames_to_csv(entries),
        "navigation.csv": table_to_csv(CHASER_ORBIT_COLUMNS, rows[CHASER_ORBIT]),
        "range.csv": table_to_csv(RANGE_COLUMNS, rows[RANGE]),
        "truth/exposures.jsonl": "".join(json.dumps(t.to_json()) + "\n" for t in truths),
        RANGE_TRUTH: range_truth_text((t.frame, range_truth(t)) for t in truths),
        **known,
    }
    for name, text in texts.items():
        write_text(folder / name, text)
    for frame, _ in made:
        path = streams[0].path(folder, frame.index)
        write_bytes(path, encode_image(frame.image(IMAGE).image))
    return truths


def off_the_cube_m(points: np.ndarray) -> np.ndarray:
    """Return how far (n, 3) points are from the cube's surface, m."""
    beyond = np.abs(points) - HALF_M
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
    return np.where((beyond <= 0.0).all(axis=1), -beyond.max(axis=1), outside)


def off_the_moved_cube_m(points: np.ndarray, by_m: float) -> np.ndarray:
    """Return the least of the distances, (n,) m, with the cube moved by up to ``by_m`` an axis.

    The shape is told apart from where the centre is: the move is that of the nearest median.
    """
    steps_m = np.linspace(-by_m, by_m, 9)
    moves = np.stack(np.meshgrid(steps_m, steps_m, steps_m), axis=-1).reshape(-1, 3)
    return min((off_the_cube_m(points + by) for by in moves), key=lambda off: float(np.median(off)))
