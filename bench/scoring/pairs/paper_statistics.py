"""The temporal mean and standard deviation of Opromolla et al. 2022, equations 17 and 18.

They describe the mean error over the runs, not the error of a frame: with 100 runs of independent
noise they are ten times smaller than what a user of one run meets. The bench prints them beside
the paper's own for comparison, and per-frame errors for use.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from models.arrays import Floats
from models.pose import PoseError


@dataclass(frozen=True)
class PoseStatistic:
    """One statistic of the six pose parameters, in the units of the paper's tables.

    Attributes
    ----------
    t_cm : list of 3 floats, cm
    euler_deg : list of 3 floats, deg
        (alpha, beta, gamma).
    """

    t_cm: list[float]
    euler_deg: list[float]


@dataclass(frozen=True)
class PaperStatistics:
    """Equations 17 and 18.

    Attributes
    ----------
    runs : int
        n_s.
    instants : int
        n_t: instants at which at least one run has a pose.
    mean : PoseStatistic
        mu_N, equation 17.
    std : PoseStatistic
        sigma_N, equation 18 put right; None for fewer than two instants.
    """

    runs: int
    instants: int
    mean: PoseStatistic | None
    std: PoseStatistic | None


def temporal_statistics(errors: Floats) -> tuple[Floats, Floats | None]:
    """Return (mu_N, sigma_N) of one or more error parameters.

    ``mu(t) = mean_k h_k(t)``, ``mu_N = mean_t mu(t)``,
    ``sigma_N^2 = sum_t (mu_N - mu(t))^2 / (n_t - 1)``. As printed, equation 18 sums a term that
    depends on t over the runs k and divides by n_s - 1, which cannot be meant.

    Parameters
    ----------
    errors : (n_s, n_t, ...) array
        NaN where a run has no pose; no instant may be NaN in all runs.

    References
    ----------
    Opromolla et al. 2022, equations 17 and 18.
    """
    means = np.nanmean(errors, axis=0)
    spread = means.std(axis=0, ddof=1) if len(means) > 1 else None
    return means.mean(axis=0), spread


def _statistic(row: Floats) -> PoseStatistic:
    return PoseStatistic(t_cm=[float(x) for x in row[:3]], euler_deg=[float(x) for x in row[3:]])


def paper_statistics(runs: Sequence[Mapping[int, PoseError]]) -> PaperStatistics:
    """Compute equations 17 and 18 over runs of one set of frames.

    Parameters
    ----------
    runs : sequence of mappings
        One per run: the pose error by frame; frames without a pose are absent. An instant's mean
        is over the runs that have a pose there.
    """
    instants = sorted(set().union(*runs)) if runs else []
    if not instants:
        return PaperStatistics(len(runs), 0, None, None)
    table = np.full((len(runs), len(instants), 6), np.nan)
    column = {frame: index for index, frame in enumerate(instants)}
    for row, errors in zip(table, runs, strict=True):
        for frame, error in errors.items():
            row[column[frame]] = [*(1e2 * error.position_m), *error.euler_deg]
    mean, std = temporal_statistics(table)
    return PaperStatistics(
        runs=len(runs),
        instants=len(instants),
        mean=_statistic(mean),
        std=None if std is None else _statistic(std),
    )
