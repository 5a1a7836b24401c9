"""What the runs of a sequence come to: the paper's statistics, and what they hide."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from collections.abc import Sequence as Many
from dataclasses import dataclass

import numpy as np

from bench.compare.bootstrap import FEWEST_BLOCKS, Resampling, interval
from bench.scoring.metrics.pose_errors import POSE_DOF
from bench.scoring.pairs.paper_statistics import temporal_statistics
from bench.suites.consistency import Consistency, consistency, root_mean_square
from bench.suites.opromolla2022.flight_run import EXACT_PEER
from bench.suites.units import Outcome
from models.arrays import AnyArray, Floats, Mask

IN_TABLES = np.array([100.0, 100.0, 100.0, 1.0, 1.0, 1.0])  # cm and deg
SHOWN_ENOUGH = 0.9  # of a marker: it must be found
PARAMETERS = ("tx", "ty", "tz", "alpha", "beta", "gamma")


class Runs:
    """The runs of one sequence by one variant.

    Parameters
    ----------
    outcomes : sequence of Outcome
        Of ``flight_run.fly``.
    errors, variant : str
        Name of the set of errors; ``paper``, ``best`` or ``exact``.
    """

    def __init__(self, outcomes: Many[Outcome], errors: str, variant: str) -> None:
        self._outcomes, self._cell = outcomes, f"{errors}/{variant}"
        self.time_s: Floats = outcomes[0].values["time_s"]
        self.range_m: Floats = outcomes[0].values["range_m"]
        self.whole: Mask = outcomes[0].values["whole"]
        self.shown: Floats = outcomes[0].values["shown"]
        self.errors: Floats = self.of("errors").astype(np.float64)

    def of(self, name: str) -> AnyArray:
        """Return what is known of every run and frame, (runs, frames, ...)."""
        return np.concatenate([each.values[f"{self._cell}/{name}"] for each in self._outcomes])

    def __len__(self) -> int:
        return len(self.errors)

    @property
    def position_mm(self) -> Floats:
        """Length of the error of position, (runs, frames), mm; NaN without a pose."""
        return np.asarray(1e3 * np.linalg.norm(self.errors[..., :3], axis=2))


@dataclass(frozen=True)
class Statistics:
    """Equations 17 and 18, cm and deg: (tx, ty, tz, alpha, beta, gamma).

    Attributes
    ----------
    mean, std : list of 6 floats
        mu_N and sigma_N.
    spread : list of 6 floats
        Standard error of mu_N, from the spread of the runs' own means.
    """

    mean: list[float]
    std: list[float]
    spread: list[float]


def statistics(runs: Runs) -> Statistics | None:
    """Return the paper's statistics; None where fewer than two instants have a pose."""
    errors = runs.errors * IN_TABLES
    told = np.isfinite(errors[..., 0]).any(axis=0)
    if told.sum() < 2:
        return None
    mean, std = temporal_statistics(errors[:, told])
    with_pose = np.isfinite(errors[..., 0]).any(axis=1)
    own = np.nanmean(errors[with_pose], axis=1)
    spread = own.std(axis=0, ddof=1) / np.sqrt(len(own)) if len(own) > 1 else np.full(6, np.nan)
    return Statistics(mean.tolist(), np.asarray(std).tolist(), spread.tolist())


@dataclass(frozen=True)
class PerFrame:
    """What a user of one run meets, all runs and frames together.

    Attributes
    ----------
    runs, frames, lost, missed, wrong : int
        Of frames: of one run; the others over all.
    rms : list of 6 floats
        mm and deg, of each parameter; empty without a pose.
    position_mm, attitude_deg : list of 3 floats
        Median, 95th percentile, root mean square.
    nees : Consistency
    centroid_mean_px, centroid_std_px : list of 2 floats
        Of run 0, all markers: Table 13.
    pooled_centroid_std_px : list of 2 floats
        Of all runs.
    reasons : dict
        Of lost frames, and how often.
    """

    runs: int
    frames: int
    lost: int
    missed: int
    wrong: int
    rms: list[float]
    position_mm: list[float]
    attitude_deg: list[float]
    nees: Consistency
    centroid_mean_px: list[float]
    centroid_std_px: list[float]
    pooled_centroid_std_px: list[float]
    reasons: dict[str, int]


def per_frame(runs: Runs) -> PerFrame:
    """Return what a user of one run meets."""
    lost = ~np.isfinite(runs.errors[..., 0])
    there = runs.errors[~lost]
    centroids = runs.of("centroids").astype(np.float64)
    first = centroids[0].reshape(-1, 2)
    pooled = centroids.reshape(-1, 2)
    reasons = Counter(text for text in runs.of("reason")[lost].tolist() if text)
    in_mm = np.array([1e3, 1e3, 1e3, 1.0, 1.0, 1.0])
    return PerFrame(
        runs=len(runs),
        frames=runs.errors.shape[1],
        lost=int(lost.sum()),
        missed=int(runs.of("missed").sum()),
        wrong=int(runs.of("wrong").sum()),
        rms=np.sqrt(np.mean((there * in_mm) ** 2, axis=0)).tolist() if len(there) else [],
        position_mm=_sizes(runs.position_mm),
        attitude_deg=_sizes(runs.of("attitude_deg").astype(np.float64)),
        nees=consistency(runs.of("nees").astype(np.float64), POSE_DOF),
        centroid_mean_px=_finite(np.nanmean, first),
        centroid_std_px=_finite(np.nanstd, first),
        pooled_centroid_std_px=_finite(np.nanstd, pooled),
        reasons=dict(reasons.most_common()),
    )


def _sizes(values: Floats) -> list[float]:
    there = values[np.isfinite(values)]
    if not there.size:
        return []
    rms = root_mean_square(there) or 0.0
    return [float(np.median(there)), float(np.percentile(there, 95.0)), rms]


def _finite(statistic: Callable[..., AnyArray], errors: Floats) -> list[float]:
    there = errors[np.isfinite(errors).all(axis=1)]
    return np.asarray(statistic(there, axis=0)).tolist() if len(there) > 1 else []


@dataclass(frozen=True)
class OverPaper:
    """The rms of ``best`` over that of ``paper``, where both have a pose.

    Attributes
    ----------
    ratio : list of 6 floats
    low, high : list of 6 floats
        Where it lies 95 times in 100, by a paired bootstrap.
    decides : bool
        Whether there are enough frames, or runs, for an interval to tell.
    """

    ratio: list[float]
    low: list[float]
    high: list[float]
    decides: bool


def over_paper(best: Runs, paper: Runs, by_runs: bool) -> OverPaper | None:
    """Compare the variants by a paired bootstrap, over frames or over runs.

    Parameters
    ----------
    best, paper : Runs
        Over the same frames.
    by_runs : bool
        Whether runs are redrawn, each whole, instead of frames in blocks. There are six blocks
        at least, of the usual length where frames suffice.

    Returns
    -------
    OverPaper or None
        None where they have fewer than two frames, or runs, in common.
    """
    both = np.isfinite(best.errors[..., 0]) & np.isfinite(paper.errors[..., 0])
    axis = 1 if by_runs else 0
    counts = both.sum(axis=axis)
    chosen = counts > 0
    if chosen.sum() < 2:
        return None
    squares = [
        np.where(both[..., None], own.errors**2, 0.0).sum(axis=axis)[chosen]
        for own in (best, paper)
    ]
    drawn_from = int(chosen.sum())
    usual = 1 if by_runs else Resampling().block(drawn_from)
    how = Resampling(block_frames=max(1, min(usual, drawn_from // FEWEST_BLOCKS)))
    drawn = np.concatenate(list(how.draws(drawn_from)))
    ratios = np.sqrt(squares[0][drawn].sum(axis=1) / squares[1][drawn].sum(axis=1))
    ends = [interval(column) for column in ratios.T]
    ratio = np.sqrt(squares[0].sum(axis=0) / squares[1].sum(axis=0))
    return OverPaper(
        ratio.tolist(),
        [end[0] for end in ends],
        [end[1] for end in ends],
        how.decides(drawn_from),
    )


def lost_alone(best: Runs, paper: Runs) -> int:
    """Count frames, over all runs, in which ``paper`` has a pose and ``best`` has none.

    Parameters
    ----------
    best, paper : Runs
        Over the same frames.
    """
    lost, kept = ~np.isfinite(best.errors[..., 0]), np.isfinite(paper.errors[..., 0])
    return int((lost & kept).sum())


@dataclass(frozen=True)
class SunVerdict:
    """A Sun of the map, by one variant.

    Attributes
    ----------
    colour : str
        As in Figure 22: green, all markers at every frame; yellow, some lost from a frame on;
        red, all lost.
    dots : list of floats
        Share of each that truth has lit and seen, the least of all frames.
    poses, frames : int
    all_shown : int
        Frames in which truth has at least 90 % of every marker lit and seen.
    posed_of_shown : int
        Those of them with a pose.
    posed_of_few, outline_of_few : int
        Of the other frames: those with a pose, and with one for which the outline helped.
    overconfident : int
        Poses that are beyond 5 cm or 5 deg with a claimed covariance that forbids it.
    reason : str
        Told most often for none; empty where there is none to tell.
    """

    colour: str
    dots: list[float]
    poses: int
    frames: int
    all_shown: int
    posed_of_shown: int
    posed_of_few: int
    outline_of_few: int
    overconfident: int
    reason: str

    @property
    def few(self) -> int:
        """Frames in which truth has less of some marker."""
        return self.frames - self.all_shown


def sun_verdict(runs: Runs) -> SunVerdict:
    """Judge one Sun of the map by its single run."""
    used = np.isfinite(runs.of("centroids")[0, ..., 0])
    posed = np.isfinite(runs.errors[0, :, 0])
    shown = (runs.shown >= SHOWN_ENOUGH).all(axis=1)
    by_outline = runs.of("outline")[0]
    colour = "green"
    if not (used.all(axis=1) & posed).all():
        colour = "yellow" if used.any(axis=1).all() else "red"
    reasons = Counter(text for text in runs.of("reason")[0][~posed].tolist() if text)
    return SunVerdict(
        colour,
        runs.shown.min(axis=0).tolist(),
        int(posed.sum()),
        len(posed),
        int(shown.sum()),
        int((posed & shown).sum()),
        int((posed & ~shown).sum()),
        int((posed & ~shown & by_outline).sum()),
        int(runs.of("wrong")[0].sum()),
        reasons.most_common(1)[0][0] if reasons else "",
    )


def exact(outcomes: Many[Outcome], errors: str) -> Runs:
    """Return what exact centroids give in the same runs."""
    return Runs(outcomes, errors, EXACT_PEER)
