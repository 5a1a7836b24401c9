"""Every setting of the chaser-fixed pipeline, and the two variants: as printed, and at its best.

The symbols are those of Opromolla et al. 2022, Table 11, whose values are the defaults.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from models.errors import ScenarioError
from pipelines.detection.detection_options import PerimeterRule, ThresholdRule
from pipelines.option_checks import check_sizes, variant_among
from pipelines.pnp.motion_prediction import Prediction
from pipelines.pnp.solver_options import LevenbergMarquardtOptions

Centroiding: TypeAlias = Literal["weighted_blob", "disc_fit", "cube_fit"]
Identification: TypeAlias = Literal["nearest_neighbour", "one_to_one"]
CalibrationUse: TypeAlias = Literal["unknown", "stated", "weighed"]

VARIANTS = ("paper", "best")


@dataclass(frozen=True)
class ChaserFixedOptions:
    """Settings of detection, identification, solver and tracking.

    Attributes
    ----------
    variant : str
        Name of the set.
    tau_bin : float
        Threshold on the difference image as a fraction of its largest unsaturated value.
    threshold_rule : str
        ``fraction_of_max``: that fraction; ``otsu``: Otsu's; ``larger_of_both``;
        ``per_blob``: half of each blob's own height, so that a sunlit marker does not raise the
        threshold of a shadowed one (case S7 of the paper).
    s_ao : float
        Area opening: least area over the expected one (equation 3).
    tau_circ : float
        Least circularity (equation 5).
    perimeter : str
        How the perimeter of equation 5 is measured; see ``detection.circularity``.
    s_bord : float
        Border margin over the expected radius (equation 7).
    s_id : float
        Identification gate over the least distance between markers (equation 8).
    min_markers : int
        Matches without which there is no pose. With a guess three suffice; four can be checked.
    gate_growth : float
        The gate and the searched regions grow by this share with every frame lost.
    solver : LevenbergMarquardtOptions
    centroiding : str
        ``weighted_blob``: equation 6; ``disc_fit``: see ``detection.disc_fit``; ``cube_fit``:
        likewise, but of corner cubes that are known, see ``detection.cube_model``.
    identification : str
        ``nearest_neighbour`` as printed, or ``one_to_one`` (optimal assignment).
    prediction : str
        Guess of the next pose: the last one, or the last two carried on at constant velocity.
    search_regions : bool
        Whether to look round the predicted markers first, and at the whole image only in need.
    verify : bool
        Whether to reject outlying matches, and to try P3P hypotheses where the matches disagree.
    calibration : str
        What the told errors of the camera's calibration, common to all markers, are used for.
        ``unknown``: nothing; ``stated``: no marker is refused for them and the covariance has them,
        the pose does not; ``weighed``: the pose, too, is that of least squares with all errors.
    pair_gap_s : float, s
        From the 800 nm exposure to the 850 nm one (Table 1: 30 Hz); the disc fit takes the motion
        between them out. 0 takes the images as they are.
    psf_sigma_px : float, px
        Expected blur of the lens; the fit refines it per disc.
    psf_tolerance_px : float, px
        1-sigma of that expectation.
    centroid_floor_px : float, px
        1-sigma per axis that no centroid is believed to beat: what is left of pixelation.
    centroid_sigma_px : float, px
        1-sigma of a blob's weighted centroid where nothing measures it (the paper's Table 13).
    outlier_sigmas : float
        A match whose residual is larger than this many of its sigmas is rejected.
    max_misfit : float
        A disc is refused when the rms misfit of its shape exceeds this share of its height.
    region_sigmas : float
        Half-size of a searched region, in sigmas of the predicted marker.
    acceleration_m_s2, acceleration_deg_s2 : float
        1-sigma departure from constant velocity, in translation and in rotation.
    velocity_m_s, velocity_deg_s : float
        1-sigma of the velocity while only one pose is known.
    max_residual_radii : float
        A solution whose rms residual exceeds this many expected marker radii is no pose.
    """

    variant: str = "paper"
    tau_bin: float = 0.2
    threshold_rule: ThresholdRule = "fraction_of_max"
    s_ao: float = 0.6
    tau_circ: float = 0.5
    perimeter: PerimeterRule = "crofton"
    s_bord: float = 1.2
    s_id: float = 2.0
    min_markers: int = 4
    gate_growth: float = 0.5
    solver: LevenbergMarquardtOptions = field(default_factory=LevenbergMarquardtOptions)
    centroiding: Centroiding = "weighted_blob"
    identification: Identification = "nearest_neighbour"
    prediction: Prediction = "last_pose"
    search_regions: bool = False
    verify: bool = False
    calibration: CalibrationUse = "unknown"
    pair_gap_s: float = 0.033
    psf_sigma_px: float = 0.5
    psf_tolerance_px: float = 0.25
    centroid_floor_px: float = 0.0015
    centroid_sigma_px: float = 0.077
    outlier_sigmas: float = 5.5
    max_misfit: float = 0.12
    region_sigmas: float = 5.0
    acceleration_m_s2: float = 2e-4
    acceleration_deg_s2: float = 2e-3
    velocity_m_s: float = 0.03
    velocity_deg_s: float = 0.05
    max_residual_radii: float = 1.0

    def __post_init__(self) -> None:
        check_sizes(self, "chaser-fixed options")
        if not 0.0 < self.tau_bin < 1.0:
            raise ScenarioError(
                f"chaser-fixed options: expected tau_bin between 0 and 1, got {self.tau_bin}"
            )
        if self.min_markers < 3:
            raise ScenarioError(
                "chaser-fixed options: expected min_markers of at least 3 (six unknowns, two "
                f"numbers a marker), got {self.min_markers}"
            )


PAPER = ChaserFixedOptions(min_markers=3, max_residual_radii=4.0)
BEST = ChaserFixedOptions(
    variant="best",
    threshold_rule="per_blob",
    solver=LevenbergMarquardtOptions(
        parametrisation="rotation_vector",
        lambda_rule="gavin",
        eps0=1e-4,
        eps1=1e-14,
        eps2=1e-10,
        eps3=0.0,
        max_iterations=60,
    ),
    centroiding="cube_fit",
    identification="one_to_one",
    prediction="constant_velocity",
    search_regions=True,
    verify=True,
    calibration="weighed",
    max_residual_radii=0.3,
)


def options_for(variant: str) -> ChaserFixedOptions:
    """Return the settings of a variant.

    Raises
    ------
    ScenarioError
        If no variant has that name; the message lists those there are.
    """
    return variant_among({"paper": PAPER, "best": BEST}, variant)
