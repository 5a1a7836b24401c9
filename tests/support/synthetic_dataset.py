"""A small dataset without any renderer: discs on black, drawn by intersecting rays with them.

The public half and the truth half have the real formats, so that estimating, scoring and
reporting can be tried in seconds and held against a truth known in closed form.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from models.arrays import Floats
from models.camera import Camera, camera_preset
from models.dataset.description import DatasetInfo, Stream, info_to_json
from models.dataset.estimates_file import write_estimates
from models.dataset.frame_table import FrameEntry, frames_to_csv
from models.dataset.image_file import encode_image
from models.dataset.marker_file import markers_to_toml
from models.dataset.onboard_files import onboard_texts
from models.estimate import Detections, Estimate, PoseEstimate
from models.frame import IMAGE_800, IMAGE_850
from models.markers import MarkerPattern
from models.onboard import OnboardKnowledge, PosePrior
from models.pose import RigidTransform, rotation_from_euler_321
from models.sensors.camera_chip import Detector
from models.spacecraft.retroreflector_layout import RETROREFLECTORS
from renders.truth.exposure_truth import ExposureTruth

WIDTH_PX = 512
MARKER_DN = 2000.0
NOISE_DN = 3.0
SUBSAMPLES = 6
PAIR_GAP_S = 0.033
STREAMS = (
    Stream(IMAGE_800, "image", "frames/{index:06d}_800.png", offset_s=-PAIR_GAP_S),
    Stream(IMAGE_850, "image", "frames/{index:06d}_850.png"),
)


@dataclass(frozen=True)
class SyntheticDataset:
    """What was written, and the truth that it was made from."""

    folder: Path
    camera: Camera
    pattern: MarkerPattern
    entries: tuple[FrameEntry, ...]
    truths: tuple[ExposureTruth, ...]
    onboard: OnboardKnowledge

    def image_path(self, index: int, band: int) -> Path:
        """Return where one image of a pair lies."""
        return image_path(self.folder, index, band)


def image_path(folder: Path, index: int, band: int) -> Path:
    """Return where one image of a pair lies; the band is 800 or 850."""
    return STREAMS[(800, 850).index(band)].path(folder, index)


def true_pose(range_m: float, phase: float) -> RigidTransform:
    """Return ``cam_from_target`` with the pattern's middle near the boresight."""
    rotation = rotation_from_euler_321([179.0 + phase, 1.5 - phase, 2.0 * phase])
    aim = RETROREFLECTORS.points_in_target.mean(axis=0)
    return RigidTransform(rotation, np.array([0.0, 0.0, range_m]) - rotation @ aim)


def true_exposure(
    frame: int, band: int, time_s: float, pose: RigidTransform, camera: Camera
) -> ExposureTruth:
    """Return the truth of one exposure in which every marker in the image is whole."""
    pattern = RETROREFLECTORS
    pixels = camera.project(pose @ pattern.points_in_target)
    inside = camera.contains(pixels, margin_px=4.0).astype(np.float64)
    return ExposureTruth(
        frame=frame,
        band=band,
        time_s=time_s,
        cam_from_target=pose,
        sun_dir_in_target=np.array([0.0, 0.0, 1.0]),
        markers_px=pixels,
        marker_outlines_px=pixels,
        visible=inside,
        lamp_lit=np.ones(len(pattern)),
        sun_lit=np.ones(len(pattern)),
    )


def draw_markers(camera: Camera, pattern: MarkerPattern, pose: RigidTransform) -> Floats:
    """Return the share of each pixel that is covered by a disc, (height, width)."""
    image = np.zeros((camera.height, camera.width))
    centres = pose @ pattern.points_in_target
    normals = pose.rotate(pattern.normals_in_target)
    offsets = (np.arange(SUBSAMPLES) + 0.5) / SUBSAMPLES - 0.5
    for centre, normal in zip(centres, normals, strict=True):
        middle = camera.project(centre)
        reach = int(np.ceil(camera.fx * pattern.radius_m / centre[2])) + 2
        if not camera.contains(middle, float(reach + 1)):
            continue
        u0, v0 = (int(x) for x in np.round(middle) - reach)
        axis = np.arange(2 * reach + 1)[:, None] + offsets
        u, v = np.meshgrid(u0 + axis.ravel(), v0 + axis.ravel())
        rays = camera.rays(np.stack([u, v], axis=-1).reshape(-1, 2))
        hits = rays * ((centre @ normal) / (rays @ normal))[:, None]
        disc = np.linalg.norm(hits - centre, axis=1) <= pattern.radius_m
        cells = disc.reshape(2 * reach + 1, SUBSAMPLES, 2 * reach + 1, SUBSAMPLES)
        image[v0 : v0 + 2 * reach + 1, u0 : u0 + 2 * reach + 1] += cells.mean(axis=(1, 3))
    return image


def write_dataset(
    folder: Path,
    frames: int = 6,
    range_m: tuple[float, float] = (3.4, 2.4),
    images: bool = True,
    sun: str = "S2",
    width_px: int = WIDTH_PX,
) -> SyntheticDataset:
    """Write both halves of a dataset whose Sun lights nothing."""
    camera = camera_preset("chaser_fixed").resized(width_px)
    detector, pattern = Detector(), RETROREFLECTORS
    entries = tuple(FrameEntry(k, 10.0 * k, 4.0) for k in range(frames))
    poses = [
        true_pose(float(r), float(0.02 * k))
        for k, r in enumerate(np.linspace(*range_m, frames, dtype=np.float64))
    ]
    onboard = OnboardKnowledge(
        camera=camera,
        detector=detector,
        markers=pattern,
        prior=PosePrior(
            poses[0].perturbed([0.004, -0.003, 0.002], [0.005, -0.004, 0.01]),
            sigma_m=np.array([0.017, 0.017, 0.05]),
            sigma_deg=np.ones(3),
        ),
    )
    known = onboard_texts(onboard)
    info = DatasetInfo(
        case="maxar-demo",
        sun=sun,
        frames=frames,
        target="maxar1300",
        chain="retroreflector_pairs",
        streams=STREAMS,
        onboard=tuple(known),
        provenance={"rvbench": "test"},
    )
    texts = {
        "dataset.json": info_to_json(info),
        "frames.csv": frames_to_csv(entries),
        **known,
    }
    (folder / "truth").mkdir(parents=True)
    (folder / "frames").mkdir()
    for name, text in texts.items():
        (folder / name).write_text(text)
    (folder / "truth" / "parts.json").write_text(json.dumps(["bus"]))
    (folder / "truth" / "markers.toml").write_text(markers_to_toml(pattern))
    truths = [
        true_exposure(e.index, band, e.time_s - (PAIR_GAP_S if band == 800 else 0.0), pose, camera)
        for e, pose in zip(entries, poses, strict=True)
        for band in (800, 850)
    ]
    (folder / "truth" / "exposures.jsonl").write_text(
        "".join(json.dumps(truth.to_json()) + "\n" for truth in truths)
    )
    if images:
        rng = np.random.default_rng(1)
        for truth in truths:
            dark = detector.bias_dn + rng.normal(0.0, NOISE_DN, (camera.height, camera.width))
            lit = draw_markers(camera, pattern, truth.cam_from_target) if truth.band == 850 else 0.0
            image = np.clip(np.rint(dark + MARKER_DN * lit), 0, detector.max_dn).astype(np.uint16)
            image_path(folder, truth.frame, truth.band).write_bytes(encode_image(image))
    return SyntheticDataset(folder, camera, pattern, entries, tuple(truths[1::2]), onboard)


def perfect_estimate(truth: ExposureTruth) -> Estimate:
    """Return an estimate that says the truth, with detections on the markers' centres."""
    seen = np.flatnonzero(truth.visible > 0.0)
    return Estimate(
        frame=truth.frame,
        time_s=truth.time_s,
        pose=PoseEstimate(
            cam_from_target=truth.cam_from_target,
            covariance=np.diag([1e-4] * 3 + [1e-3] * 3) ** 2,
            residual_rms_px=0.0,
        ),
        detections=Detections(
            points_px=truth.markers_px[seen],
            sigma_px=np.full((len(seen), 2), 0.02),
            marker=tuple(int(index) for index in seen),
            used=(True,) * len(seen),
        ),
    )


def lost_estimate(truth: ExposureTruth, reason: str = "2 markers, at least 4 needed") -> Estimate:
    """Return an honest "no pose" without detections."""
    return Estimate(truth.frame, truth.time_s, reason=reason, detections=Detections.none())


def solved_estimate(
    dataset: SyntheticDataset, truth: ExposureTruth, sigma_px: Floats, rng: np.random.Generator
) -> Estimate:
    """Add Gaussian noise to the true centroids and solve with OpenCV, a solver not ours.

    The covariance is that of the linearised problem for the noise given, by OpenCV's Jacobian.
    """
    seen = np.flatnonzero(truth.visible > 0.0)
    points = dataset.pattern.points_in_target[seen]
    pixels = truth.markers_px[seen] + rng.normal(0.0, 1.0, (len(seen), 2)) * sigma_px
    matrix = dataset.camera.matrix
    _, rvec, tvec = cv2.solvePnP(points, pixels, matrix, None, flags=cv2.SOLVEPNP_SQPNP)
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 50, 1e-14)
    rvec, tvec = cv2.solvePnPRefineLM(points, pixels, matrix, None, rvec, tvec, stop)
    pose = RigidTransform(cv2.Rodrigues(rvec)[0], tvec.ravel())
    jacobian = _opencv_jacobian(dataset, points, pose)
    weighted = jacobian / np.tile(sigma_px, len(seen))[:, None]
    return Estimate(
        frame=truth.frame,
        time_s=truth.time_s,
        pose=PoseEstimate(
            cam_from_target=pose,
            covariance=np.linalg.inv(weighted.T @ weighted),
            residual_rms_px=float(sigma_px.mean()),
        ),
        detections=Detections(
            points_px=pixels,
            sigma_px=np.tile(sigma_px, (len(seen), 1)),
            marker=tuple(int(index) for index in seen),
            used=(True,) * len(seen),
        ),
    )


def _opencv_jacobian(dataset: SyntheticDataset, points: Floats, pose: RigidTransform) -> Floats:
    """Return d(pixel)/d(left rotation, translation), (2n, 6), from ``cv2.projectPoints``.

    The points are first turned into camera axes, so that OpenCV's rotation vector is zero and its
    derivative is that of a turn on the left.
    """
    turned = pose.rotate(points)
    jacobian = cv2.projectPoints(
        turned, np.zeros(3), pose.translation, dataset.camera.matrix, None
    )[1]
    return np.asarray(jacobian[:, :6])


def write_variant(
    dataset: SyntheticDataset,
    variant: str,
    make: Callable[[ExposureTruth], Estimate],
    run: int = 0,
) -> None:
    """Write one variant's estimates of every frame."""
    home = dataset.folder if run == 0 else dataset.folder / "seeds" / f"{run:03d}"
    write_estimates(home / "estimates" / f"{variant}.jsonl", map(make, dataset.truths))
