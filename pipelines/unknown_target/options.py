"""Settings of the pipeline for an unknown target, and its two variants."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from models.errors import ScenarioError
from pipelines.features.feature_tracker import TrackerOptions

RangeTo: TypeAlias = Literal["centre", "surface", "facet", "hull"]
VARIANTS = ("paper", "best")


@dataclass(frozen=True)
class UnscentedOptions:
    """Settings of the filter as Volpe et al. 2017 print it; its numbers are lost to us.

    Attributes
    ----------
    alpha, beta, kappa : float
        Of the scaled unscented transformation (Julier 2002).
    sigma_constraint_m : float, m
        With which equation 15, that joins the two redundant sets of points, is taken in as a
        measurement in every frame.
    sigma_attitude : float
        1 sigma of each number of the first quaternion, which the choice of axes makes exact.
    sigma_beside_m, sigma_depth_m : float
        1 sigma of the first guess of a point, across and along the boresight.
    """

    alpha: float = 0.3
    beta: float = 2.0
    kappa: float = 0.0
    sigma_constraint_m: float = 0.2
    sigma_attitude: float = 1e-4
    sigma_beside_m: float = 0.3
    sigma_depth_m: float = 2.0


@dataclass(frozen=True)
class BatchOptions:
    """Settings of ``best``: all measurements since the start, linearised anew now and then.

    Attributes
    ----------
    range_to : str
        What a range is taken to be to: ``surface``, the hull of all points; ``facet``, the surface
        between those that were seen about the beam; ``hull``, that and what silhouettes leave of
        space, once they go round; or the ``centre`` of mass as in the paper.
    hull_px : float, px
        1 sigma by which a silhouette's border errs, where a beam enters the hull.
    track_gate : float
        A track whose errors over its life are so many times those of most counts less and less.
    outline_px : float, px
        1 sigma by which an outline errs where a plane touches it.
    alike_outlines : float
        So many rows of outlines err alike: each is compared with many.
    alike_sightings : float
        So many sightings of a track err alike, for it drifts as long as it lives.
    relief_m : float, m
        1 sigma by which the surface lies off the hull of the points.
    relief_share : float
        And off a facet, as a share of its longest side.
    relief_frames : float
        So many ranges in a row err alike by that: together they count as one.
    births : int
        Sightings of a track that must agree before it is a point.
    birth_reach : float
        How far apart they may lie on the target, as a share of the size of what is thought of it.
    gate_sigmas : float
        Beyond it an observation counts less and less.
    every_frame_until : int
        Up to so many frames all is linearised anew with every frame.
    growth : float
        After that, whenever there are so many times as many frames.
    bend : float
        Or when the lines are wrong by so much: the square, in sigmas, of what all images together
        miss by the estimate's having moved since.
    iterations : int
        Most steps of one time.
    most_observations : int
        What is older stays as it was last linearised.
    bad_share : float
        A point of which more observations than this are refused is given up.
    inertia_sigma : float
        1 sigma of the numbers of the inertia's chart before any measurement.
    lost_share : float
        What is still this uncertain, as a share of before, is told to be lost.
    second_chances : bool
        Whether the track of a point that was given up may become another.
    most_sigma_m : float, m
        Points less certain than that are not told of.
    shape_sigma_m : float, m
        And those less certain than that are no part of the shape, though they tell the pose.
    """

    range_to: RangeTo = "surface"
    hull_px: float = 0.7
    track_gate: float = float("inf")
    outline_px: float = 0.7
    alike_outlines: float = 6.0
    alike_sightings: float = 1.0
    relief_m: float = 0.01
    relief_share: float = 0.05
    relief_frames: float = 10.0
    births: int = 3
    birth_reach: float = 0.1
    gate_sigmas: float = 3.5
    every_frame_until: int = 12
    growth: float = 1.6
    bend: float = 1.0
    iterations: int = 20
    most_observations: int = 40_000
    bad_share: float = 0.6
    inertia_sigma: float = 0.5
    lost_share: float = 0.5
    second_chances: bool = True
    most_sigma_m: float = float("inf")
    shape_sigma_m: float = float("inf")

    @property
    def alike_ranges(self) -> float:
        """How many ranges are worth one: those to a surface err alike as long as they meet it."""
        return 1.0 if self.range_to == "centre" else self.relief_frames

    def __post_init__(self) -> None:
        if self.range_to not in ("centre", "surface", "facet", "hull"):
            raise ScenarioError(
                "unknown target options: expected range_to of 'centre', 'surface', 'facet' or "
                f"'hull', got {self.range_to!r}"
            )
        if self.births < 1 or not self.growth > 1.0 or not self.gate_sigmas > 0.0:
            raise ScenarioError(
                "unknown target options: expected births of at least 1, growth above 1 and "
                f"gate_sigmas above 0, got {self.births}, {self.growth} and {self.gate_sigmas}"
            )


@dataclass(frozen=True)
class UnknownTargetOptions:
    """Settings of one variant.

    Attributes
    ----------
    variant : str
    unscented : UnscentedOptions
        Of ``paper``.
    batch : BatchOptions
        Of ``best``.
    """

    variant: str = "best"
    unscented: UnscentedOptions = field(default_factory=UnscentedOptions)
    batch: BatchOptions = field(default_factory=BatchOptions)


@dataclass(frozen=True)
class ImageOptions:
    """Settings on images, where tracks are our own.

    Attributes
    ----------
    tracker : TrackerOptions
    batch : BatchOptions
    silhouette_every : int
        Frames from one whose silhouette is kept to the next.
    """

    tracker: TrackerOptions = field(default_factory=TrackerOptions)
    batch: BatchOptions = field(
        default_factory=lambda: BatchOptions(
            range_to="hull",
            track_gate=2.0,
            births=6,
            birth_reach=0.01,
            every_frame_until=4,
            growth=1.25,
            bend=1000.0,
            iterations=6,
            gate_sigmas=3.0,
            bad_share=0.2,
            relief_share=0.1,
            second_chances=False,
            alike_sightings=100.0,
            alike_outlines=100.0,
            relief_frames=60.0,
            most_sigma_m=3.0,
            shape_sigma_m=0.5,
        )
    )
    silhouette_every: int = 5


IMAGE_VARIANTS = {"best": ImageOptions()}


def options_for(variant: str) -> UnknownTargetOptions:
    """Return the settings of a variant.

    Raises
    ------
    ScenarioError
        If no variant has that name; the message lists those there are.
    """
    if variant not in VARIANTS:
        raise ScenarioError(
            f"expected a pipeline variant among {', '.join(VARIANTS)}, got {variant!r}"
        )
    return UnknownTargetOptions(variant)
