"""Settings of the pipeline for an uncooperative target, and its two variants."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from models.errors import ScenarioError
from pipelines.acquisition.acquisition_options import (
    HypothesizeAndTestOptions,
    TripleSearchOptions,
)
from pipelines.filters.lasting_errors import WHITE, LastingErrors
from pipelines.filters.navigation_options import NavigationOptions, navigation_options_for
from pipelines.option_checks import variant_among
from pipelines.tracking.softposit import SoftPositOptions

AcquisitionMethod: TypeAlias = Literal["hypothesize_and_test", "triple_search"]

VARIANTS = ("paper", "best")


@dataclass(frozen=True)
class UncooperativeOptions:
    """Settings of acquisition, tracking, filters, and of what is believed.

    Attributes
    ----------
    variant : str
        Name of the set.
    acquisition : str
        ``hypothesize_and_test``: Algorithm 1 of Pesce et al. 2019; ``triple_search``: every
        landmark triple on a few image triples.
    refine : bool
        Whether a tracked pose is solved anew from its matches, and found by nearest matches where
        the prediction is good; without it SoftPOSIT's own pose stands, as in the paper.
    hidden_landmarks : bool
        Whether the target hides landmarks in point frames. The paper's simulated points are
        projections of all landmarks, seen or not.
    algorithm_1, triple_search, softposit, navigation
        Settings of the parts.
    image_errors : LastingErrors
        Of poses found in images, as the filters take them; those of points are white.
    gate_sigmas : float
        A point matches a landmark within this distance.
    share_to_believe : float
        Of the points or of the landmarks that show, whichever are fewer, that a pose must match.
    share_to_be_sure : float
        Of the same, with which nearest matches alone are believed.
    max_residual_sigmas : float
        Largest rms of a believed pose's residuals, per axis.
    lost_frames : int
        Frames in a row without a pose, after which the target is acquired anew.
    refused_frames : int
        Poses in a row that the filters refuse, after which it is the filters that are doubted.
    share_memory_frames : float
        Over which the matched share is averaged (exponentially).
    share_to_doubt, image_share_to_doubt : float
        Average below which the pose is doubted, and acquired anew: of points, and of an image's
        edges, which find less even at the right pose.
    """

    variant: str = "best"
    acquisition: AcquisitionMethod = "triple_search"
    refine: bool = True
    hidden_landmarks: bool = False
    algorithm_1: HypothesizeAndTestOptions = field(default_factory=HypothesizeAndTestOptions)
    triple_search: TripleSearchOptions = field(default_factory=TripleSearchOptions)
    softposit: SoftPositOptions = field(default_factory=SoftPositOptions)
    navigation: NavigationOptions = field(default_factory=NavigationOptions)
    image_errors: LastingErrors = WHITE
    gate_sigmas: float = 4.0
    share_to_believe: float = 0.5
    share_to_be_sure: float = 0.85
    max_residual_sigmas: float = 1.6
    lost_frames: int = 10
    refused_frames: int = 3
    share_memory_frames: float = 4.0
    share_to_doubt: float = 0.75
    image_share_to_doubt: float = 0.4

    def __post_init__(self) -> None:
        for name in (
            "share_to_believe",
            "share_to_be_sure",
            "share_to_doubt",
            "image_share_to_doubt",
        ):
            value = getattr(self, name)
            if not 0.0 <= value <= 1.0:
                raise ScenarioError(
                    f"uncooperative options: expected {name} between 0 and 1, got {value}"
                )
        if (
            min(self.lost_frames, self.refused_frames) < 1
            or not self.gate_sigmas > 0.0
            or self.share_memory_frames < 1.0
        ):
            raise ScenarioError(
                "uncooperative options: expected lost_frames, refused_frames and "
                f"share_memory_frames of at least 1 and gate_sigmas above 0, got "
                f"{self.lost_frames}, {self.refused_frames}, {self.share_memory_frames} and "
                f"{self.gate_sigmas}"
            )


PAPER = UncooperativeOptions(
    variant="paper",
    acquisition="hypothesize_and_test",
    refine=False,
    navigation=navigation_options_for("paper"),
    max_residual_sigmas=3.0,
    refused_frames=UncooperativeOptions.lost_frames,
)
BEST = UncooperativeOptions(
    navigation=navigation_options_for("best"),
    image_errors=LastingErrors(view_share=0.5, steady_share=0.2, view_turn_deg=20.0),
)


def options_for(variant: str) -> UncooperativeOptions:
    """Return the settings of a variant.

    Raises
    ------
    ScenarioError
        If no variant has that name; the message lists those there are.
    """
    return variant_among({"paper": PAPER, "best": BEST}, variant)
