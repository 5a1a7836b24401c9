"""What many runs of one setting come to: errors over a window, bounds, consistency, failures.

A root mean square is over all frames of the window and all runs together. A frame without a state
has no error and is counted beside, never dropped in silence.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import binomtest

from bench.scoring.judgement import without_numbers
from bench.suites.consistency import CONFIDENCE, Consistency, consistency, root_mean_square
from bench.suites.pesce2019.acquisition_trial import WRONG_DEG, WRONG_M
from bench.suites.pesce2019.tracking_run import MODES
from bench.suites.units import Outcome
from models.arrays import Floats, Mask

STATE_DOF, POSE_DOF = 6, 3
STEADY_SHARE = 1000.0 / 1800.0  # of a run, its end: Table 6's window
SETTLED_S = 50.0  # from here on: Tables 7 and 8


@dataclass(frozen=True)
class TrackingSummary:
    """One cell, one variant, one window.

    Attributes
    ----------
    runs, frames : int
        Frames of the window, all runs together.
    position_m, attitude_deg, velocity_m_s, rate_deg_s : float or None
        Root mean square error of the filtered state.
    first_run_position_m, first_run_attitude_deg : float or None
        The same of run 0 alone: the paper's Tables 7 and 8 are one run.
    median_run_position_m, median_run_attitude_deg : float or None
        Median over the runs of each run's own.
    worst_run_share_position, worst_run_share_attitude : float or None
        How much of the sum of squares is the worst run's.
    largest_attitude_deg : float or None
    raw_position_m, raw_attitude_deg : float or None
        Root mean square error of the poses before the filter.
    stated_position_m, stated_attitude_deg : float or None
        Root mean square of what the filter states.
    no_state, no_pose : float
        Shares of the frames.
    modes : dict
        Frames by mode.
    reasons : dict
        Why there was no pose, over whole runs.
    nees_translation, nees_rotation, nis_translation, nis_rotation : Consistency
    """

    runs: int
    frames: int
    position_m: float | None
    attitude_deg: float | None
    velocity_m_s: float | None
    rate_deg_s: float | None
    first_run_position_m: float | None
    first_run_attitude_deg: float | None
    median_run_position_m: float | None
    median_run_attitude_deg: float | None
    worst_run_share_position: float | None
    worst_run_share_attitude: float | None
    largest_attitude_deg: float | None
    raw_position_m: float | None
    raw_attitude_deg: float | None
    stated_position_m: float | None
    stated_attitude_deg: float | None
    no_state: float
    no_pose: float
    modes: dict[str, int]
    reasons: dict[str, int]
    nees_translation: Consistency
    nees_rotation: Consistency
    nis_translation: Consistency
    nis_rotation: Consistency


@dataclass(frozen=True)
class BoundSummary:
    """Root mean square of the bounds over a window; see ``bench.suites.pesce2019.filter_bound``."""

    raw_position_m: float
    raw_attitude_deg: float
    position_m: float
    attitude_deg: float
    velocity_m_s: float
    rate_deg_s: float


@dataclass(frozen=True)
class AcquisitionSummary:
    """One case of Table 5, one variant.

    Attributes
    ----------
    runs, acquired : int
    position_m, position_std_m, attitude_deg, attitude_std_deg : float or None
        Mean and standard deviation of the error's size over those acquired, wrong ones too.
    median_position_m, median_attitude_deg : float or None
    first_image : float
        Share of the runs that acquired on the first image.
    wrong : int
        Acquired, but more than 10 deg or 1 m from the truth.
    confused : int
        Of those, within 10 deg and 1 m of a pose that the target's symmetry makes alike.
    wrong_share : float or None
        Of those acquired.
    wrong_share_most : float or None
        Below which it is with 97.5 % confidence (Clopper and Pearson).
    """

    runs: int
    acquired: int
    position_m: float | None
    position_std_m: float | None
    attitude_deg: float | None
    attitude_std_deg: float | None
    median_position_m: float | None
    median_attitude_deg: float | None
    first_image: float
    wrong: int
    confused: int
    wrong_share: float | None
    wrong_share_most: float | None


def steady(frames: int) -> slice:
    """Return Table 6's window: the last 1000 of 1800 s, or that share of another duration."""
    return slice(frames - round(STEADY_SHARE * frames), frames)


def settled(frames: int, rate_hz: float) -> slice:
    """Return the window of Tables 7 and 8: from 50 s on."""
    return slice(round(SETTLED_S * rate_hz), frames)


def stacked(outcomes: Sequence[Outcome], name: str) -> Floats:
    """Return one number of every run and frame, (runs, frames)."""
    return np.array([outcome.values[name] for outcome in outcomes], dtype=np.float64)


def tracking_summary(outcomes: Sequence[Outcome], window: slice) -> TrackingSummary:
    """Summarise the runs of one cell and variant over a window."""

    def part(name: str) -> Floats:
        return stacked(outcomes, name)[:, window]

    position, attitude = part("position_m"), part("attitude_deg")
    raw_position, modes = part("raw_position_m"), part("mode").astype(int)
    reasons: Counter[str] = Counter()
    for outcome in outcomes:
        told = zip(outcome.values["reasons"], outcome.values["reason_counts"], strict=True)
        for reason, times in told:
            reasons[without_numbers(str(reason))] += int(times)
    finite = attitude[np.isfinite(attitude)]
    return TrackingSummary(
        runs=len(outcomes),
        frames=int(position.size),
        position_m=root_mean_square(position),
        attitude_deg=root_mean_square(attitude),
        velocity_m_s=root_mean_square(part("velocity_m_s")),
        rate_deg_s=root_mean_square(part("rate_deg_s")),
        first_run_position_m=root_mean_square(position[0]),
        first_run_attitude_deg=root_mean_square(attitude[0]),
        median_run_position_m=_median_run(position),
        median_run_attitude_deg=_median_run(attitude),
        worst_run_share_position=_worst_share(position),
        worst_run_share_attitude=_worst_share(attitude),
        largest_attitude_deg=float(finite.max()) if finite.size else None,
        raw_position_m=root_mean_square(raw_position),
        raw_attitude_deg=root_mean_square(part("raw_attitude_deg")),
        stated_position_m=root_mean_square(part("sigma_position_m")),
        stated_attitude_deg=root_mean_square(part("sigma_attitude_deg")),
        no_state=float(np.mean(~np.isfinite(position))),
        no_pose=float(np.mean(~np.isfinite(raw_position))),
        modes={mode: int(np.sum(modes == place)) for place, mode in enumerate(MODES)},
        reasons=dict(reasons.most_common()),
        nees_translation=consistency(part("nees_translation"), STATE_DOF),
        nees_rotation=consistency(part("nees_rotation"), STATE_DOF),
        nis_translation=consistency(part("nis_translation"), POSE_DOF),
        nis_rotation=consistency(part("nis_rotation"), POSE_DOF),
    )


def bound_summary(outcome: Outcome, window: slice) -> BoundSummary:
    """Summarise a bound over a window, as errors are."""
    return BoundSummary(
        **{
            name: float(np.sqrt(np.mean(np.asarray(values, dtype=np.float64)[window] ** 2)))
            for name, values in outcome.values.items()
        }
    )


def acquisition_summary(outcomes: Sequence[Outcome], most: int | None = None) -> AcquisitionSummary:
    """Summarise the acquisitions of a case and variant, the first so many of them."""
    column = {
        name: np.concatenate([outcome.values[name] for outcome in outcomes])[:most].astype(float)
        for name in ("position_m", "attitude_deg", "attitude_symmetric_deg", "images")
    }
    there = np.isfinite(column["position_m"])
    position, attitude = column["position_m"][there], column["attitude_deg"][there]
    bad = _beyond(position, attitude)
    confused = bad & ~_beyond(position, column["attitude_symmetric_deg"][there])
    acquired, wrong = int(there.sum()), int(bad.sum())
    share, most_share = None, None
    if acquired:
        share = wrong / acquired
        most_share = float(binomtest(wrong, acquired).proportion_ci(CONFIDENCE).high)
    return AcquisitionSummary(
        runs=len(there),
        acquired=acquired,
        position_m=_statistic(np.mean, position),
        position_std_m=_statistic(np.std, position),
        attitude_deg=_statistic(np.mean, attitude),
        attitude_std_deg=_statistic(np.std, attitude),
        median_position_m=_statistic(np.median, position),
        median_attitude_deg=_statistic(np.median, attitude),
        first_image=float(np.mean(column["images"] == 1)),
        wrong=wrong,
        confused=int(confused.sum()),
        wrong_share=share,
        wrong_share_most=most_share,
    )


def _beyond(position_m: Floats, attitude_deg: Floats) -> Mask:
    return np.asarray((position_m > WRONG_M) | (attitude_deg > WRONG_DEG))


def _statistic(what: Callable[[Floats], Any], values: Floats) -> float | None:
    return float(what(values)) if values.size else None


def _median_run(errors: Floats) -> float | None:
    each = [size for row in errors if (size := root_mean_square(row)) is not None]
    return float(np.median(each)) if each else None


def _worst_share(errors: Floats) -> float | None:
    sums = np.nansum(errors**2, axis=1)
    return float(sums.max() / sums.sum()) if sums.sum() > 0.0 else None
