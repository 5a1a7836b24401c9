"""Every setting of the relative navigation filters, and the two variants.

The paper prints no tuning. Ours follows from the pose's own covariance, hence from ``sigma_px``,
from what the chaser's absolute navigation is said to be worth, and from bounds on what the models
leave out; from no truth.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from models.errors import ScenarioError
from pipelines.option_checks import check_sizes, variant_among

TranslationFilter: TypeAlias = Literal["h_infinity", "kalman"]
RotationFilter: TypeAlias = Literal["minimum_energy", "mekf"]
RateModel: TypeAlias = Literal["relative", "inertial"]

VARIANTS = ("paper", "best")


@dataclass(frozen=True)
class NavigationOptions:
    """Settings of the two filters.

    Attributes
    ----------
    variant : str
        Name of the set.
    translation : str
        ``h_infinity`` (Pesce et al. 2019, Table 1) or ``kalman``; both with the transition of
        Yamanaka and Ankersen.
    rotation : str
        ``minimum_energy`` (Table 2, its signs put right) or ``mekf``.
    theta_share : float
        H-infinity's theta as a share of its limit, the least information of one position. At 0
        the filter is Kalman's; towards 1 it trusts its past less and less.
    acceleration_m_s2 : float, m/s2
        1 sigma of what moves one satellite and not the other, beside the noise of the chaser's own
        orbit. 1e-8 suits high orbits; in low ones drag and Earth's flattening leave 1e-7.
    rate_model : str
        What stays the same between frames in target axes: ``relative``, the rate with respect to
        the local frame, as printed (equation 10); ``inertial``, the inertial one, so that the
        turning of the local frame costs nothing. Where the inertia is known, Euler's equation
        carries the inertial rate instead.
    asymmetry : float
        1 sigma of the angular acceleration of a target of unknown inertia, over the square of its
        rate: at most 1 for any body, 0 for a sphere.
    inertia_accuracy : float
        1 sigma of each entry of a known inertia, over the geometric mean of the two moments it
        joins.
    forgetting_per_s : float, 1/s
        Minimum-energy filter alone: growth of its gain per second. Positive forgets; the
        ``-alpha K`` of the paper's Table 2 is a negative one, and makes the filter overconfident.
    gate : float
        A pose is refused when its innovation's NIS, three numbers each for translation and
        rotation, exceeds this: 21.1 for one good pose in ten thousand. 0 takes every pose.
    start_sigma_m, start_sigma_deg : float
        1 sigma per axis of a state to start from, where nothing else is said.
    start_sigma_m_s, start_sigma_deg_s : float
        1 sigma per axis of the rates at the start, unknown then.
    """

    variant: str = "best"
    translation: TranslationFilter = "kalman"
    rotation: RotationFilter = "mekf"
    theta_share: float = 0.2
    acceleration_m_s2: float = 1e-8
    rate_model: RateModel = "inertial"
    asymmetry: float = 0.3
    inertia_accuracy: float = 0.01
    forgetting_per_s: float = 0.0
    gate: float = 21.1
    start_sigma_m: float = 0.3
    start_sigma_deg: float = 1.0
    start_sigma_m_s: float = 0.02
    start_sigma_deg_s: float = 1.0

    def __post_init__(self) -> None:
        check_sizes(self, "navigation options", signed=("forgetting_per_s",))
        if not self.theta_share < 1.0:
            raise ScenarioError(
                f"navigation options: expected theta_share in [0, 1), got {self.theta_share}: at "
                "1 the H-infinity filter does not exist"
            )


PAPER = NavigationOptions(
    variant="paper",
    translation="h_infinity",
    rotation="minimum_energy",
    rate_model="relative",
    gate=0.0,
)
BEST = NavigationOptions()


def navigation_options_for(variant: str) -> NavigationOptions:
    """Return the settings of a variant.

    Raises
    ------
    ScenarioError
        If no variant has that name; the message lists those there are.
    """
    return variant_among({"paper": PAPER, "best": BEST}, variant, "navigation")
