"""Settings of the pose solver, and what else the way from matches to a pose must be told.

The symbols are those of Opromolla et al. 2022, Tables 2 and 11.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias

Parametrisation: TypeAlias = Literal["euler_321", "rotation_vector"]
LambdaRule: TypeAlias = Literal["paper", "gavin"]


@dataclass(frozen=True)
class LevenbergMarquardtOptions:
    """Settings of the solver (equations 9 to 14, Tables 2 and 11).

    Attributes
    ----------
    parametrisation : str
        ``euler_321``: (alpha, beta, gamma, t), updated by addition, as printed.
        ``rotation_vector``: a small left turn and t, which has no singularity.
    lambda_rule : str
        ``paper``: lambda grows on success and shrinks on failure, as printed. ``gavin``: the
        other way round (Gavin 2020, update rule 1), which is what makes the method robust.
    lambda0, lambda_up, lambda_down : float
        First damping and its two factors.
    eps0 : float
        Least decrease of chi2 that is a success (``paper``), or least ratio of the decrease to
        the predicted one (``gavin``).
    eps1 : float
        Stop when the largest component of the gradient is below this.
    eps2 : float
        Stop when the largest relative update is below this.
    eps3 : float
        Stop when the reduced chi2 is below this; 0 never stops. The paper's 1e-8 is 0.22 px rms
        at f = 2196 px: from a coarse guess it stops after one or two steps.
    max_iterations : int
    """

    parametrisation: Parametrisation = "euler_321"
    lambda_rule: LambdaRule = "paper"
    lambda0: float = 1e-8
    lambda_up: float = 11.0
    lambda_down: float = 9.0
    eps0: float = 1e-9
    eps1: float = 1e-10
    eps2: float = 1e-4
    eps3: float = 1e-8
    max_iterations: int = 200


class MatchOptions(Protocol):
    """What ``pipelines.pnp.robust_pose`` reads of a pipeline's settings."""

    @property
    def solver(self) -> LevenbergMarquardtOptions:
        """Settings of the solver."""

    @property
    def min_markers(self) -> int:
        """Matches without which there is no pose."""

    @property
    def verify(self) -> bool:
        """Whether to reject outlying matches."""

    @property
    def outlier_sigmas(self) -> float:
        """A match whose residual is larger than this many of its sigmas is rejected."""

    @property
    def centroid_sigma_px(self) -> float:
        """1-sigma of a centroid where nothing measures it, px."""

    @property
    def max_residual_radii(self) -> float:
        """Largest rms residual of a pose, in expected marker radii."""
