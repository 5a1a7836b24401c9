"""Whether it matters that both images of a pair share the seed of their light.

What grain both images have cancels in their difference. So a case is rendered with two seeds, the
850 nm image of each pair is taken from the other seed's render, and what the pipelines then say is
held against what they said of pairs with one seed: the change beside the spread over runs, whose
light is the same and whose detector noise is drawn anew.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tomllib
from pathlib import Path

import numpy as np
import tomli_w
from rich.table import Table
from scipy.spatial.transform import Rotation

from bench import api
from bench.estimating.runs import estimates_path
from models.arrays import Floats
from models.dataset.estimates_file import read_estimates
from models.estimate import Estimate, PoseEstimate
from models.plain_console import plain_console
from renders.scenario.case_files import case_path

LABELS = ("paper", "best")
OTHER_BAND = "_850"
COLUMNS = (
    "pipeline",
    "frames with a pose: one seed, two",
    "markers used: one seed, two",
    "change of position, over the runs' spread",
    "of attitude",
    "stated sigma, over one seed's",
)


def with_seed(case: str, seed: int, folder: Path) -> Path:
    """Write a case with another seed of its light, its Suns not shared, and return its file.

    Parameters
    ----------
    case : str
    seed : int
        Of the light.
    folder : Path
        Where the file goes.
    """
    table = tomllib.loads(case_path(case).read_text())
    table["render"] = {**table.get("render", {}), "seed": seed}
    table.get("sun", {}).pop("shared", None)
    path = folder / f"seed{seed}.toml"
    path.write_text(tomli_w.dumps(table))
    return path


def mixed(first: Path, other: Path, out: Path) -> None:
    """Copy a dataset with one band's images from another.

    Parameters
    ----------
    first, other : Path
        Of the same poses.
    out : Path
        Made anew.
    """
    shutil.rmtree(out, ignore_errors=True)
    shutil.copytree(first, out, ignore=shutil.ignore_patterns("estimates", "seeds", "score*"))
    for image in sorted((other / "frames").glob(f"*{OTHER_BAND}.png")):
        shutil.copy(image, out / "frames" / image.name)


def change(one: PoseEstimate, other: PoseEstimate) -> Floats:
    """Return by how much two poses differ, (2,) array: m and rad."""
    a, b = one.cam_from_target, other.cam_from_target
    turn = Rotation.from_matrix(a.rotation @ b.rotation.T).magnitude()
    return np.array([np.linalg.norm(a.translation - b.translation), turn])


def rms_change(one: list[Estimate], other: list[Estimate]) -> Floats:
    """Return the root mean square over frames of ``change``, (2,) array: m and rad."""
    poses = [(a.pose, b.pose) for a, b in zip(one, other, strict=True)]
    changes = [change(a, b) for a, b in poses if a is not None and b is not None]
    return np.sqrt(np.mean(np.square(changes), axis=0))


def sigma(estimates: list[Estimate]) -> float:
    """Return the median stated sigma of the position, m."""
    stated = [e.pose.covariance for e in estimates if e.pose is not None]
    return float(np.median([np.sqrt(np.trace(c[3:, 3:])) for c in stated if c is not None]))


def row(label: str, runs: list[list[Estimate]], two_seeds: list[Estimate]) -> list[str]:
    """Return a line of the table.

    Parameters
    ----------
    label : str
    runs : list of lists of Estimate
        Of pairs with one seed, by run.
    two_seeds : list of Estimate
        Of run 0 with the other seed's images in it.
    """
    one = runs[0]
    spread = np.sqrt(np.mean([rms_change(one, other) ** 2 for other in runs[1:]], axis=0))
    ratios = rms_change(one, two_seeds) / spread
    found = [sum(e.pose is not None for e in said) for said in (one, two_seeds)]
    used = [
        sum(int(np.sum(e.detections.used)) for e in said if e.detections is not None)
        for said in (one, two_seeds)
    ]
    return [
        label,
        f"{found[0]}, {found[1]} of {len(one)}",
        f"{used[0]}, {used[1]}",
        *(f"{ratio:.2f}" for ratio in ratios),
        f"{sigma(two_seeds) / sigma(one):.3f}",
    ]


def main() -> int:
    """Render, mix, estimate, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--case", default="maxar-approach")
    parser.add_argument("--sun", default="S2")
    parser.add_argument("--rate-hz", type=float, default=0.2)
    parser.add_argument("--width", type=int, default=1024)
    parser.add_argument("--runs", type=int, default=4, help="of one seed, for the spread")
    parser.add_argument("--out", type=Path, default=Path("out/pairs"))
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    options = {"sun": asked.sun, "rate_hz": asked.rate_hz, "width": asked.width}
    first, other, both = (asked.out / name for name in ("seed0", "seed1", "both"))
    api.run(str(with_seed(asked.case, 0, asked.out)), first, asked.runs, **options)
    api.render(str(with_seed(asked.case, 1, asked.out)), other, **options)
    mixed(first, other, both)
    api.estimate(both, pipelines=LABELS)
    table = Table(*COLUMNS)
    for label in LABELS:
        runs = [
            read_estimates(estimates_path(first, number, label)) for number in range(asked.runs)
        ]
        table.add_row(*row(label, runs, read_estimates(estimates_path(both, 0, label))))
    plain_console().print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
