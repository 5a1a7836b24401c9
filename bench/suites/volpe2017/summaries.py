"""What many runs of one setting come to, beside their bound."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.suites.consistency import Consistency, consistency, root_mean_square
from bench.suites.units import Outcome
from bench.suites.volpe2017 import shape_bound
from bench.suites.volpe2017.motion_errors import COLUMNS, MOTION_DOF
from models.arrays import Floats

ALLOWED = 1.1  # of the bound: a filter that is as good as can be, but for what linearising costs
SAMPLING_SIGMAS = 2.0
# By quantity: how many numbers of a run its mean square is of, as far as they are independent.
QUANTITIES = {
    "position_m": 3, "velocity_m_s": 3, "attitude_deg": 3, "rate_deg_s": 3, "shape_m": 3,
    "inertia_percent": 5,
}  # fmt: skip
SPREAD_OVER = ("inertia_percent",)  # told as a root mean square over entries, not as a length


class Runs:
    """The runs of a setting by one variant.

    Parameters
    ----------
    outcomes : sequence of Outcome
        Of ``tracking_run.track``.
    """

    def __init__(self, outcomes: Sequence[Outcome]) -> None:
        self._errors = np.array([each.values["errors"] for each in outcomes], dtype=np.float64)
        self.points = np.array([each.values["points"] for each in outcomes], dtype=np.float64)
        self.seconds = np.array([each.seconds for each in outcomes])

    def __len__(self) -> int:
        return len(self._errors)

    def scalar(self, name: str) -> Floats:
        """Return one number of every run and frame, (runs, frames)."""
        return self._errors[:, :, COLUMNS.index(name)]

    def vector(self, name: str, size: int = 3) -> Floats:
        """Return several numbers of every run and frame, (runs, frames, size).

        Parameters
        ----------
        name : str
            Without the number at its end.
        size : int
        """
        first = COLUMNS.index(f"{name}_1")
        return self._errors[:, :, first : first + size]

    def size(self, name: str) -> Floats:
        """Return how large an error is, (runs, frames)."""
        if f"{name}_1" not in COLUMNS:
            return self.scalar(name)
        entries = self.vector(name, 6 if name.startswith("inertia") else 3)
        if name in SPREAD_OVER:
            doubled = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # off the diagonal each is twice
            return np.asarray(np.sqrt((entries**2 * doubled).sum(axis=2) / 9.0))
        return np.asarray(np.linalg.norm(entries, axis=2))


@dataclass(frozen=True)
class AgainstBound:
    """One quantity at the end of the runs.

    Attributes
    ----------
    quantity : str
        Of ``QUANTITIES``.
    error : float or None
        Root mean square over the runs.
    bound : float
    limit : float
        1.1 of the bound and two sampling errors of so many runs.
    holds : bool or None
    """

    quantity: str
    error: float | None
    bound: float
    limit: float
    holds: bool | None


@dataclass(frozen=True)
class CaseSummary:
    """The runs of a case by ``best``.

    Attributes
    ----------
    runs : int
    ends : tuple of AgainstBound
    scale_error, scale_bound : float
        Relative, root mean square at the end.
    scaled_shape_m : float or None
        Of the shape, after it was scaled as the distance to the target wants.
    lost_ratios : float
        Of the inertia's five that are told to be lost, mean over the runs.
    scale_lost : float
        Share of the runs in which the scale is told to be lost.
    points : float
        Points known at the end, mean.
    worst_position_m : float
    nees : Consistency
        Of the motion, over the second half.
    last_nees : float or None
        Mean over the runs at the end, over its degrees of freedom.
    """

    runs: int
    ends: tuple[AgainstBound, ...]
    scale_error: float
    scale_bound: float
    scaled_shape_m: float | None
    lost_ratios: float
    scale_lost: float
    points: float
    worst_position_m: float
    nees: Consistency
    last_nees: float | None


@dataclass(frozen=True)
class Improvement:
    """A row of Table 2: norms of errors at the beginning and at the end.

    Attributes
    ----------
    quantity, unit : str
    first, last : float
        Median over the runs.
    first_of_run_0, last_of_run_0 : float
    """

    quantity: str
    unit: str
    first: float
    last: float
    first_of_run_0: float
    last_of_run_0: float

    @property
    def orders(self) -> float:
        """By how many orders of magnitude the median shrinks; below 0 it grows."""
        return float(np.log10(self.first / self.last)) if self.last > 0.0 < self.first else 0.0


TABLE_2 = (
    ("first_from_chaser_m", "m"), ("first_from_centre_m", "m"), ("shape_m", "m"),
    ("attitude_deg", "deg"), ("rate_deg_s", "deg/s"), ("position_m", "m"),
    ("velocity_m_s", "m/s"), ("inertia_kg_m2", "kg m²"), ("inertia_percent", "% of the trace"),
)  # fmt: skip


def improvements(runs: Runs) -> list[Improvement]:
    """Return the rows of Table 2; of what a variant does not tell there is none.

    The beginning is the first frame in which there is the quantity.
    """
    rows = []
    for name, unit in TABLE_2:
        size = runs.size(name)
        there = np.flatnonzero(np.isfinite(size).all(axis=0))
        if there.size:
            first, last = size[:, there[0]], size[:, -1]
            rows.append(
                Improvement(
                    name, unit, float(np.median(first)), float(np.median(last)), float(first[0]),
                    float(last[0]),
                )
            )  # fmt: skip
    return rows


def went_astray(runs: Runs) -> int:
    """Return how many runs end further from the truth than they began."""
    size = runs.size("position_m")
    return int(np.sum(~(size[:, -1] < size[:, 0])))


def against_bound(runs: Runs, bound: Floats) -> tuple[AgainstBound, ...]:
    """Set the errors at the end beside the bound.

    Parameters
    ----------
    runs : Runs
    bound : (frames, columns) array
        Of ``shape_bound.bound``.
    """
    rows = []
    for name, numbers in QUANTITIES.items():
        least = float(bound[-1, shape_bound.COLUMNS.index(name)])
        error = root_mean_square(runs.size(name)[:, -1])
        sampling = 1.0 / np.sqrt(2.0 * numbers * len(runs))  # relative, of a root mean square
        limit = least * (ALLOWED + SAMPLING_SIGMAS * float(sampling))
        rows.append(
            AgainstBound(name, error, least, limit, None if error is None else error <= limit)
        )
    return tuple(rows)


def case_summary(runs: Runs, bound: Floats) -> CaseSummary:
    """Summarise the runs of a case by ``best``.

    Parameters
    ----------
    runs : Runs
    bound : (frames, columns) array
    """
    nees = runs.scalar("nees_motion")
    half = nees.shape[1] // 2
    last = nees[:, -1][np.isfinite(nees[:, -1])]
    return CaseSummary(
        runs=len(runs),
        ends=against_bound(runs, bound),
        scale_error=root_mean_square(runs.scalar("scale")[:, -1] - 1.0) or 0.0,
        scale_bound=float(bound[-1, shape_bound.COLUMNS.index("scale")]),
        scaled_shape_m=root_mean_square(runs.scalar("shape_scaled_m")[:, -1]),
        lost_ratios=float(np.mean(runs.scalar("lost_inertia_ratios")[:, -1])),
        scale_lost=float(np.mean(runs.scalar("scale_lost")[:, -1])),
        points=float(np.mean(runs.scalar("points")[:, -1])),
        worst_position_m=float(np.max(runs.size("position_m")[:, -1])),
        nees=consistency(nees[:, half:], MOTION_DOF),
        last_nees=float(last.mean() / MOTION_DOF) if last.size else None,
    )
