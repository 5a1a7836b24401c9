"""The cases: the paper's own, what motion makes what observable, what tracks are really like."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any, Literal, TypeAlias

import numpy as np

from bench.report.pairs.published import REFERENCE
from models.arrays import Floats
from models.motion.clohessy_wiltshire import mean_motion, state_on_inclined_ellipse
from models.motion.watched_tumble import WatchedState, WatchedTumble
from models.sensors.range_finder import RangeFinder
from models.spacecraft.simple_target import inertia_kg_m2, points_in_target, points_on_box

Row3: TypeAlias = tuple[float, float, float]
RangeTo: TypeAlias = Literal["centre", "surface", "none"]

CAMERA = "chaser_fixed"
RADIAL_M, NORMAL_M, PHASE_RAD = 15.0, 20.0, 0.3
PAPER_TUMBLE: Row3 = (0.3, 0.2, 0.5)
LOW_KM, HIGH_KM = 7000.0, 42164.0
TUMBLE: Row3 = (0.5, 0.4, 0.75)
MOTIONS: dict[str, tuple[str, Row3, float]] = {
    "tumble": ("tumble", TUMBLE, LOW_KM),
    "flip": ("about the intermediate axis", (0.02, 0.02, 1.0), LOW_KM),
    "spin": ("about a principal axis", (1.0, 0.0, 0.0), LOW_KM),
    "still": ("no spin", (0.0, 0.0, 0.0), LOW_KM),
    "spin_high": ("about a principal axis, in GEO", (1.0, 0.0, 0.0), HIGH_KM),
}


@dataclass(frozen=True)
class Case:
    """One setting; plain numbers only.

    Attributes
    ----------
    key, name : str
    omega_deg_s : tuple of 3 floats, deg/s
        Inertial, body axes, at the start.
    duration_s, step_s : float, s
    range_to : str
        ``centre`` of mass as in the paper, the ``surface`` on the boresight, or ``none``.
    range_finder : RangeFinder
    sigma_px : float, px
    rounded : bool
        Whether pixels are whole, as the paper's are.
    false_share : float
        Of the points seen, places that are uniform in the rectangle about the target.
    hidden_s : tuple of 2 floats, s
        From when to when nothing is seen.
    own_shadow : bool
        Whether the target hides points behind it; the paper sees through.
    points : int
        The paper's twelve, or so many on the box.
    semi_major_axis_km : float, km
        Of the target's orbit: in a high one the gravity gradient does not help.
    """

    key: str
    name: str
    omega_deg_s: Row3 = PAPER_TUMBLE
    duration_s: float = 600.0
    step_s: float = 1.0
    range_to: RangeTo = "centre"
    range_finder: RangeFinder = field(default_factory=RangeFinder)
    sigma_px: float = 1.0
    rounded: bool = False
    false_share: float = 0.0
    hidden_s: tuple[float, float] = (0.0, 0.0)
    own_shadow: bool = False
    points: int = 12
    semi_major_axis_km: float = LOW_KM

    @property
    def orbit_rate(self) -> float:
        """Mean motion of the target's circular orbit, rad/s."""
        return mean_motion(1e3 * self.semi_major_axis_km)

    @property
    def frames(self) -> int:
        """Frames of a run."""
        return int(self.duration_s / self.step_s) + 1

    @property
    def times_s(self) -> Floats:
        """(frames,) array, s."""
        return np.asarray(self.step_s * np.arange(self.frames), dtype=np.float64)

    @property
    def points_in_target(self) -> Floats:
        """(n, 3) array, m: the true points."""
        return points_in_target() if self.points == 12 else points_on_box(self.points)

    @property
    def sigma_told_px(self) -> float:
        """1 sigma per axis of what is seen: a rounded number is off by a variance of 1/12 more."""
        return float(np.sqrt(self.sigma_px**2 + (1.0 / 12.0 if self.rounded else 0.0)))


@cache
def published() -> dict[str, Any]:
    """Return the reference file's tables."""
    return tomllib.loads((REFERENCE / "volpe2017.toml").read_text())


def paper_case(duration_s: float | None = None) -> Case:
    """Return the paper's own case: one orbit, or another duration in s."""
    own = Case("paper", "one orbit", step_s=5.0, rounded=True)
    return replace(own, duration_s=duration_s or 2.0 * float(np.pi) / own.orbit_rate)


def observability_cases(duration_s: float) -> list[Case]:
    """Return each motion with and without a range, for a duration in s."""
    return [
        Case(
            f"{key}_{range_to}", name, omega, duration_s, range_to=range_to, semi_major_axis_km=high
        )
        for key, (name, omega, high) in MOTIONS.items()
        for range_to in ("centre", "none")
    ]


def track_cases(duration_s: float) -> list[Case]:
    """Return the cases of imperfect tracks, for a duration in s."""
    plain = Case("clean", "all seen, all right", TUMBLE, duration_s)
    half = 0.5 * duration_s
    wrong = RangeFinder(outlier_share=0.1, drop_out_share=0.2, rate_hz=0.5)
    return [
        plain,
        replace(plain, key="false_30", name="30 % of the matches false", false_share=0.3),
        replace(plain, key="hidden", name="nothing seen for 20 s", hidden_s=(half, half + 20.0)),
        replace(
            plain, key="false_30_hidden", name="both", false_share=0.3, hidden_s=(half, half + 20.0)
        ),
        replace(plain, key="shadow", name="hidden behind the target itself", own_shadow=True),
        replace(plain, key="surface", name="range to the surface", range_to="surface"),
        replace(
            plain, key="surface_wrong", range_to="surface", range_finder=wrong,
            name="range to the surface at 0.5 Hz, 10 % wrong, 20 % missing",
        ),
        replace(
            plain, key="all", range_to="surface", range_finder=wrong, false_share=0.3,
            hidden_s=(half, half + 20.0), own_shadow=True, name="all of it",
        ),
    ]  # fmt: skip


def speed_case(points: int, duration_s: float) -> Case:
    """Return a tumble with so many points, at 1 Hz.

    Parameters
    ----------
    points : int
    duration_s : float, s
    """
    return Case(f"points_{points}", f"{points} points", TUMBLE, duration_s, points=points)


@cache
def motion_of(case: Case) -> WatchedTumble:
    """Return the true motion of a case; made once a process."""
    return WatchedTumble(
        1e3 * case.semi_major_axis_km,
        state_on_inclined_ellipse(case.orbit_rate, RADIAL_M, NORMAL_M, PHASE_RAD),
        np.deg2rad(case.omega_deg_s),
        inertia_kg_m2(),
        float(case.times_s[-1]),
    )


@cache
def states_of(case: Case) -> tuple[WatchedState, ...]:
    """Return the true states of a case's frames; made once a process."""
    motion = motion_of(case)
    return tuple(motion.state(float(time_s)) for time_s in case.times_s)
