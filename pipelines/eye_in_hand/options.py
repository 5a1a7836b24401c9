"""Every setting of the eye-in-hand pipeline, and the two variants: as printed, and at its best.

The symbols are those of Opromolla et al. 2022, Table 11, whose values are the defaults.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from models.errors import ScenarioError
from pipelines.detection.detection_options import PerimeterRule
from pipelines.option_checks import check_sizes, variant_among
from pipelines.pnp.motion_prediction import Prediction
from pipelines.pnp.solver_options import LevenbergMarquardtOptions

VARIANTS = ("paper", "best")


@dataclass(frozen=True)
class EyeInHandOptions:
    """Settings of detection, identification, solver and tracking.

    Attributes
    ----------
    variant : str
        Name of the set.
    s_x, s_y : float
        What is added round the pattern, over its larger extent (equation 15).
    s_cu, s_cv : float
        Window of the adaptive threshold over the expected radius (equation 16).
    tau_s : float
        Sensitivity of the threshold.
    s_ao : float
        Least area of a blob over the expected one (equation 3).
    tau_circ : float
        Least circularity (equation 5).
    perimeter : str
        How the perimeter of equation 5 is measured; see ``detection.circularity``.
    s_bord : float
        Border margin over the expected radius (equation 7).
    s_id : float
        Identification gate over the least distance between markers (equation 8).
    min_markers : int
        Matches without which dots alone give no pose.
    solver : LevenbergMarquardtOptions
    fits_rims : bool
        Whether dots are fitted by their rims in the raw image, and matched by the prediction's
        covariance; else by weighted centroids of blobs, nearest first, as printed.
    verify : bool
        Whether to reject outlying matches, where there are more than three.
    prediction : str
        Guess of the next pose: the last one, or the last two carried on at constant velocity.
    centroid_sigma_px : float, px
        1-sigma of a blob's weighted centroid where nothing measures it (Table 13).
    psf_sigma_px : float, px
        Blur of the lens unless it was measured before flight; the fit refines it.
    outlier_sigmas, max_residual_radii : float
        As in ``pipelines.chaser_fixed.options``.
    region_sigmas : float
        How far from its prediction a dot is looked for.
    farthest_chi2 : float
        A pose further than this from the prediction, in sigmas squared of six, is no pose.
    decisive_chi2 : float
        By how much a pose must lie nearer to the prediction than the next that fits.
    outline_sigma_m : float, m
        1-sigma of each of the board's edges as surveyed.
    most_sigma_m, most_sigma_deg : float
        A pose from dots and outline that is less sure than this is no pose.
    acceleration_m_s2, acceleration_deg_s2 : float
        1-sigma departure from constant velocity: an arm starts and stops.
    velocity_m_s, velocity_deg_s : float
        1-sigma of the velocity while only one pose is known.
    """

    variant: str = "paper"
    s_x: float = 0.5
    s_y: float = 0.5
    s_cu: float = 2.0
    s_cv: float = 2.0
    tau_s: float = 0.3
    s_ao: float = 0.25
    tau_circ: float = 0.5
    perimeter: PerimeterRule = "crofton"
    s_bord: float = 1.2
    s_id: float = 2.0
    min_markers: int = 3
    solver: LevenbergMarquardtOptions = field(default_factory=LevenbergMarquardtOptions)
    fits_rims: bool = False
    verify: bool = False
    prediction: Prediction = "last_pose"
    centroid_sigma_px: float = 0.27
    psf_sigma_px: float = 0.5
    outlier_sigmas: float = 5.5
    max_residual_radii: float = 1.0
    region_sigmas: float = 5.0
    farthest_chi2: float = 60.0
    decisive_chi2: float = 13.8
    outline_sigma_m: float = 3e-4
    most_sigma_m: float = 0.01
    most_sigma_deg: float = 1.0
    acceleration_m_s2: float = 2e-3
    acceleration_deg_s2: float = 2e-2
    velocity_m_s: float = 0.05
    velocity_deg_s: float = 0.5

    def __post_init__(self) -> None:
        check_sizes(self, "eye-in-hand options")
        if not self.tau_s <= 1.0:
            raise ScenarioError(
                f"eye-in-hand options: expected tau_s from 0 to 1, got {self.tau_s}"
            )
        if self.min_markers < 3:
            raise ScenarioError(
                "eye-in-hand options: expected min_markers of at least 3 (six unknowns, two "
                f"numbers a marker), got {self.min_markers}"
            )


PAPER = EyeInHandOptions()
BEST = EyeInHandOptions(
    variant="best",
    s_cu=4.0,  # a disc as wide as the window gets a hole
    s_cv=4.0,
    solver=LevenbergMarquardtOptions(
        parametrisation="rotation_vector",
        lambda_rule="gavin",
        eps0=1e-4,
        eps1=1e-14,
        eps2=1e-10,
        eps3=0.0,
        max_iterations=60,
    ),
    fits_rims=True,
    verify=True,
    prediction="constant_velocity",
    centroid_sigma_px=0.05,
    max_residual_radii=0.3,
)


def options_for(variant: str) -> EyeInHandOptions:
    """Return the settings of a variant.

    Raises
    ------
    ScenarioError
        If no variant has that name; the message lists those there are.
    """
    return variant_among({"paper": PAPER, "best": BEST}, variant)
