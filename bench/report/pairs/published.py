"""The papers' own numbers, read from ``bench/reference/*.toml``, to print beside ours."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

from bench.scoring.pairs.paper_statistics import PoseStatistic

REFERENCE = Path(__file__).resolve().parents[2] / "reference"


@dataclass(frozen=True)
class PublishedCase:
    """What a paper reports of one Sun case.

    Attributes
    ----------
    source : str
    tables : str
        Of the paper, where its numbers stand.
    runs : int
        Over which mean and std are taken.
    mean, std : PoseStatistic
        mu_N and sigma_N, equations 17 and 18.
    centroid_mean_px, centroid_std_px : tuple of 2 floats, px
    """

    source: str
    tables: str
    runs: int
    mean: PoseStatistic
    std: PoseStatistic
    centroid_mean_px: tuple[float, float]
    centroid_std_px: tuple[float, float]


def published_case(target: str, sun: str) -> PublishedCase | None:
    """Return what Opromolla et al. 2022 report for a target under a Sun, or None."""
    table = tomllib.loads((REFERENCE / "opromolla2022.toml").read_text())
    own = "eye_in_hand_target" if sun.startswith("E-") else "target"
    if target != table["source"][own] or sun not in table["results"]:
        return None
    row, centroids = table["results"][sun], table["centroids"][sun]
    return PublishedCase(
        source=table["source"]["title"],
        tables="Table 17" if sun.startswith("E-") else "Tables 12 and 13",
        runs=table["source"]["runs"],
        mean=PoseStatistic(row["mean_t_cm"], row["mean_euler_deg"]),
        std=PoseStatistic(row["std_t_cm"], row["std_euler_deg"]),
        centroid_mean_px=tuple(centroids["mean"]),
        centroid_std_px=tuple(centroids["std"]),
    )
