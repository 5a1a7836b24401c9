"""The public half of a dataset of single images, for a target that carries no markers.

::

    DIR/dataset.json          format rvbench-images, version, case, Sun, number of frames
        camera.toml           the camera as calibrated
        detector.toml         the detector as calibrated
        knowledge.toml        how the camera is mounted, and the sigmas expected before flight
        wireframe.json        the target as drawn
        frames.csv            index, time_s, exposure_ms
        navigation.csv        the chaser's state as its absolute navigation has it, errors and all
        frames/000000.png     12-bit DN in 16-bit files
        truth/                behind the wall: see ``renders.truth.image_truth``
        estimates/            what the pipelines said: see
        ``models.dataset.navigation_estimates_file``
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
import tomli_w

from models.arrays import Floats
from models.camera import Camera
from models.dataset.dataset import (
    FILTERED,
    DatasetInfo,
    FrameEntry,
    image_path,
    read_detector,
    read_frame_entries,
    read_image,
    read_info,
    read_toml,
)
from models.errors import DatasetError, cause
from models.motion.relative_state import ChaserState
from models.pose import RigidTransform
from models.uncooperative import ImageFrame, UncooperativeKnowledge
from models.wireframe.wireframe_file import read_wireframe

FORMAT = "rvbench-images"
NAVIGATION_COLUMNS = ("index", "time_s", "x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s")
KNOWLEDGE_KEYS = {
    "R_cam_from_lvlh",
    "t_cam_from_lvlh_m",
    "sigma_px",
    "chaser_sigma_m",
    "chaser_sigma_m_s",
}
OPTIONAL_KEYS = {"range_m", "inertia_kg_m2"}


def read_image_info(folder: Path) -> DatasetInfo:
    """Read ``dataset.json`` and refuse another format or version."""
    return read_info(folder, FORMAT)


def knowledge_to_toml(knowledge: UncooperativeKnowledge) -> str:
    """Return the text of ``knowledge.toml``; camera, detector and wireframe are files of theirs."""
    table = {
        "R_cam_from_lvlh": knowledge.cam_from_lvlh.rotation.tolist(),
        "t_cam_from_lvlh_m": knowledge.cam_from_lvlh.translation.tolist(),
        "sigma_px": float(knowledge.sigma_px),
        "chaser_sigma_m": float(knowledge.chaser_sigma_m),
        "chaser_sigma_m_s": float(knowledge.chaser_sigma_m_s),
    }
    if knowledge.range_m is not None:
        table["range_m"] = list(knowledge.range_m)
    if knowledge.inertia_kg_m2 is not None:
        table["inertia_kg_m2"] = knowledge.inertia_kg_m2.tolist()
    return tomli_w.dumps(table)


def read_uncooperative_knowledge(folder: Path) -> UncooperativeKnowledge:
    """Read everything that is loaded on board before the first frame.

    Raises
    ------
    DatasetError
        If a file is missing, a key is missing or unknown, or a value is none.
    """
    path = folder / "knowledge.toml"
    table = read_toml(path)
    unknown, missing = set(table) - KNOWLEDGE_KEYS - OPTIONAL_KEYS, KNOWLEDGE_KEYS - set(table)
    if unknown or missing:
        raise DatasetError(
            f"{path}: expected the keys {', '.join(sorted(KNOWLEDGE_KEYS))} and perhaps "
            f"{', '.join(sorted(OPTIONAL_KEYS))}; "
            f"unknown: {', '.join(sorted(unknown)) or 'none'}; "
            f"missing: {', '.join(sorted(missing)) or 'none'}"
        )
    try:
        cam_from_lvlh = RigidTransform(
            np.array(table["R_cam_from_lvlh"], dtype=np.float64),
            np.array(table["t_cam_from_lvlh_m"], dtype=np.float64),
        )
        sigmas = {
            key: float(table[key]) for key in ("sigma_px", "chaser_sigma_m", "chaser_sigma_m_s")
        }
        range_m, inertia = _range_m(table.get("range_m")), _inertia(table.get("inertia_kg_m2"))
        if not all(0.0 <= sigma < np.inf for sigma in sigmas.values()) or not sigmas["sigma_px"]:
            raise ValueError(f"sigmas {sigmas}")
    except (ValueError, TypeError) as error:
        raise DatasetError(
            f"{path}: expected a mount that is a rotation and a translation, sigma_px above zero, "
            "the chaser's sigmas from zero up, and, if given, range_m as nearest and farthest and "
            f"inertia_kg_m2 as three rows; got: {cause(error)}"
        ) from error
    return UncooperativeKnowledge(
        camera=Camera.from_toml(folder / "camera.toml"),
        target=read_wireframe(folder / "wireframe.json"),
        cam_from_lvlh=cam_from_lvlh,
        range_m=range_m,
        detector=read_detector(folder / "detector.toml"),
        inertia_kg_m2=inertia,
        **sigmas,
    )


def _range_m(typed: object) -> tuple[float, float] | None:
    if typed is None:
        return None
    if not isinstance(typed, list) or len(typed) != 2 or not 0.0 < typed[0] <= typed[1] < np.inf:
        raise ValueError(f"range_m {typed}")
    return float(typed[0]), float(typed[1])


def _inertia(typed: object) -> Floats | None:
    if typed is None:
        return None
    inertia = np.array(typed, dtype=np.float64)
    if inertia.shape != (3, 3) or not np.isfinite(inertia).all():
        raise ValueError(f"inertia_kg_m2 {typed}")
    return inertia


def navigation_to_csv(chaser: Iterable[tuple[int, ChaserState]]) -> str:
    """Return the text of ``navigation.csv``, by frame index."""
    rows = [
        ",".join(
            [
                str(index),
                *(
                    repr(float(x))
                    for x in (
                        state.time_s,
                        *state.position_in_inertial,
                        *state.velocity_in_inertial,
                    )
                ),
            ]
        )
        for index, state in chaser
    ]
    return "\n".join([",".join(NAVIGATION_COLUMNS), *rows]) + "\n"


def read_navigation(folder: Path) -> dict[int, ChaserState]:
    """Read ``navigation.csv``: the chaser's state by frame index.

    Raises
    ------
    DatasetError
        If the file, a column or a number is missing or not finite.
    """
    path = folder / "navigation.csv"
    try:
        with path.open(newline="") as file:
            rows = [
                (int(row["index"]), [float(row[key]) for key in NAVIGATION_COLUMNS[1:]])
                for row in csv.DictReader(file)
            ]
        if not np.isfinite([numbers for _, numbers in rows]).all():
            raise ValueError("a number that is not finite")
    except (OSError, KeyError, ValueError, TypeError, csv.Error) as error:
        raise DatasetError(
            f"expected {path} with the columns {', '.join(NAVIGATION_COLUMNS)}; got: {cause(error)}"
        ) from error
    return {
        index: ChaserState(time_s, np.array(state[:3]), np.array(state[3:]))
        for index, (time_s, *state) in rows
    }


def read_image_frame(folder: Path, entry: FrameEntry, chaser: ChaserState) -> ImageFrame:
    """Read one image."""
    return ImageFrame(
        index=entry.index,
        time_s=entry.time_s,
        image=read_image(image_path(folder, entry.index, FILTERED)),
        exposure_ms=entry.exposure_ms,
        chaser=chaser,
    )


def read_image_frames(folder: Path) -> Iterator[ImageFrame]:
    """Read all images, in order, one at a time.

    Raises
    ------
    DatasetError
        If a file is missing or damaged, or the chaser's navigation says nothing of a frame's time.
    """
    navigation = read_navigation(folder)
    for entry in read_frame_entries(folder):
        chaser = navigation.get(entry.index)
        if chaser is None or chaser.time_s != entry.time_s:
            raise DatasetError(
                f"{folder / 'navigation.csv'}: expected the chaser's state at frame "
                f"{entry.index}, {entry.time_s} s, got {chaser and chaser.time_s}"
            )
        yield read_image_frame(folder, entry, chaser)
