"""The public half of a dataset folder: what a flight computer gets. Truth lies elsewhere.

::

    DIR/dataset.json          format, version, case, Sun, number of frames
        camera.toml           the camera as calibrated
        detector.toml         the detector as calibrated
        markers.toml          the target's markers as surveyed
        prior.toml            the first pose as drawn, with its sigmas
        frames.csv            index, time_s, exposure_ms
        frames/000000_800.png, 000000_850.png      12-bit DN in 16-bit files
        truth/                behind the wall: see ``renders.truth.exposure_truth``
        estimates/            what the pipelines said: see ``models.dataset.estimates_file``
"""

from __future__ import annotations

import csv
import json
import tomllib
from collections.abc import Iterator
from dataclasses import asdict, dataclass, fields
from itertools import pairwise
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import tomli_w

from models.arrays import Floats, Image
from models.camera import Camera
from models.errors import DatasetError, cause
from models.frame import FlightKnowledge, Frame, MarkerPattern
from models.pose import RigidTransform, euler_321_from_rotation, rotation_from_euler_321
from models.sensors.camera_chip import Detector

FORMAT = "rvbench-pairs"
VERSION = 1
FARTHEST_PRIOR_M = 1e6
FILTERED = 0  # the band of a single image: all that the camera's filter passes, and no lamps
DIVISORS = ("pixel_pitch_um", "quantum_efficiency", "full_well_e", "gain_e_dn")


@dataclass(frozen=True)
class DatasetInfo:
    """What ``dataset.json`` says.

    Attributes
    ----------
    case : str
    sun : str
        Name of the Sun direction, or the vector as typed.
    frames : int
        Number of image pairs when complete.
    target : str
    provenance : dict
        Versions and hashes; nothing that tells a pose.
    format : str
        ``rvbench-pairs``, or ``rvbench-images``: see ``models.dataset.image_dataset``.
    """

    case: str
    sun: str
    frames: int
    target: str
    provenance: dict[str, str]
    format: str = FORMAT


@dataclass(frozen=True)
class FrameEntry:
    """One row of ``frames.csv``."""

    index: int
    time_s: float
    exposure_ms: float


def exposure_name(index: int, band: int) -> str:
    """Return how the files of one exposure are named; ``band`` is 800, 850 or ``FILTERED``."""
    return f"{index:06d}" if band == FILTERED else f"{index:06d}_{band}"


def image_path(folder: Path, index: int, band: int) -> Path:
    """Return where the image of one exposure lies; ``band`` is 800, 850 or ``FILTERED``."""
    return folder / "frames" / f"{exposure_name(index, band)}.png"


def encode_image(image: Image) -> bytes:
    """Return a uint16 image as PNG."""
    ok, data = cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 1])
    if not ok:
        raise DatasetError(f"expected to encode an image of shape {image.shape}, OpenCV refused")
    return bytes(data.tobytes())


def read_image(path: Path) -> Image:
    """Read one 16-bit image.

    Raises
    ------
    DatasetError
        If the file is missing, truncated, or not a 16-bit single-channel PNG.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise DatasetError(
            f"expected an image at {path}, got: {cause(error)}; "
            "render again: only what is missing is rendered"
        ) from error
    whole = data.startswith(b"\x89PNG") and data.rstrip(b"\0").endswith(b"IEND\xaeB`\x82")
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED) if whole else None
    if image is None:
        raise DatasetError(
            f"expected a whole PNG at {path}, got {len(data)} bytes that are not; "
            "delete it and render again: only what is missing is rendered"
        )
    if image.ndim != 2 or image.dtype != np.uint16:
        raise DatasetError(
            f"expected a 16-bit single-channel image at {path}, "
            f"got shape {image.shape} of {image.dtype}; "
            "image pairs of other kinds are read by `rvbench estimate --frames`"
        )
    return np.asarray(image)


def read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file of a dataset.

    Raises
    ------
    DatasetError
        If it is missing or no TOML.
    """
    try:
        return tomllib.loads(path.read_text())
    except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise DatasetError(f"expected a TOML file at {path}, got: {cause(error)}") from error


def _read_info_table(folder: Path) -> dict[str, Any]:
    try:
        table = json.loads((folder / "dataset.json").read_text())
    except (OSError, ValueError) as error:
        raise DatasetError(
            f"expected a dataset in {folder}, with a dataset.json; got: {cause(error)}; "
            "`rvbench render` makes one"
        ) from error
    return table if isinstance(table, dict) else {}


def read_format(folder: Path) -> str:
    """Return the format that ``dataset.json`` names; empty if it names none.

    Raises
    ------
    DatasetError
        If there is no such file, or it is no JSON.
    """
    return str(_read_info_table(folder).get("format", ""))


def read_info(folder: Path, expected_format: str = FORMAT) -> DatasetInfo:
    """Read ``dataset.json`` and refuse another format or version."""
    path, table = folder / "dataset.json", _read_info_table(folder)
    if table.get("format") != expected_format:
        raise DatasetError(
            f"{path}: expected format {expected_format!r}, got {table.get('format', 'none')!r}; "
            "is it ours?"
        )
    if table.get("version") != VERSION:
        raise DatasetError(
            f"{path}: expected version {VERSION}, got {table.get('version')!r}; "
            "render it again, or read it with the rvbench that wrote it"
        )
    expected = {"case": str, "sun": str, "frames": int, "target": str, "provenance": dict}
    for key, kind in expected.items():
        if not isinstance(table.get(key), kind) or isinstance(table[key], bool):
            raise DatasetError(
                f"{path}: expected {key} as {kind.__name__}, got {table.get(key, 'none')!r}"
            )
    return DatasetInfo(**{key: table[key] for key in expected}, format=expected_format)


def info_to_json(info: DatasetInfo) -> str:
    """Return the text of ``dataset.json``."""
    told = {"format": info.format, "version": VERSION}
    return json.dumps({**told, **asdict(info), **told}, indent=2) + "\n"


def detector_to_toml(detector: Detector) -> str:
    """Return the text of ``detector.toml``."""
    return tomli_w.dumps(asdict(detector))


def read_detector(path: Path) -> Detector:
    """Read ``detector.toml``; every key must be there."""
    table = read_toml(path)
    known = {field.name for field in fields(Detector)}
    unknown, missing = sorted(set(table) - known), sorted(known - set(table))
    if unknown or missing:
        raise DatasetError(
            f"{path}: expected the detector keys {', '.join(sorted(known))}; "
            f"unknown: {', '.join(unknown) or 'none'}; missing: {', '.join(missing) or 'none'}"
        )
    for key, value in table.items():
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value < np.inf:
            raise DatasetError(f"{path}: expected a number from zero up for {key}, got {value!r}")
        if key in DIVISORS and value == 0:
            raise DatasetError(f"{path}: expected {key} above zero, got {value!r}")
    if table["bits"] not in range(1, 17):
        raise DatasetError(f"{path}: expected bits as 1 to 16, got {table['bits']!r}")
    return Detector(**{**table, "bits": int(table["bits"])})


def markers_to_toml(markers: MarkerPattern) -> str:
    """Return the text of ``markers.toml``."""
    rows = zip(
        markers.names,
        markers.points_in_target.tolist(),
        markers.normals_in_target.tolist(),
        strict=True,
    )
    return tomli_w.dumps(
        {
            "radius_m": markers.radius_m,
            "marker": [
                {"name": name, "point_in_target_m": point, "normal_in_target": normal}
                for name, point, normal in rows
            ],
        }
    )


def read_markers(path: Path) -> MarkerPattern:
    """Read ``markers.toml``."""
    table = read_toml(path)
    try:
        rows = table["marker"]
        return MarkerPattern(
            names=tuple(str(row["name"]) for row in rows),
            points_in_target=np.array([row["point_in_target_m"] for row in rows], float),
            normals_in_target=np.array([row["normal_in_target"] for row in rows], float),
            radius_m=float(table["radius_m"]),
        )
    except (KeyError, ValueError, TypeError) as error:
        raise DatasetError(
            f"{path}: expected radius_m and [[marker]] tables with name, point_in_target_m and "
            f"normal_in_target; got: {cause(error)}"
        ) from error


def prior_to_toml(knowledge: FlightKnowledge) -> str:
    """Return the text of ``prior.toml``."""
    return tomli_w.dumps(
        {
            "t_cam_from_target_m": knowledge.prior.translation.tolist(),
            "euler_321_deg": euler_321_from_rotation(knowledge.prior.rotation).tolist(),
            "sigma_t_m": knowledge.prior_sigma_m.tolist(),
            "sigma_euler_deg": knowledge.prior_sigma_deg.tolist(),
        }
    )


def read_prior(path: Path) -> tuple[RigidTransform, Floats, Floats]:
    """Read ``prior.toml``: the pose ``cam_from_target``, and its sigmas in m and in deg."""
    table = read_toml(path)
    try:
        prior = RigidTransform(
            rotation_from_euler_321(table["euler_321_deg"]),
            np.array(table["t_cam_from_target_m"], float),
        )
        sigma_m = np.array(table["sigma_t_m"], float).reshape(3)
        sigma_deg = np.array(table["sigma_euler_deg"], float).reshape(3)
        sigmas = np.concatenate([sigma_m, sigma_deg])
        if not (np.isfinite(sigmas) & (sigmas >= 0.0)).all():
            raise ValueError(f"sigmas {sigmas.tolist()}")
    except (KeyError, ValueError, TypeError) as error:
        raise DatasetError(
            f"{path}: expected t_cam_from_target_m, euler_321_deg, sigma_t_m and "
            f"sigma_euler_deg, three numbers each; got: {cause(error)}"
        ) from error
    ahead_m = float(prior.translation[2])
    if not 0.0 < ahead_m < FARTHEST_PRIOR_M:
        raise DatasetError(
            f"{path}: expected a target in front of the camera, the third number of "
            f"t_cam_from_target_m above 0 and below {FARTHEST_PRIOR_M:g} m, got {ahead_m:g}"
        )
    return prior, sigma_m, sigma_deg


def read_knowledge(folder: Path) -> FlightKnowledge:
    """Read everything that is loaded on board before the first frame."""
    prior, sigma_m, sigma_deg = read_prior(folder / "prior.toml")
    return FlightKnowledge(
        camera=Camera.from_toml(folder / "camera.toml"),
        detector=read_detector(folder / "detector.toml"),
        markers=read_markers(folder / "markers.toml"),
        prior=prior,
        prior_sigma_m=sigma_m,
        prior_sigma_deg=sigma_deg,
    )


def frames_to_csv(entries: list[FrameEntry]) -> str:
    """Return the text of ``frames.csv``."""
    rows = "".join(
        f"{int(entry.index)},{float(entry.time_s)!r},{float(entry.exposure_ms)!r}\n"
        for entry in entries
    )
    return "index,time_s,exposure_ms\n" + rows


def read_frame_entries(folder: Path) -> list[FrameEntry]:
    """Read ``frames.csv``, in order of time.

    Raises
    ------
    DatasetError
        If the file is missing, a column or number is missing or not finite, an exposure is not
        positive, or indices or times do not rise.
    """
    path = folder / "frames.csv"
    try:
        with path.open(newline="") as file:
            entries = [
                FrameEntry(int(row["index"]), float(row["time_s"]), float(row["exposure_ms"]))
                for row in csv.DictReader(file)
            ]
    except (OSError, KeyError, ValueError, TypeError, csv.Error) as error:
        raise DatasetError(
            f"expected {path} with the columns index, time_s, exposure_ms; got: {cause(error)}"
        ) from error
    for entry in entries:
        if not np.isfinite(entry.time_s) or not 0.0 < entry.exposure_ms < np.inf:
            raise DatasetError(f"{path}: expected a finite time and a positive exposure: {entry}")
    for before, after in pairwise(entries):
        if after.index <= before.index or after.time_s <= before.time_s:
            raise DatasetError(f"{path}: expected rising indices and times, got {before}, {after}")
    return entries


def read_frame(folder: Path, entry: FrameEntry) -> Frame:
    """Read one image pair."""
    return Frame(
        index=entry.index,
        time_s=entry.time_s,
        image_800=read_image(image_path(folder, entry.index, 800)),
        image_850=read_image(image_path(folder, entry.index, 850)),
        exposure_ms=entry.exposure_ms,
    )


def read_frames(folder: Path) -> Iterator[Frame]:
    """Read all image pairs, in order, one at a time."""
    for entry in read_frame_entries(folder):
        yield read_frame(folder, entry)
