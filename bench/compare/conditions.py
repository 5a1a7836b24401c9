"""Under what conditions a frame was taken, and the groups that frames fall into by them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.chains.chain import PosedFrameTruth
from bench.report.numbers import number
from bench.scoring.true_view import TrueView
from models.arrays import Floats, Mask

MOST_BINS = 4
LEAST_FRAMES = 3  # of a group; with fewer there is nothing to compare
LIKE = 0.05  # a spread that is a smaller share of the largest value is none
PHASES_DEG = (0.0, 30.0, 60.0, 90.0, 120.0, 180.0)


@dataclass(frozen=True, eq=False)
class Conditions:
    """By frame; None where the truth tells nothing of it.

    Attributes
    ----------
    range_m : (n,) array, m
        From the camera to the target frame's origin.
    phase_deg : (n,) array or None, deg
        Between the Sun and the camera, as seen from there: 0 with the Sun behind the camera.
    tumble_deg_s : (n,) array or None, deg/s
        How fast the target turns in the chaser's local frame.
    """

    range_m: Floats
    phase_deg: Floats | None
    tumble_deg_s: Floats | None


@dataclass(frozen=True, eq=False)
class Group:
    """Frames taken under like conditions.

    Attributes
    ----------
    by : str
        ``range``, ``phase angle`` or ``tumble rate``.
    title : str
    low, high : float
        Of the condition, in m, deg or deg/s.
    frames : (n,) array of bool
        Which of all.
    """

    by: str
    title: str
    low: float
    high: float
    frames: Mask


def conditions(view: TrueView) -> Conditions:
    """Return the conditions of every frame of a dataset."""
    truths = [view.truths[index] for index in view.dataset.indices]
    return Conditions(
        range_m=np.array([np.linalg.norm(each.cam_from_target.translation) for each in truths]),
        phase_deg=_known([_phase_deg(each) for each in truths]),
        tumble_deg_s=_known([_tumble_deg_s(each) for each in truths]),
    )


def groups(told: Conditions) -> list[Group]:
    """Return the groups by range, by phase angle and by tumble rate.

    Ranges and rates are cut so that groups have like numbers of frames, phase angles every so many
    deg. Groups of fewer than three frames are left out, and so is a condition with one group alone.
    """
    found = _quantiles("range", "m", told.range_m)
    if told.phase_deg is not None:
        found += _binned("phase angle", "deg", told.phase_deg, PHASES_DEG)
    if told.tumble_deg_s is not None:
        found += _quantiles("tumble rate", "deg/s", told.tumble_deg_s)
    return found


def _phase_deg(truth: PosedFrameTruth) -> float | None:
    sun = getattr(truth, "sun_dir_in_target", None)
    if sun is None:
        return None
    camera = truth.cam_from_target.inverse().translation
    across, along = np.linalg.norm(np.cross(sun, camera)), float(np.dot(sun, camera))
    return float(np.rad2deg(np.arctan2(across, along)))


def _tumble_deg_s(truth: PosedFrameTruth) -> float | None:
    state = getattr(truth, "state", None)
    rate = getattr(state, "omega_target_wrt_lvlh_in_target", None)
    return None if rate is None else float(np.rad2deg(np.linalg.norm(rate)))


def _known(values: list[float | None]) -> Floats | None:
    there = [value for value in values if value is not None]
    return np.array(there) if len(there) == len(values) else None


def _quantiles(by: str, unit: str, values: Floats) -> list[Group]:
    bins = min(MOST_BINS, len(values) // LEAST_FRAMES)
    if bins < 2:
        return []
    edges = np.quantile(values, np.linspace(0.0, 1.0, bins + 1))
    if edges[-1] - edges[0] < LIKE * abs(edges[-1]):
        return []
    return _binned(by, unit, values, edges.tolist())


def _binned(by: str, unit: str, values: Floats, edges: Sequence[float]) -> list[Group]:
    found = []
    inner = np.digitize(values, edges[1:-1])
    for place in range(len(edges) - 1):
        frames = np.asarray(inner == place)
        low, high = float(edges[place]), float(edges[place + 1])
        if frames.sum() >= LEAST_FRAMES:
            title = f"{number(low)} to {number(high)} {unit}"
            found.append(Group(by, title, low, high, frames))
    return found if len(found) > 1 else []
