"""A chain that rvbench does not know: a beacon's place from a range finder and a small camera.

All of it is here: sensors, truth, pipelines, judgement, a part of the score, a section of the
report, a picture, and a dataset. ``register(CHAIN)`` is the only other thing that it needs. It has
no pose, no markers, no attitude; a dataset of it may have no camera and no image at all.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench.chains.chain import Chain, ScorePart
from bench.report.parts import Card, ReportParts, Section, TitledTable
from bench.report.summary import core_table
from bench.report.table import Table
from bench.scoring.judgement import Judgement
from models.camera import Camera
from models.dataset.description import DatasetInfo, Stream, info_to_json
from models.dataset.frame_table import FrameEntry, frames_to_csv
from models.dataset.image_file import encode_image
from models.dataset.onboard_files import onboard_texts
from models.dataset.sensor_table import table_to_csv
from models.errors import DatasetError
from models.estimate import Estimate, NamedState
from models.frame import Frame, TableReading
from models.onboard import OnboardKnowledge, needed
from models.reading.csv_table import read_csv
from pipelines.pipeline import RegisteredPipeline

NAME, STATE, PLACE = "beacon_place", "beacon", "beacon_in_cam_m"
RANGE, SPOT = "range_finder", "spot_image"
COLUMNS = ("range_m",)
CAMERA = Camera.from_fov(width=48, height=32, fov_deg=40.0)
BIAS_M, BRIGHT_DN = 0.5, 900.0  # the range finder reads so much too far; the pipelines are told
FINDER = {"range_finder.toml": {"bias_m": BIAS_M, "sigma_m": 0.02}}
WRONG_M = 0.5
HERE = "tests.support.invented_chain"


class Beacon:
    """Range along the ray to the brightest spot; without a camera along the boresight."""

    def __init__(self, onboard: OnboardKnowledge, variant: str) -> None:
        self.bias_m = onboard.tables["range_finder.toml"]["bias_m"]
        self.camera = needed(onboard.camera, "camera.toml", "beacon") if variant == "seen" else None

    def process(self, frame: Frame) -> Estimate:
        """Return where the beacon is, or why that is not known."""
        ranges_m = frame.table(RANGE).column("range_m") - self.bias_m
        if not len(ranges_m):
            return Estimate(frame.index, frame.time_s, reason="no range since the last frame")
        ray = np.array([0.0, 0.0, 1.0])
        if self.camera is not None:
            image = frame.image(SPOT).image.astype(np.float64)
            weight = np.where(image > 0.5 * image.max(), image, 0.0)
            v, u = (float((axis * weight).sum() / weight.sum()) for axis in np.indices(image.shape))
            ray = self.camera.rays(np.array([[u, v]]))[0]
        place = NamedState({PLACE: ray * ranges_m[-1]}, 0.01 * np.eye(3))
        return Estimate(frame.index, frame.time_s, mode="ranged", states={STATE: place})


SEEN = RegisteredPipeline("beacon-seen", lambda told, _: Beacon(told, "seen"), (RANGE, SPOT))
AHEAD = RegisteredPipeline("beacon-ahead", lambda told, _: Beacon(told, "ahead"), (RANGE,))


@dataclass(frozen=True)
class TruePlace:
    """Where the beacon was at a frame."""

    time_s: float
    in_cam_m: np.ndarray
    cam_from_target: None = None


@dataclass(frozen=True, eq=False)
class JudgedPlace(Judgement):
    """A frame is lost if it has no place; of poses nothing is asked."""

    place: np.ndarray | None

    @property
    def lost(self) -> bool:
        return self.place is None


@dataclass(frozen=True)
class Sideways:
    """What the score adds; a NaN of NumPy's, where there is nothing, is None in the file."""

    rms_m: np.float64
    by_axis_m: np.ndarray


def truths(dataset: Any) -> dict[int, TruePlace]:
    path = dataset.folder / "truth" / "beacon.csv"
    if not path.is_file():
        return {}
    rows = read_csv(path, ("index", "time_s", "x_m", "y_m", "z_m"))
    return {
        row.whole("index", 0, 1000): TruePlace(
            row.number("time_s", 0.0, 1e6),
            np.array([row.number(name, -1e3, 1e3) for name in ("x_m", "y_m", "z_m")]),
        )
        for row in rows
    }


def truth(dataset: Any) -> dict[int, TruePlace]:
    known = truths(dataset)
    if not known:
        raise DatasetError(f"expected {dataset.folder}/truth/beacon.csv, found none")
    return known


def place_of(said: Estimate | None) -> np.ndarray | None:
    return said.states[STATE].values[PLACE] if said is not None and STATE in said.states else None


def judge(run: Any, known: dict[int, TruePlace]) -> list[JudgedPlace]:
    judged = []
    for index, was in known.items():
        said = run.estimates[index]
        place = place_of(said)
        off_m = None if place is None else float(np.linalg.norm(place - was.in_cam_m))
        judged.append(
            JudgedPlace(
                run=run.number,
                estimate=said,
                range_m=float(np.linalg.norm(was.in_cam_m)),
                position_m=off_m,
                attitude_deg=None,
                missed=place is None,
                wrong=off_m is not None and off_m > WRONG_M,
                place=place,
            )
        )
    return judged


def sideways(judged: Any, known: dict[int, TruePlace], label: str) -> Sideways:
    errors = [e.place - known[e.estimate.frame].in_cam_m for e in judged[0] if e.place is not None]
    if not errors:
        return Sideways(np.float64(np.nan), np.full(3, np.nan))
    squares = np.mean(np.square(errors), axis=0)
    return Sideways(np.sqrt(squares[:2].sum()), np.sqrt(squares))


def frame_rows(judged: Any, known: dict[int, TruePlace]) -> list[dict[str, Any]]:
    return [{"place_m": e.place} for e in judged[0]]


def report(given: Any) -> ReportParts:
    part = {label: own["parts"]["sideways"] for label, own in given.score["pipelines"].items()}
    rows = [[label, str(own["rms_m"])] for label, own in part.items()]
    table = TitledTable("sideways", Table(["pipeline", "rms, m"], rows, {}, {}))
    return ReportParts(
        lead=f"a beacon, {given.score['frames']} looks at it",
        cards=[Card(str(given.headline["core"]["estimated"]), "", "places", "")],
        hero=given.headline["per_frame"][0]["frame"],
        hero_words="the first",
        headline=core_table(given.score),
        after=[Section("Sideways of the beacon", tables=(table,))],
    )


def picture(record: Any, width_px: int = 480) -> np.ndarray | None:
    if SPOT not in record.frame.readings:
        return None
    grey = np.clip(record.image(SPOT) / 4.0, 0, 255).astype(np.uint8)
    scale = max(1, width_px // grey.shape[1])
    return np.repeat(np.kron(grey, np.ones((scale, scale), np.uint8))[:, :, None], 3, axis=2)


def verdict(record: Any) -> str:
    place = place_of(record.estimate)
    if place is None:
        return "no place"
    return f"beacon at {np.round(place, 2).tolist()} m"


CHAIN = Chain(
    name=NAME,
    title="looks at a beacon",
    pipelines=("beacon-seen", "beacon-ahead"),
    brought={"beacon-seen": f"{HERE}:SEEN", "beacon-ahead": f"{HERE}:AHEAD"},
    truths=truths,
    truth=truth,
    judge=judge,
    parts=(ScorePart("sideways", sideways),),
    frame_rows=frame_rows,
    report=report,
    headline=core_table,
    picture=picture,
    show=picture,
    verdict=verdict,
    legend="the spot as it was seen",
)


def true_place(index: int) -> np.ndarray:
    """Return where the beacon is at a frame: it passes from left to right, and comes nearer."""
    return np.array([0.3 * (index - 2), 0.2, 8.0 - 0.5 * index])


def spot(place: np.ndarray) -> np.ndarray:
    """Return a blur of a pixel's sigma where the beacon is, (height, width) uint16."""
    v, u = np.indices((CAMERA.height, CAMERA.width))
    at_u, at_v = CAMERA.project(place)
    light = BRIGHT_DN * np.exp(-0.5 * ((u - at_u) ** 2 + (v - at_v) ** 2))
    return np.rint(light).astype(np.uint16)


def write_beacon(
    folder: Path, frames: int = 5, *, seen: bool = True, silent: tuple[int, ...] = ()
) -> Path:
    """Write both halves of a dataset, by the writers that everybody has.

    Parameters
    ----------
    folder : Path
    frames : int
    seen : bool
        Whether there is a camera.
    silent : tuple of int
        Frames without a range.
    """
    entries = [FrameEntry(index, 2.0 * index) for index in range(frames)]
    onboard = OnboardKnowledge(camera=CAMERA if seen else None, tables=FINDER)
    ranges = [
        (
            index,
            TableReading(
                COLUMNS,
                np.array([] if index in silent else [2.0 * index]),
                np.array([] if index in silent else [np.linalg.norm(true_place(index)) + BIAS_M])
                .reshape(-1, 1),
            ),
        )
        for index in range(frames)
    ]  # fmt: skip
    images = (Stream(SPOT, "image", "frames/spot_{index:06d}.png"),) if seen else ()
    known = onboard_texts(onboard)
    info = DatasetInfo(
        case="beacon",
        sun="none",
        frames=frames,
        target="beacon",
        chain=NAME,
        streams=(Stream(RANGE, "table", "ranges.csv", COLUMNS), *images),
        onboard=tuple(known),
        provenance={"made by": "a test"},
    )
    for name in ("frames", "truth"):
        (folder / name).mkdir(parents=True)
    texts = {
        **known,
        "dataset.json": info_to_json(info),
        "frames.csv": frames_to_csv(entries),
        "ranges.csv": table_to_csv(COLUMNS, ranges),
        "truth/beacon.csv": "index,time_s,x_m,y_m,z_m\n" + "".join(
            f"{e.index},{e.time_s}," + ",".join(map(repr, true_place(e.index).tolist())) + "\n"
            for e in entries
        ),
    }  # fmt: skip
    for name, text in texts.items():
        (folder / name).write_text(text)
    for index in range(frames) if seen else ():
        images[0].path(folder, index).write_bytes(encode_image(spot(true_place(index))))
    return folder
