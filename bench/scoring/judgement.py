"""One frame's estimate held against the truth: what every chain's judgement has in common."""

from __future__ import annotations

import re
from dataclasses import dataclass

from bench.scoring.limits import Limits
from models.camera import Camera
from models.estimate import Estimate
from models.markers import MarkerPattern
from models.onboard import OnboardKnowledge
from models.quantiles import chi_square_quantile

ALLOWED_CONFIDENCE = 0.9999  # one honest frame in ten thousand lies beyond its covariance
NO_REASON = "none told"


@dataclass(frozen=True, eq=False)
class TrueScene:
    """What judging one frame needs beside its sealed record.

    Attributes
    ----------
    camera : Camera
        As simulated.
    markers : MarkerPattern or None
        As installed.
    onboard : OnboardKnowledge
        As told.
    limits : Limits
    """

    camera: Camera
    markers: MarkerPattern | None
    onboard: OnboardKnowledge
    limits: Limits


@dataclass(frozen=True)
class Counts:
    """What the image processing found in one frame, of what there was.

    Attributes
    ----------
    expected, found : int
        Markers or landmarks that an image shows, and those of them truly found.
    mismatched, used : int
        Matches that are not true; those that the solver kept, of the true ones.
    in_sun : int
        Of those there are, that the Sun reaches.
    """

    expected: int = 0
    found: int = 0
    mismatched: int = 0
    used: int = 0
    in_sun: int = 0


@dataclass(frozen=True, eq=False)
class Judgement:
    """One frame by one pipeline in one run.

    Attributes
    ----------
    run : int
    estimate : Estimate
    range_m : float or None, m
        From the camera to the target frame's origin; None where the chain knows none.
    position_m, attitude_deg : float or None
        Size of the error of the pose that the pipeline stands by; None without one.
    missed : bool
        Whether its readings gave no pose although they should have.
    wrong : bool
        Whether the error is beyond what the covariance allows and beyond the case's limits.
    """

    run: int
    estimate: Estimate
    range_m: float | None
    position_m: float | None
    attitude_deg: float | None
    missed: bool
    wrong: bool

    @property
    def counts(self) -> Counts:
        """What the image processing found; a chain that counts nothing says nothing."""
        return Counts()

    @property
    def lost(self) -> bool:
        """Whether this frame's own readings gave no pose."""
        return self.estimate.pose is None

    @property
    def reason(self) -> str | None:
        """Why they gave none; None where they gave one."""
        if not self.lost:
            return None
        return self.estimate.reason or NO_REASON


def is_wrong(
    position_m: float | None,
    attitude_deg: float | None,
    squares: tuple[tuple[float | None, int], ...],
    limits: Limits,
) -> bool:
    """Tell whether a pose is wrong, and not merely uncertain.

    Parameters
    ----------
    position_m, attitude_deg : float or None
        Sizes of its errors.
    squares : tuple of (float or None, int)
        Each normalised squared error ``e' P^-1 e`` and its degrees of freedom; None where no
        covariance is stated, which then allows nothing.
    limits : Limits
    """
    if position_m is None or attitude_deg is None:
        return False
    if not (position_m > limits.wrong_position_m or attitude_deg > limits.wrong_attitude_deg):
        return False
    return any(
        square is None or not square <= chi_square_quantile(ALLOWED_CONFIDENCE, dof)
        for square, dof in squares
    )


def without_numbers(reason: str) -> str:
    """Return a reason with its numbers left out, so that like ones count together."""
    return re.sub(r"\d+(\.\d+)?", "…", reason)
