"""One frame's estimate held against the truth: what every chain's judgement has in common."""

from __future__ import annotations

import re
from dataclasses import dataclass

from scipy.stats import chi2

from bench.scoring.limits import Limits
from models.estimate import Estimate

ALLOWED_CONFIDENCE = 0.9999  # one honest frame in ten thousand lies beyond its covariance


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
    def lost(self) -> bool:
        """Whether this frame's own readings gave no pose."""
        return self.estimate.pose is None


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
        square is None or not square <= chi2.ppf(ALLOWED_CONFIDENCE, dof) for square, dof in squares
    )


def without_numbers(reason: str) -> str:
    """Return a reason with its numbers left out, so that like ones count together."""
    return re.sub(r"\d+(\.\d+)?", "…", reason)
