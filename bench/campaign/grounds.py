"""What the campaign works on: cases, and folders of every verb, made by the verbs themselves.

::

    cases/        scenarios, a specification, a spacecraft of one's own, as files
    pairs/        data (a run), store, and estimates of other tools, as files
    sweep/        data, store
    random/       data: begun, not rendered
    drawn/        data: a random dataset that is whole
    flight/       hand, chaser, each with data and store: a run by either camera of an arm
    suite/        data
    export/       data
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from functools import lru_cache
from pathlib import Path

import numpy as np

from bench.campaign.scenarios import write_cases
from models.dataset.dataset import open_dataset
from models.dataset.estimates_file import read_estimates
from models.errors import StorageError
from models.pose import RigidTransform

BEGUN = """
import sys
from bench.campaign.hostile.verb_alone import Reached, no_heavy_work
from bench.cli import main
try:
    with no_heavy_work():
        sys.exit(main(sys.argv[1:]))
except Reached:
    pass
"""
SUITE = (
    "suite", "pesce2019", "--quick", "--parts", "table7", "--runs", "1", "--seeds", "1",
    "--acquisitions", "1", "--duration-s", "60", "--paper-runs", "1",
)  # fmt: skip
FORMAT = "yolo-pose"
CAMPAIGN = Path(__file__).resolve().parent
HOUSE = CAMPAIGN.parents[1]


def make_grounds(folder: Path, *, tumble: bool, flight: bool = False) -> None:
    """Make what is not there yet.

    Parameters
    ----------
    folder : Path
    tumble : bool
        A run of a target without markers, a sweep, a suite and a whole random dataset, too: they
        take a minute.
    flight : bool
        The runs of both cameras of an arm.
    """
    cases = folder / "cases"
    write_cases(cases)
    pairs = folder / "pairs"
    _made(pairs, cases, "run", "small.toml", "--out", pairs / "data", "--store", pairs / "store")
    if not (pairs / "said.tum").is_file():
        write_said(pairs)
    spec = ("dataset", "spec.toml", "--workers", "1", "--out", folder / "random" / "data")
    _made(folder / "random", cases, *spec, begun=True)
    out = folder / "export" / "data"
    _made(folder / "export", cases, "export", pairs / "data", "--as", FORMAT, "--out", out)
    if tumble:
        place = folder / "tumble"
        _made(place, cases, "run", "turning.toml", "--out", place / "data", "--store", place / "s")
        place = folder / "sweep"
        typed = ("--suns", "S2", "S3", "--time-s", "200", "--width", "64", "--threads", "1")
        store = ("--out", place / "data", "--store", place / "store")
        _made(place, cases, "sweep", "small.toml", *typed, *store)
        place = folder / "drawn"
        _made(place, cases, "dataset", "drawn.toml", "--workers", "1", "--out", place / "data")
        place = folder / "suite"
        _made(place, cases, *SUITE, "--workers", "1", "--out", place / "data")
    if flight:
        for camera in ("hand", "chaser"):
            place = folder / "flight" / camera
            kept = ("--out", place / "data", "--store", place / "store")
            _made(place, cases, "run", f"{camera}.toml", *kept)


def _made(place: Path, cases: Path, *typed: object, begun: bool = False) -> None:
    """Run a verb unless this code has run it; ``begun`` stops it where it would render."""
    code = code_of_the_house()
    if (place / "made").is_file() and (place / "made").read_text() == code:
        return
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    program = BEGUN if begun else "import sys; from bench.cli import main; sys.exit(main())"
    command = [sys.executable, "-P", "-c", program, *map(str, typed)]
    done = subprocess.run(
        command, cwd=cases, env=dict(os.environ), capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        raise StorageError(f"expected `rvbench {typed[0]}` to make {place}, got: {done.stderr}")
    (place / "made").write_text(code)


@lru_cache(maxsize=1)
def code_of_the_house() -> str:
    """Return a hash of all code of the house but the campaign's: another makes other folders."""
    digest = hashlib.sha256()
    for room in ("models", "renders", "pipelines", "bench"):
        for path in sorted((HOUSE / room).rglob("*.py")):
            if CAMPAIGN not in path.parents:
                digest.update(path.read_bytes())
    return digest.hexdigest()


def write_said(pairs: Path) -> None:
    """Write the estimates of a run as BOP results, a SPEED submission, a trajectory, and ours."""
    dataset = open_dataset(pairs / "data")
    own = pairs / "data" / "estimates" / "best.jsonl"
    said = [
        (entry.index, entry.time_s, estimate.pose.cam_from_target)
        for entry, estimate in zip(dataset.entries, read_estimates(own), strict=True)
        if estimate.pose is not None
    ]
    (pairs / "said.jsonl").write_bytes(own.read_bytes())
    rows = {"said.bop.csv": ["scene_id,im_id,obj_id,score,R,t,time"], "said.speed.csv": []}
    rows["said.tum"] = ["# timestamp tx ty tz qx qy qz qw"]
    for frame, time_s, pose in said:
        rotation, place_m = _words(pose.rotation), _words(1e3 * pose.translation)
        rows["said.bop.csv"].append(f"1,{frame},1,0.9,{rotation},{place_m},-1")
        x, y, z, w = _xyzw(pose)
        numbers = ",".join(repr(float(v)) for v in (w, x, y, z, *pose.translation))
        rows["said.speed.csv"].append(f"img{frame:06d}.jpg,{numbers}")
        back = pose.inverse()
        rows["said.tum"].append(f"{time_s!r} {_words(back.translation)} {_words(_xyzw(back))}")
    for name, lines in rows.items():
        (pairs / name).write_text("\n".join(lines) + "\n")


def _words(values: object) -> str:
    return " ".join(repr(float(value)) for value in np.ravel(np.asarray(values)))


def _xyzw(pose: RigidTransform) -> tuple[float, ...]:
    from scipy.spatial.transform import Rotation

    return tuple(map(float, Rotation.from_matrix(pose.rotation).as_quat()))
